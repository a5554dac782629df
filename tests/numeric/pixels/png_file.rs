//! PNG files.

use super::folder;
use splitsum::base::pixels::{Rgb8Image, png};
use std::path::Path;

fn picture() -> Rgb8Image {
    Rgb8Image::from_fn(5, 3, |x, y| [(x * 50) as u8, (y * 100) as u8, 255])
}

#[test]
fn round_trip() {
    let folder = folder();
    let path = folder.path().join("picture.png");
    png::write_rgb8(&path, &picture()).unwrap();
    assert_eq!(
        image::open(&path).unwrap().into_rgb8().into_raw(),
        picture().data.concat()
    );
    // A relative path without a folder means the current folder. No other file may be left in the
    // folder.
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn files_have_the_permissions_of_new_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let (path, plain) = (
        folder.path().join("picture.png"),
        folder.path().join("plain"),
    );
    png::write_rgb8(&path, &picture()).unwrap();
    std::fs::write(&plain, b"").unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&plain));
}
