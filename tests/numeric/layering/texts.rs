//! No code decides on the words of a text that this program writes: what a text means is a type.
//!
//! A decision on the form of a text is code that compares its start, its end or a part with a
//! literal or by a closure. Each is listed with the format that the text comes from.

use super::source::code;
use super::{read, rust_files};
use std::collections::BTreeSet;

/// Functions that look for a part of a text.
const SEARCHES: &[&str] = &[
    "starts_with",
    "ends_with",
    "split_once",
    "rsplit_once",
    "strip_prefix",
    "strip_suffix",
    "trim_end_matches",
    "trim_start_matches",
];
/// Those that also look for an entry of a list: only texts count.
const CONTAINS: &[&str] = &["contains", "find"];

/// A file, the searched part as written, and the format that has it.
const FORMATS: &[[&str; 3]] = &[
    ["src/bake/convention.rs", r#"".toml""#, "extension"],
    ["src/bake/make/making.rs", r#"".exr""#, "extension"],
    ["src/bake/make/write.rs", r#"".png""#, "extension"],
    [
        "src/bake/map_form.rs",
        r#"&format!(".{}", format.extension)"#,
        "extension",
    ],
    [
        "src/bake/map_form.rs",
        r#"&format!(".{extension}")"#,
        "extension",
    ],
    [
        "src/bake/paste.rs",
        r#""`)""#,
        "docs/paste.md, which is built in",
    ],
    [
        "src/bake/paste.rs",
        r####"&format!("### {language}\n")"####,
        "docs/paste.md, which is built in",
    ],
    [
        "src/bake/sh.rs",
        r#""irradiance""#,
        "comment of cmgen in its text files",
    ],
    [
        "src/bake/sh.rs",
        r#""pre-scaled""#,
        "comment of cmgen in its text files",
    ],
    ["src/bake/sh.rs", "'f'", "suffix of C's literals"],
    ["src/bake/source.rs", r#""sh.txt""#, "file name of cmgen"],
    ["src/bake/vtk_xml.rs", r#""<DataArray""#, "XML of VTK"],
    [
        "src/bake/vtk_xml.rs",
        r#"&format!(" {name}=\"")"#,
        "XML of VTK",
    ],
    ["src/bake/source.rs", r#""skybox""#, "file name of cmgen"],
    [
        "src/bake/source.rs",
        r#"&format!(".{extension}")"#,
        "extension",
    ],
    ["src/bake/face_folder.rs", "'.'", "extension"],
    ["src/bake/face_folder.rs", "'m'", "file name of cmgen"],
    [
        "src/base/glsl/source.rs",
        r##""#extension GL_GOOGLE_include""##,
        "GLSL",
    ],
    ["src/base/glsl/source.rs", r##""#include""##, "GLSL"],
    ["src/base/glsl/source.rs", r##""#pragma methods ""##, "GLSL"],
    ["src/base/glsl/source.rs", r##""#version""##, "GLSL"],
    [
        "src/base/glsl/source.rs",
        r#""ERROR: ""#,
        "message of glslang",
    ],
    ["src/base/glsl/source.rs", r#"".glsl""#, "extension"],
    ["src/base/glsl/source.rs", "'.'", "name of a hidden file"],
    [
        "src/base/glsl/source.rs",
        r#""selected/""#,
        "GLSL: a folder of includes",
    ],
    [
        "src/base/names.rs",
        "['a', 'e', 'i', 'o', 'u']",
        "the article of a noun",
    ],
    ["src/base/numbers.rs", "'e'", "scientific notation of Rust"],
    [
        "src/base/pixels/exr/color_label.rs",
        r#""_display""#,
        "name of a colour space",
    ],
    [
        "src/base/pixels/exr/color_label.rs",
        r#""_scene""#,
        "name of a colour space",
    ],
    [
        "src/base/pixels/exr/layers.rs",
        "'.'",
        "channel names of OpenEXR",
    ],
    [
        "src/base/pixels/gain_map/metadata.rs",
        r#"&format!("</{tag}")"#,
        "XML",
    ],
    [
        "src/base/pixels/radiance/header.rs",
        r##""#?""##,
        "header of Radiance",
    ],
    [
        "src/base/pixels/radiance/header.rs",
        r#""-vt""#,
        "views of Radiance",
    ],
    ["src/cli/bake.rs", r#"".toml""#, "extension"],
    [
        "src/cli/check_shader.rs",
        "|c: char| c.is_ascii_digit()",
        "identifier of GLSL",
    ],
    [
        "src/cli/cost.rs",
        r#"&format!(":{}", shading.brdf.name())"#,
        "name of a shader's permutation",
    ],
    ["src/cli/mod.rs", r#"['\n', '\t']"#, "lines"],
    ["src/cli/plan.rs", r#""{\n""#, "JSON"],
    [
        "src/cost/isa.rs",
        r#""(then repeated ""#,
        "assembly of RADV",
    ],
    ["src/cost/isa.rs", r#""s_branch""#, "assembly of RADV"],
    ["src/cost/isa.rs", r#""s_cbranch""#, "assembly of RADV"],
    ["src/cost/isa.rs", "':'", "assembly of RADV"],
    [
        "src/draw/figure/scale.rs",
        "'e'",
        "scientific notation of Rust",
    ],
    ["src/draw/figure/sheet.rs", "'.'", "decimal point of a tick"],
    ["src/draw/figure/sheet.rs", "'0'", "decimal point of a tick"],
    ["src/draw/figure/text.rs", "'…'", "the mark of a cut line"],
    ["src/draw/markdown.rs", r#""**""#, "Markdown"],
    ["src/draw/markdown.rs", r#""``""#, "Markdown"],
    ["src/experiment/config.rs", "['.', '-']", "names of files"],
    [
        "src/experiment/toml_tree.rs",
        r#""recurs""#,
        "error of toml, which has no kind",
    ],
    [
        "src/experiment/toml_tree.rs",
        r#""unclosed""#,
        "error of toml_parser, which has no kind",
    ],
    [
        "src/instrument/gpu/processor.rs",
        "':'",
        "fields of /proc/cpuinfo",
    ],
    [
        "src/instrument/environment/builtin/mod.rs",
        "':'",
        "name of a formula",
    ],
    [
        "src/instrument/scene/gltf/buffers.rs",
        r#"";base64,""#,
        "URI",
    ],
    ["src/instrument/scene/gltf/buffers.rs", r#""data:""#, "URI"],
    [
        "src/instrument/scene/gltf/document.rs",
        r#""2.""#,
        "version of glTF",
    ],
    ["src/instrument/scene/gltf/textures.rs", r#""data:""#, "URI"],
    [
        "src/instrument/scene/obj/mtl.rs",
        r#""Blender""#,
        "comment of exporters in MTL files",
    ],
    [
        "src/instrument/scene/obj/statements.rs",
        r#"'\u{feff}'"#,
        "byte order mark",
    ],
    [
        "src/instrument/shade/method/from_file/load.rs",
        r#""redefinition""#,
        "message of glslang",
    ],
    [
        "src/instrument/shade/method/from_file/load.rs",
        r#""shaders/""#,
        "message of glslang",
    ],
    [
        "src/instrument/shade/method/from_file/wgsl.rs",
        r#""layout""#,
        "GLSL that naga writes",
    ],
    [
        "src/instrument/shade/method/from_file/wgsl.rs",
        r#""void main""#,
        "GLSL that naga writes",
    ],
    [
        "src/instrument/shade/method/from_file/wgsl.rs",
        "' '",
        "GLSL that naga writes",
    ],
    [
        "src/instrument/gpu/shader/mod.rs",
        r#""window/""#,
        "folder of shaders",
    ],
    ["src/oracle/queries.rs", r#"'\u{feff}'"#, "byte order mark"],
    ["src/report/blocks.rs", r#""-->""#, "HTML"],
    ["src/report/gallery.rs", r#""..""#, "path"],
    ["src/report/gallery.rs", r#"".md""#, "extension"],
    ["src/report/gallery.rs", "'.'", "hidden file"],
    ["src/report/page/mod.rs", r#""<!doctype html>""#, "HTML"],
    ["src/report/page/page_run.rs", "'T'", "date of RFC 3339"],
    ["src/report/page/page_run.rs", "'Z'", "date of RFC 3339"],
    ["src/report/publish.rs", r#"".svg""#, "extension"],
    ["src/report/sheets.rs", r#"".svg""#, "extension"],
    ["src/report/summary.rs", r#"".svg""#, "extension"],
    [
        "src/run/images.rs",
        "|c: char| c.is_ascii_digit()",
        "range of numbers",
    ],
    ["src/run/provenance.rs", r#""model name""#, "/proc/cpuinfo"],
    ["src/run/provenance.rs", "':'", "/proc/cpuinfo"],
    ["src/run/seal.rs", r#""\"checksum\"""#, "JSON"],
    ["src/run/store/identity.rs", r#"".json""#, "extension"],
    ["src/run/store/mod.rs", r#"".csv.part""#, "extension"],
    ["src/run/store/mod.rs", r#"".part""#, "extension"],
    ["src/view/screen.rs", r#"": ""#, "error of winit"],
    ["src/view/screen.rs", r#""os error at ""#, "error of winit"],
];

/// Characters of a text's words. Other marks (`=`, `/`, `#`) are the syntax of a format.
fn is_word(c: char) -> bool {
    c.is_alphanumeric() || " .,;:!?\u{2026}*".contains(c)
}

/// Whether an argument has a letter or a mark of words.
fn is_part_of_words(argument: &str) -> bool {
    // Escapes such as `\n` are syntax.
    let is_escaped = |at: usize| argument[..at].ends_with('\\');
    argument
        .char_indices()
        .any(|(at, c)| is_word(c) && !is_escaped(at))
}

/// Whether an argument that begins so is a text, a mark or a closure that tests characters.
fn is_literal(argument: &str) -> bool {
    argument.starts_with(['"', '\'', '[', '|']) || argument.starts_with("&format!")
}

/// The arguments that follow an opening parenthesis, as written.
fn argument(text: &str) -> &str {
    let mut depth = 1;
    let mut quote = None;
    let mut is_escaped = false;
    for (at, c) in text.char_indices() {
        match quote {
            _ if is_escaped => is_escaped = false,
            Some(_) if c == '\\' => is_escaped = true,
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '"' || c == '\'' => quote = Some(c),
            None if "([{".contains(c) => depth += 1,
            None if ")]}".contains(c) => depth -= 1,
            None => {}
        }
        if depth == 0 {
            return text[..at].trim();
        }
    }
    panic!("a call without an end: {text}");
}

/// The parts of texts that a source file looks for, without its unit tests.
fn searched(source: &str) -> BTreeSet<String> {
    let code = code(source);
    let code = code.split("#[cfg(test)]").next().unwrap_or_default();
    let mut found = BTreeSet::new();
    for (name, is_text) in SEARCHES
        .iter()
        .map(|name| (name, false))
        .chain(CONTAINS.iter().map(|name| (name, true)))
    {
        let call = format!("{name}(");
        for (at, _) in code.match_indices(&call) {
            let is_longer_name = code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
            let rest = code[at + call.len()..].trim_start();
            let is_searched = if is_text {
                rest.starts_with('"')
            } else {
                is_literal(rest)
            };
            if is_longer_name || !is_searched {
                continue;
            }
            let argument = argument(rest);
            if is_text || argument.starts_with('"') || is_part_of_words(argument) {
                found.insert(argument.to_owned());
            }
        }
    }
    found
}

#[test]
fn nothing_decides_on_the_words_of_a_text() {
    assert_eq!(
        searched(
            "a.starts_with(\"so \"); b.split_once('='); c.strip_suffix(NAME); \
             d.ends_with(|c: char| c.is_ascii_digit()); e.contains(&x); f.trim_end_matches('.')"
        )
        .into_iter()
        .collect::<Vec<_>>(),
        ["\"so \"", "'.'", "|c: char| c.is_ascii_digit()"]
    );
    let mut listed: BTreeSet<(&str, String)> = FORMATS
        .iter()
        .map(|[file, part, _]| (*file, part.to_string()))
        .collect();
    assert_eq!(listed.len(), FORMATS.len(), "a format is listed twice");
    let files = rust_files();
    // Unit tests may look at whatever is written.
    for file in files.iter().filter(|file| !file.ends_with("tests.rs")) {
        let name = file.to_str().unwrap();
        for part in searched(&read(file)) {
            let is_listed = listed.remove(&(name, part.clone()));
            assert!(
                is_listed,
                "{name} looks for {part} in a text: give it a type, or name the format in FORMATS"
            );
        }
    }
    assert_eq!(listed, BTreeSet::new(), "formats that no code looks for");
}
