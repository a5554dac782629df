//! An edited copy of `shaders/` in place of the program's own.

use super::end_to_end::{EXPERIMENT, has_device};
use super::{assert_ends, command, ok, stderr};
use splitsum::base::pixels::exr;
use std::fs;
use std::path::Path;
use std::process::Output;

/// The shader of one method, and an edit that doubles its radiance.
const EDITED: &str = "shade/method/split_sum.glsl";
const ADDED: &str = "\nvec3 doubled_radiance(Surface s) { return 2.0 * specular_radiance(s); }\n\
                     #define specular_radiance doubled_radiance\n";
/// A metal: all its light is the method's.
const RENDER: &str = "render --method split-sum --albedo 0 --f0 1 --diffuse none --out ball.exr";

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn with_shaders(dir: &Path, arguments: &[&str]) -> Output {
    let mut command = command(dir, arguments);
    let output = command.env("SPLITSUM_SHADERS", "shaders").output();
    output.expect("the binary starts")
}

/// A folder with an experiment and a copy of the program's shaders.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    copy_folder(&shaders, &dir.path().join("shaders"));
    fs::write(dir.path().join("tiny.toml"), EXPERIMENT).unwrap();
    dir
}

fn append(dir: &Path, text: &str) {
    let path = dir.join("shaders").join(EDITED);
    let edited = fs::read_to_string(&path).unwrap() + text;
    fs::write(path, edited).unwrap();
}

/// Cells of other shaders are other cells, and unedited shaders are the program's.
#[test]
fn ids_of_cells_follow_the_shaders_in_use() {
    let dir = folder();
    let plan = ["plan", "tiny.toml", "--json"];
    let own = ok(dir.path(), &plan);
    let copied = with_shaders(dir.path(), &plan);
    assert_ends(&copied, 0, &["SPLITSUM_SHADERS: 0 of "]);
    assert_eq!(own, String::from_utf8_lossy(&copied.stdout));
    append(dir.path(), ADDED);
    let edited = with_shaders(dir.path(), &plan);
    assert_ends(&edited, 0, &["shaders are not the program's"]);
    assert_ne!(own, String::from_utf8_lossy(&edited.stdout));
}

/// Without a build, the edited method is twice as bright.
#[test]
fn an_edit_of_a_shader_shows() {
    if !has_device() {
        return;
    }
    let dir = folder();
    let render: Vec<&str> = RENDER.split_whitespace().collect();
    let image = || {
        let read = exr::read(&dir.path().join("ball.exr")).unwrap();
        read.rgb.data.into_flattened()
    };
    ok(dir.path(), &render);
    let own = image();
    append(dir.path(), ADDED);
    let output = with_shaders(dir.path(), &render);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(own.iter().any(|&x| x > 0.0));
    let doubled: Vec<f32> = own.iter().map(|x| 2.0 * x).collect();
    assert_eq!(image(), doubled);
}

#[test]
fn wrong_folders_are_refused() {
    let dir = folder();
    let plan = ["plan", "tiny.toml"];
    append(dir.path(), "float unfinished( {\n");
    let place = "SPLITSUM_SHADERS: shade/specular.comp:";
    let output = with_shaders(dir.path(), &plan);
    assert_ends(&output, 2, &[place, "shaders/shade/method/split_sum.glsl:"]);
    assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    fs::remove_dir_all(dir.path().join("shaders")).unwrap();
    assert_ends(&with_shaders(dir.path(), &plan), 2, &["shaders: No such"]);
    fs::create_dir(dir.path().join("shaders")).unwrap();
    assert_ends(&with_shaders(dir.path(), &plan), 2, &["no shaders; "]);
}
