//! The code of docs/paste.md.

use super::container::write_table;
use crate::brdf::MaskingShadowing;
use crate::precompute::prefilter::{Kernel, LevelMapping};
use crate::precompute::taps::{Chain, TapCount, TapTable};

const PAGE: &str = include_str!("../../docs/paste.md");

/// The table of two taps beside an engine's files.
pub const TAPS: &str = "taps.ktx2";

/// Fits the table of two taps to the levels of a prefiltered map; a KTX 2 file.
pub fn taps(kernel: Kernel, masking: MaskingShadowing, mapping: &'static LevelMapping, level_count: u32) -> Vec<u8> {
    let chain = Chain::new(kernel, mapping, level_count);
    write_table(&TapTable::fit(&chain, kernel.brdf, masking, TapCount::Two).texels)
}

/// Returns name and text of a file with the code for [`TAPS`]: the functions, and their use as a comment.
pub fn file(language: &str) -> (String, String) {
    let [functions, lines] = code(language, "split-sum-two").expect("a language of the page");
    let lines: String = lines.lines().map(|line| format!("//     {line}\n")).collect();
    let text = format!(
        "// Two lookups of the prefiltered map. taps: {TAPS}, bilinear, clamped to edges, no mips.\n\n{functions}\n\
         // Replaces the lookup along r. dfg: (A, B). map: the prefiltered map; turn its directions as you turn r.\n\
         {lines}"
    );
    (TAPS.replace("ktx2", &language.to_lowercase()), text)
}

/// Returns functions and use of a method in `GLSL`, `HLSL` or `WGSL`; `None` if the page has none.
pub fn code(language: &str, method: &str) -> Option<[&'static str; 2]> {
    let (_, rest) = PAGE.split_once(&format!("### {language}\n"))?;
    let mut functions = "";
    for part in rest.split("\n### ").next()?.split("(`").skip(1) {
        let (name, text) = part.split_once("`)")?;
        let fenced = text.split("```").skip(1).step_by(2);
        let blocks: Vec<&str> = fenced.filter_map(|block| Some(block.split_once('\n')?.1)).collect();
        // A use without functions continues the method above it.
        if let [own, _] = blocks[..] {
            functions = own;
        }
        if name == method {
            return Some([functions, blocks.last()?]);
        }
    }
    None
}
