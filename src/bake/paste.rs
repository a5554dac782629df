//! The code of docs/paste.md.

use crate::base::names::Listed;
use crate::base::pixels::Pixels;
use crate::instrument::brdf::{Brdf, Ggx, MaskingShadowing};
use crate::instrument::precompute::prefilter::{Kernel, LevelSpacing};
use crate::instrument::precompute::taps::{Chain, TapCount, TapTable};
use half::f16;
use ruzstd::decoding::StreamingDecoder;
use std::io::Read;

const PAGE: &str = include_str!("../../docs/paste.md");

/// File of the table of two taps in a bake for an engine.
pub const TAPS: &str = "taps.ktx2";

/// Fitted tables of GGX for the default levels of engines and of `splitsum bake`: a fit takes more
/// time than the maps. Each is the texels of a fresh fit in half floats: without its entry here,
/// `tail -c +201 taps.ktx2 | zstd --ultra -22 --no-check`.
macro_rules! fitted {
    ($($name:literal)*) => {
        [$(($name, include_bytes!(concat!("../../assets/bakes/taps/", $name, ".zst")))),*]
    };
}
static FITTED: [(&str, &[u8]); 8] = fitted![
    "one-separable-cosine-linear-5"
    "two-separable-cosine-linear-5"
    "four-separable-cosine-linear-5"
    "two-correlated-cosine-linear-6"
    "two-correlated-cosine-quadratic-5"
    "two-correlated-cosine-quadratic-6"
    "two-correlated-cosine-unity-7"
    "two-correlated-masking-unity-7"
];

/// Returns the table of taps for the levels of a prefiltered map.
pub fn taps(
    kernel: Kernel,
    masking: MaskingShadowing,
    spacing: LevelSpacing,
    count: TapCount,
) -> Pixels<[f32; 4]> {
    match fitted(kernel, masking, spacing, count) {
        Some(packed) => unpacked(packed, count),
        None => {
            let chain = Chain::spaced(kernel, spacing);
            TapTable::fit(&chain, kernel.brdf, masking, count).texels
        }
    }
}

/// The fitted table of these levels, packed, if there is one.
fn fitted(
    kernel: Kernel,
    masking: MaskingShadowing,
    spacing: LevelSpacing,
    count: TapCount,
) -> Option<&'static [u8]> {
    let LevelSpacing {
        mapping,
        level_count,
    } = spacing;
    let name = format!(
        "{}-{}-{}-{}-{level_count}",
        count.word(),
        masking.name(),
        kernel.weight.name,
        mapping.name
    );
    let known = FITTED
        .iter()
        .filter(|_| kernel.brdf.name() == Ggx.name())
        .find(|(fitted, _)| *fitted == name);
    known.map(|(_, packed)| *packed)
}

/// Unpacks a fitted table.
fn unpacked(packed: &[u8], count: TapCount) -> Pixels<[f32; 4]> {
    let [width, height] = TapTable::size(count);
    let mut bytes = Vec::new();
    StreamingDecoder::new(packed)
        .expect("a file of the program")
        .read_to_end(&mut bytes)
        .expect("a file of the program");
    let half = |bytes: &[u8; 2]| f16::from_le_bytes(*bytes).to_f32();
    let texel = |texel: &[u8; 8]| [0, 1, 2, 3].map(|i| half(&texel.as_chunks().0[i]));
    let texels = bytes.as_chunks().0.iter().map(texel).collect();
    Pixels::new(width, height, texels)
}

/// Returns name and text of a file with the code for [`TAPS`]: the functions, and their use as a
/// comment.
pub fn file(language: &str) -> (String, String) {
    let [functions, lines] = code(language, "split-sum-two").expect("a language of the page");
    let lines: String = lines
        .lines()
        .map(|line| format!("//     {line}\n"))
        .collect();
    let text = format!(
        "// Two lookups of the prefiltered map. taps: {TAPS}, bilinear, clamped to edges, no \
         mips.\n\n{functions}\n\
         // Replaces the lookup along r. dfg: (A, B). map: the prefiltered map; turn its \
         directions as you turn r.\n\
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
        let blocks: Vec<&str> = fenced
            .filter_map(|block| Some(block.split_once('\n')?.1))
            .collect();
        // A use without functions continues the method above it.
        if let [before, _] = blocks[..] {
            functions = before;
        }
        if name == method {
            return Some([functions, blocks.last()?]);
        }
    }
    None
}
