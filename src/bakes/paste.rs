//! The code of docs/paste.md.

use super::container::write_table;
use crate::brdf::{Brdf, Ggx, MaskingShadowing};
use crate::precompute::prefilter::{Kernel, LevelMapping};
use crate::precompute::taps::{Chain, TapCount, TapTable};

const PAGE: &str = include_str!("../../docs/paste.md");

/// The table of two taps beside an engine's files.
pub const TAPS: &str = "taps.ktx2";

/// Fitted tables for GGX with correlated masking and the levels that engines have by default, since a fit takes more time
/// than the maps of a bake. By weight, level mapping and number of levels.
static FITTED: &[(&str, &[u8])] = &[
    ("cosine-linear-6", include_bytes!("../../assets/bakes/taps/cosine-linear-6.ktx2")),
    ("cosine-quadratic-5", include_bytes!("../../assets/bakes/taps/cosine-quadratic-5.ktx2")),
    ("cosine-quadratic-6", include_bytes!("../../assets/bakes/taps/cosine-quadratic-6.ktx2")),
    ("cosine-unity-7", include_bytes!("../../assets/bakes/taps/cosine-unity-7.ktx2")),
    ("masking-unity-7", include_bytes!("../../assets/bakes/taps/masking-unity-7.ktx2")),
];

/// Returns the table of two taps for the levels of a prefiltered map; a KTX 2 file.
pub fn taps(kernel: Kernel, masking: MaskingShadowing, mapping: &'static LevelMapping, level_count: u32) -> Vec<u8> {
    let name = format!("{}-{}-{level_count}", kernel.weight.name, mapping.name);
    let is_usual = kernel.brdf.name() == Ggx.name() && masking == MaskingShadowing::Correlated;
    if let Some((_, file)) = FITTED.iter().find(|(fitted, _)| is_usual && *fitted == name) {
        return file.to_vec();
    }
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
