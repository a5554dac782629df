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

/// A file that shaders of the page and for Vulkan include, also in choices that no page offers.
#[test]
fn a_model_can_be_edited() {
    let dir = folder();
    let path = dir.path().join("shaders/brdf/ggx.glsl");
    let edited = fs::read_to_string(&path).unwrap() + "// edited\n";
    fs::write(&path, edited).unwrap();
    let output = with_shaders(dir.path(), &["plan", "tiny.toml"]);
    assert_ends(&output, 0, &["shaders are not the program's"]);
}

/// The lists of models and methods, and what a pass may choose, are part of the build.
#[test]
fn shaders_that_the_program_lacks_need_a_build() {
    let plan = ["plan", "tiny.toml"];
    let refused = |change: &dyn Fn(&Path), part: &str| {
        let dir = folder();
        change(&dir.path().join("shaders"));
        let output = with_shaders(dir.path(), &plan);
        assert_ends(&output, 2, &["SPLITSUM_SHADERS=shaders: ", part]);
        assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    };
    let needed = "is missing; a new, removed or renamed file";
    let remove =
        |name: &'static str| move |shaders: &Path| fs::remove_file(shaders.join(name)).unwrap();
    refused(&remove("brdf/ggx.glsl"), needed);
    refused(&remove("tonemap/tonemap.comp"), needed);
    refused(&remove("page/specular.frag"), needed);
    let copy = |shaders: &Path| {
        fs::copy(shaders.join("brdf/ggx.glsl"), shaders.join("brdf/own.glsl")).unwrap();
    };
    refused(&copy, "own: a new shader; ");
    // Without its include the pass has no permutation for each model.
    let unchosen = |shaders: &Path| {
        let text = "vec3 specular_radiance(Surface s) { return vec3(1.0); }\n";
        fs::write(shaders.join("shade/method/sampled.glsl"), text).unwrap();
    };
    refused(&unchosen, "specular.comp:cube:sampled: a new shader; ");
}

/// Shaders of the report's page need their includes as others do; locks of editors are skipped.
#[test]
fn the_folder_is_read_as_the_build_reads_it() {
    let dir = folder();
    let plan = ["plan", "tiny.toml"];
    let shaders = dir.path().join("shaders");
    fs::write(shaders.join("brdf/.#ggx.glsl"), "lock").unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(".", shaders.join("loop")).unwrap();
    assert_ends(&with_shaders(dir.path(), &plan), 0, &[": 0 of "]);
    let page = shaders.join("page/specular.frag");
    let text = fs::read_to_string(&page).unwrap();
    let include = "#include \"lib/nowhere.glsl\"\n";
    fs::write(&page, include.to_owned() + &text).unwrap();
    assert_ends(
        &with_shaders(dir.path(), &plan),
        2,
        &["page/specular.frag:1: there is no lib/nowhere"],
    );
    fs::write(&page, b"\xff").unwrap();
    assert_ends(
        &with_shaders(dir.path(), &plan),
        2,
        &["specular.frag: not UTF-8"],
    );
}

/// Provenance marks the edit, wherever the program is.
#[test]
fn provenance_marks_edited_shaders() {
    if !has_device() {
        return;
    }
    let dir = folder();
    append(dir.path(), ADDED);
    let output = with_shaders(dir.path(), &["run", "tiny.toml"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let session = |folder: &str| {
        let path = dir.path().join(folder).join("provenance.json");
        let provenance: serde_json::Value =
            serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
        provenance["sessions"][0]["edited_shaders"].clone()
    };
    assert_eq!(session("runs/tiny"), true);
    // The program's own shaders do not continue it.
    assert_ends(
        &command(dir.path(), &["run", "tiny.toml"]).output().unwrap(),
        2,
        &["other shaders"],
    );
    ok(dir.path(), &["run", "tiny.toml", "--out", "runs/own"]);
    assert_eq!(session("runs/own"), serde_json::Value::Null);
}

#[test]
fn wrong_folders_are_refused() {
    let dir = folder();
    let plan = ["plan", "tiny.toml"];
    append(dir.path(), "float unfinished( {\n");
    let place = "SPLITSUM_SHADERS=shaders: shade/specular.comp:";
    let output = with_shaders(dir.path(), &plan);
    assert_ends(&output, 2, &[place, "shaders/shade/method/split_sum.glsl:"]);
    fs::remove_dir_all(dir.path().join("shaders")).unwrap();
    assert_ends(
        &with_shaders(dir.path(), &plan),
        2,
        &["shaders: there is no such folder"],
    );
    fs::create_dir(dir.path().join("shaders")).unwrap();
    assert_ends(
        &with_shaders(dir.path(), &plan),
        2,
        &["contains no shaders; "],
    );
}
