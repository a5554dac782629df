//! Image files. Every input file is made here, byte by byte or by an independent writer.

mod openexr;
mod png_file;
mod rgbe;

use splitsum::base::pixels::Rgb8Image;
use std::path::PathBuf;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn put(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn shrinking_keeps_the_area_weighted_mean() {
    // 5 columns to 2: each gets half of the third one.
    let image = Rgb8Image::from_fn(5, 2, |x, y| {
        [
            [10, 20, 60, 100, 200][x as usize],
            7,
            if y == 0 { 0 } else { 100 },
        ]
    });
    let small = image.shrunk(2, 1);
    // (10 + 20 + 60/2) / 2.5 = 24 and (60/2 + 100 + 200) / 2.5 = 132.
    assert_eq!(small.data, [[24, 7, 50], [132, 7, 50]]);
    assert_eq!(image.shrunk(5, 2), image);
}
