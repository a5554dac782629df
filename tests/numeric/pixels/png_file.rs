//! PNG files.

use super::{folder, put};
use splitsum::pixels::{Rgb8Image, png};
use std::path::Path;

fn image() -> Rgb8Image {
    Rgb8Image::from_fn(5, 3, |x, y| [(x * 50) as u8, (y * 100) as u8, 255])
}

#[test]
fn round_trip() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    png::write_rgb8(&path, &image()).unwrap();
    assert_eq!(png::read_rgb8(&path).unwrap(), image());
    // A relative path without a folder means the current folder. No other file may be left in the folder.
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn files_have_the_permissions_of_new_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let (path, plain) = (folder.path().join("picture.png"), folder.path().join("plain"));
    png::write_rgb8(&path, &image()).unwrap();
    std::fs::write(&plain, b"").unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&plain));
}

#[test]
fn bad_files_are_refused() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    png::write_rgb8(&path, &image()).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let cut = put(&folder, "cut.png", &bytes[..bytes.len() / 2]);
    assert!(png::read_rgb8(&cut).unwrap_err().to_string().contains("cut.png"));
    // Width and height of IHDR.
    bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    let huge = put(&folder, "huge.png", &bytes);
    assert!(png::read_rgb8(&huge).is_err());
}
