//! A scene with an occlusion map, which the controls and axes of occlusion need.

use tempfile::TempDir;

/// Name of the model in the folder of [`occluded_scene`].
pub const OCCLUDED: &str = "occluded.obj";

/// A folder with a square that faces the camera, whose material has an occlusion map of 1/2.
pub fn occluded_scene() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    image::GrayImage::from_pixel(1, 1, image::Luma([128]))
        .save(folder.path().join("occlusion.png"))
        .expect("a texture");
    let square = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
                  vt 0 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
    for (name, text) in [
        ("m.mtl", "newmtl m\nPr 0.5\nmap_Ka occlusion.png\n"),
        (OCCLUDED, square),
    ] {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}
