//! Overlays, and the picture of both halves.

use super::worker::{Shot, Shown};
use crate::experiment::axis::SAMPLES;
use crate::pixels::Rgb8Image;
use crate::table::colormap::ColorScale;
use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Ui, pos2, vec2};

/// Describes an image: method, samples, resolution.
pub fn label(shot: &Shot) -> String {
    let point = &shot.image.point;
    let count = match point.method().is_integrated() || point.diffuse().is_integrated() {
        true => Some(shot.image.view.reference_samples),
        false => point.method().uses_samples.then(|| point[SAMPLES].count()),
    };
    let count = count.map_or_else(String::new, |count| format!(", {count} samples"));
    let coarse = if shot.scale > 1 { format!(" (1/{})", shot.scale) } else { String::new() };
    format!("{}{count}{coarse}", point.method().name)
}

/// Joins both halves at the resolution of the finer one.
pub fn composed(shown: &Shown, wipe: f32) -> Option<Rgb8Image> {
    if let Some(part) = &shown.part {
        return Some((**part).clone());
    }
    let (left, right) = (shown.left.as_ref()?, shown.right.as_ref()?);
    let finer = if left.scale <= right.scale { left } else { right };
    let (width, height) = (finer.picture.width, finer.picture.height);
    let edge = (wipe * width as f32).round() as u32;
    let sample = |shot: &Shot, x: u32, y: u32| {
        let picture = &shot.picture;
        let place = |at: u32, side: u32, whole: u32| (u64::from(at) * u64::from(side) / u64::from(whole)) as u32;
        picture.get(place(x, picture.width, width), place(y, picture.height, height))
    };
    Some(Rgb8Image::from_fn(width, height, |x, y| sample(if x < edge { left } else { right }, x, y)))
}

/// Writes white text on a dark ground.
pub fn outlined(ui: &Ui, place: Pos2, align: Align2, text: &str, width: f32) {
    let font = FontId::proportional(13.0);
    let galley = ui.painter().layout(text.to_owned(), font, Color32::WHITE, width);
    let rect = align.anchor_size(place, galley.size());
    ui.painter().rect_filled(rect.expand(3.0), 3.0, Color32::from_black_alpha(150));
    ui.painter().galley(rect.min, galley, Color32::WHITE);
}

/// Writes plain text.
pub fn text(ui: &Ui, place: Pos2, align: Align2, text: &str, size: f32, color: Color32) {
    ui.painter().text(place, align, text, FontId::proportional(size), color);
}

/// Draws the colours of an error with their values.
pub fn legend(ui: &Ui, rect: Rect, colors: &ColorScale, about: &str) {
    let bar = Rect::from_min_size(rect.left_bottom() + vec2(24.0, -36.0), vec2(180.0, 10.0));
    let back = bar.expand2(vec2(18.0, 20.0));
    ui.painter().rect_filled(back, 3.0, Color32::from_black_alpha(170));
    text(ui, back.center_top() + vec2(0.0, 3.0), Align2::CENTER_TOP, about, 11.0, Color32::WHITE);
    for step in 0..90 {
        let [r, g, b] = colors.palette.color(f64::from(step) / 89.0);
        let x = bar.left() + step as f32 * 2.0;
        ui.painter().rect_filled(
            Rect::from_min_size(pos2(x, bar.top()), vec2(2.0, bar.height())),
            0.0,
            Color32::from_rgb(r, g, b),
        );
    }
    for tick in colors.ticks() {
        let x = bar.left() + colors.place(tick) as f32 * bar.width();
        text(ui, pos2(x, bar.bottom() + 3.0), Align2::CENTER_TOP, &tick.to_string(), 10.0, Color32::WHITE);
    }
}

/// Draws the line between the halves at `x`, with its handle at `place`.
pub fn wipe_line(ui: &Ui, rect: Rect, x: f32, place: Rect) {
    let painter = ui.painter();
    // Dark beside light is visible on any picture.
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(90)));
    painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::from_white_alpha(200)));
    painter.rect_filled(place.shrink2(vec2(3.0, 1.0)), 5.0, Color32::from_black_alpha(90));
    painter.rect_filled(place.shrink2(vec2(4.0, 2.0)), 4.0, Color32::from_white_alpha(220));
    for dx in [-1.5, 1.5] {
        painter.vline(x + dx, place.shrink(9.0).y_range(), Stroke::new(1.0, Color32::DARK_GRAY));
    }
}
