//! The code of docs/paste.md.

const PAGE: &str = include_str!("../../docs/paste.md");

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
