//! What a person wrote is answered at the place where it stands: brackets where they open, files as files.

use super::config::{assert_faults, faults};
use splitsum::experiment::inputs::short_names;

#[test]
fn a_bracket_that_is_not_closed_is_told_where_it_opens() {
    for (text, place, closing) in [
        ("name = \"x\"\nreference = { samples = 64\n[axes]\nalpha = [0.5]\n", "2:13", "{ is not closed; expected }"),
        ("name = \"x\"\n[axes]\nalpha = [0.5,\nmethod = [\"split-sum\"]\n", "3:9", "[ is not closed; expected ]"),
        ("name = \"x\"\n[axes]\nsize = [[1, 2], [3, 4]\nalpha = [1]\n", "3:8", "[ is not closed; expected ]"),
        ("name = \"x\"\n[axes]\nsamples = { pow2 = [0, 3 }\nalpha = [1]\n", "3:20", "[ is not closed; expected ]"),
        ("name = \"x\"\n[axes\nalpha = [0.5]\n", "2:1", "[ is not closed; expected ]"),
        ("name = \"x\"\n[axes]\nalpha = [0.5\nsize = { a = 3\n", "3:9", "[ is not closed; expected ]"),
    ] {
        assert_faults(&faults(text, &[]), &[&format!("e.toml:{place}: not TOML: {closing}")]);
    }
    // What stands before it is read, and a bracket in a text or a comment is none.
    let text = "name = \"x [\" # {\ncolour = 1\n[axes]\nalpha = [0.5\n";
    assert_faults(
        &faults(text, &[]),
        &["e.toml:1:8: name: ", "e.toml:2:1: colour is unknown", "e.toml:4:9: not TOML: ["],
    );
}

#[test]
fn a_file_that_is_missing_is_never_answered_with_a_formula() {
    let missing = |name: &str| faults(&format!("name = \"x\"\n[axes]\nenvironment = [\"{name}\"]\n"), &[]).join("\n");
    for file in ["sky.hdr", "maps/sky", "studio.exr"] {
        assert!(missing(file).contains("no such file") && !missing(file).contains("did you mean"), "{}", missing(file));
    }
    assert!(missing("studi").contains("did you mean builtin:studio?"), "{}", missing("studi"));
}

#[test]
fn an_approximation_is_no_reference() {
    let with = |method: &str| {
        faults(&format!("name = \"x\"\nreference = {{ method = \"{method}\" }}\n[axes]\nalpha = [0.5]\n"), &[])
    };
    assert_faults(
        &with("split-sum"),
        &["e.toml:2:24: reference.method: split-sum is an approximation and cannot be the reference"],
    );
    assert_eq!((with("reference").len(), with("none").len()), (0, 0));
}

#[test]
fn names_of_environments_are_short_and_none_is_like_another() {
    let names = |files: &[&str]| -> Vec<String> {
        let short = short_names(files.iter().copied());
        files.iter().map(|file| short[*file].clone()).collect()
    };
    assert_eq!(names(&["maps/a.hdr", "/x/b.c.exr", "builtin:sky"]), ["a", "b.c", "builtin:sky"]);
    assert_eq!(names(&["one/a.hdr", "two/a.hdr", "b.hdr"]), ["one/a.hdr", "two/a.hdr", "b"]);
    assert_eq!(names(&["a.hdr", "a.exr", "a.exr#sun"]), ["a.hdr", "a.exr", "a#sun"]);
    assert_eq!(names(&["x/y/a.hdr", "z/y/a.hdr"]), ["x/y/a.hdr", "z/y/a.hdr"]);
}
