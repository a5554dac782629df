//! Measures, wraps and draws text on images, antialiased.

use crate::pixels::Rgb8Image;
use ab_glyph::{Font, FontRef, Glyph, GlyphId, PxScale, ScaleFont, point};
use std::sync::LazyLock;

/// Ubuntu, then Hack for missing characters.
static FONTS: LazyLock<[FontRef<'static>; 2]> = LazyLock::new(|| {
    [epaint_default_fonts::UBUNTU_LIGHT, epaint_default_fonts::HACK_REGULAR]
        .map(|bytes| FontRef::try_from_slice(bytes).expect("a font that is part of the program can be read"))
});

/// Distance of two baselines, in text sizes.
const LINE_HEIGHT: f32 = 1.25;
/// Middle of lower-case letters above the baseline, in text sizes.
const MIDDLE_HEIGHT: f32 = 0.27;
/// Exponent of the coverage: the light face would look grey at 14 pixels.
const REGULAR_WEIGHT: f32 = 0.62;
/// Shift of the second stroke of bold text, in text sizes.
const BOLD_STROKE: f32 = 0.045;

/// `size` in pixels per em.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    pub size: f32,
    pub color: [u8; 3],
    pub is_bold: bool,
}

impl Style {
    pub fn line_height(self) -> f32 {
        (self.size * LINE_HEIGHT).round()
    }

    /// Baseline that centres letters on `y`.
    pub fn baseline_at(self, y: f32) -> f32 {
        (y + self.size * MIDDLE_HEIGHT).round()
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Left,
    Center,
    Right,
}

/// Width of a line, pixels.
pub(crate) fn width(text: &str, style: Style) -> f32 {
    layout(text, style).1
}

/// Font and glyph from x = 0 on the baseline, and the width.
fn layout(text: &str, style: Style) -> (Vec<(usize, Glyph)>, f32) {
    let mut glyphs = Vec::new();
    let mut x = 0.0;
    // The second stroke eats into the gap to the next letter.
    let letter_space = if style.is_bold { style.size * BOLD_STROKE } else { 0.0 };
    let mut previous: Option<(usize, GlyphId)> = None;
    for character in text.chars() {
        let face = FONTS.iter().position(|font| font.glyph_id(character).0 != 0).unwrap_or(0);
        let font = &FONTS[face];
        // The library scales by the height of a line, not by the em.
        let scale = PxScale::from(style.size * font.height_unscaled() / font.units_per_em().unwrap_or(1000.0));
        let scaled = font.as_scaled(scale);
        let id = font.glyph_id(character);
        if let Some((_, left)) = previous.filter(|(other, _)| *other == face) {
            x += scaled.kern(left, id);
        }
        glyphs.push((face, id.with_scale_and_position(scale, point(x, 0.0))));
        x += scaled.h_advance(id) + letter_space;
        previous = Some((face, id));
    }
    (glyphs, x)
}

/// Draws a line, clipped to the image.
pub(crate) fn draw(canvas: &mut Rgb8Image, text: &str, anchor: Anchor, x: f32, baseline: f32, style: Style) {
    let (glyphs, width) = layout(text, style);
    let start = match anchor {
        Anchor::Left => x,
        Anchor::Center => (x - 0.5 * width).round(),
        Anchor::Right => x - width,
    };
    let strokes: &[f32] = if style.is_bold { &[0.0, BOLD_STROKE] } else { &[0.0] };
    for (face, mut glyph) in glyphs {
        let place = glyph.position;
        for stroke in strokes {
            glyph.position = point(start + place.x + stroke * style.size, baseline);
            let Some(outline) = FONTS[face].outline_glyph(glyph.clone()) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|column, row, coverage| {
                let (px, py) = (corner.x as i64 + i64::from(column), corner.y as i64 + i64::from(row));
                if px >= 0 && py >= 0 && px < i64::from(canvas.width) && py < i64::from(canvas.height) {
                    let index = py as usize * canvas.width as usize + px as usize;
                    blend(&mut canvas.data[index], style.color, coverage.clamp(0.0, 1.0).powf(REGULAR_WEIGHT));
                }
            });
        }
    }
}

fn blend(pixel: &mut [u8; 3], color: [u8; 3], coverage: f32) {
    for (under, over) in pixel.iter_mut().zip(color) {
        let mixed = f32::from(*under) + coverage * (f32::from(over) - f32::from(*under));
        *under = mixed.round() as u8;
    }
}

/// Breaks a text into lines of at most `max_width`, at spaces, after `-`, `_`, `/` and at line breaks, but not within `1e-2`. Longer parts stay
/// whole.
fn wrap(text: &str, style: Style, max_width: f32) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for part in parts(paragraph) {
            let longer = format!("{line}{part}");
            if !line.is_empty() && width(longer.trim_end(), style) > max_width {
                lines.push(line.trim_end().to_owned());
                line = part.to_owned();
            } else {
                line = longer;
            }
        }
        lines.push(line.trim_end().to_owned());
    }
    lines
}

/// The parts between possible line breaks. A minus before a digit belongs to its number.
fn parts(paragraph: &str) -> impl Iterator<Item = &str> {
    let mut rest = paragraph;
    std::iter::from_fn(move || {
        let breaks =
            |(at, mark): &(usize, &str)| *mark != "-" || !rest[at + 1..].starts_with(|c: char| c.is_ascii_digit());
        let end = rest.match_indices([' ', '-', '_', '/']).find(breaks).map_or(rest.len(), |(at, _)| at + 1);
        let (part, after) = rest.split_at(end);
        rest = after;
        (!part.is_empty()).then_some(part)
    })
}

/// At most `max_lines` lines of at most `max_width`, broken at any letter and truncated with `…` if necessary.
pub(crate) fn wrap_hard(text: &str, style: Style, max_width: f32, max_lines: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for mut line in wrap(text, style, max_width) {
        while width(&line, style) > max_width && line.chars().count() > 1 {
            let fits = |end: usize| width(&line[..end], style) <= max_width;
            let ends: Vec<usize> = line.char_indices().map(|(i, _)| i).skip(1).collect();
            let cut = ends.iter().copied().take_while(|&end| fits(end)).last().unwrap_or(ends[0]);
            let rest = line.split_off(cut);
            lines.push(std::mem::replace(&mut line, rest));
        }
        lines.push(line);
    }
    if lines.len() > max_lines {
        lines.truncate(max_lines);
        if let Some(last) = lines.last_mut() {
            while !last.is_empty() && width(&format!("{last}…"), style) > max_width {
                last.pop();
            }
            last.push('…');
        }
    }
    lines
}
