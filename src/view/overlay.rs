//! What lies over the picture: captions, legend, wipe and probe.

use super::picture::pixel;
use super::shown::{Shot, Shown};
use super::theme;
use crate::base::pixels::RgbImage;
use crate::draw::colormap::{ColorScale, Range as ColorRange};
use crate::draw::markdown::significant;
use crate::experiment::axis::SAMPLES;
use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Color32, FontId, Rect, Stroke, Ui, Vec2, pos2, vec2};

/// Size of the colours of a legend, points, and their distance to the texts.
const BAR: Vec2 = vec2(132.0, 8.0);
const BAR_GAP: f32 = 8.0;

/// Writes method, resolution and score of a half into a corner.
pub fn caption(ui: &Ui, rect: Rect, align: egui::Align2, shot: &Shot, is_stale: bool) {
    let point = &shot.image.point;
    let method = point.method();
    let samples = if method.is_integrated() {
        Some(shot.image.view.reference_samples)
    } else {
        method.uses_samples.then(|| point[SAMPLES].count())
    };
    let title = method.words(samples);
    let mut job = LayoutJob::default();
    let title_format = TextFormat::simple(theme::medium(13.5), theme::color(method.role()));
    job.append(&title, 0.0, title_format);
    let (details, color) = if is_stale {
        ("updating".to_owned(), theme::WARN)
    } else {
        (details(shot), theme::MUTED)
    };
    if !details.is_empty() {
        let format = TextFormat::simple(FontId::proportional(12.0), color);
        job.append(&format!("\n{details}"), 0.0, format);
    }
    job.halign = align.x();
    veiled(ui, rect, align, job);
}

/// Resolution and score of a half, as far as it has some.
fn details(shot: &Shot) -> String {
    let mut details = Vec::new();
    if shot.scale > 1 {
        details.push(format!("1/{} of the resolution", shot.scale));
    }
    details.extend(shot.fault.clone());
    if let Some(score) = shot.score {
        let percent = significant(100.0 * score.sqrt(), 2);
        details.push(format!(
            "relMSE {} · {percent} % rms",
            significant(score, 2)
        ));
    }
    details.join(" · ")
}

/// Writes text on a dark ground, within a rectangle.
pub fn veiled(ui: &Ui, within: Rect, align: egui::Align2, mut job: LayoutJob) {
    job.wrap.max_width = within.width();
    let galley = ui.painter().layout_job(job);
    let rect = align.anchor_size(align.pos_in_rect(&within), galley.size());
    ui.painter()
        .rect_filled(rect.expand2(vec2(8.0, 5.0)), 6.0, theme::VEIL);
    let x = if align.x() == Align::Max {
        rect.right()
    } else {
        rect.left()
    };
    ui.painter().galley(pos2(x, rect.top()), galley, theme::INK);
}

/// Draws the colours of an error with their values, in percent.
pub fn legend(ui: &Ui, rect: Rect, colors: &ColorScale) {
    let percent = |value: f64| format!("{} %", 100.0 * value);
    let [low, high] = match colors.range {
        ColorRange::Log { lo, hi } => [
            format!("Error {}", percent(lo)),
            format!("{} or more", percent(hi)),
        ],
        ColorRange::Linear { lo, hi } => [
            format!("{} too dark", percent(-lo)),
            format!("{} too bright", percent(hi)),
        ],
    };
    let painter = ui.painter();
    let text = |text: String| painter.layout_no_wrap(text, FontId::proportional(12.0), theme::INK);
    let low = text(low);
    let high = text(high);
    let size = vec2(
        low.size().x + BAR.x + high.size().x + 2.0 * BAR_GAP,
        low.size().y,
    );
    // To the right of the toolbar, or below it.
    let corner = if rect.width() > 800.0 {
        pos2(rect.right() - size.x - 18.0, 20.0)
    } else {
        pos2(rect.left() + 18.0, 58.0)
    };
    let ground = Rect::from_min_size(corner + vec2(0.0, rect.top()), size);
    painter.rect_filled(ground.expand2(vec2(8.0, 5.0)), 6.0, theme::VEIL);
    let bar_left = ground.left() + low.size().x + BAR_GAP;
    for step in 0..BAR.x as u32 {
        let share = f64::from(step) / f64::from(BAR.x - 1.0);
        let [r, g, b] = colors.palette.color(share);
        let corner = pos2(bar_left + step as f32, ground.center().y - 0.5 * BAR.y);
        painter.rect_filled(
            Rect::from_min_size(corner, vec2(1.0, BAR.y)),
            0.0,
            Color32::from_rgb(r, g, b),
        );
    }
    painter.galley(ground.left_top(), low, theme::INK);
    let high_corner = pos2(bar_left + BAR.x + BAR_GAP, ground.top());
    painter.galley(high_corner, high, theme::INK);
}

/// Draws the line between the halves with its handle.
pub fn wipe_line(ui: &Ui, line: Rect) {
    let painter = ui.painter();
    let x = line.center().x;
    let y = line.center().y;
    // A dark and a light line together are visible on any picture.
    painter.vline(
        x,
        line.y_range(),
        Stroke::new(3.0, Color32::from_black_alpha(90)),
    );
    painter.vline(
        x,
        line.y_range(),
        Stroke::new(1.0, Color32::from_white_alpha(200)),
    );
    painter.circle(pos2(x, y), 11.0, theme::VEIL, Stroke::new(1.5, theme::INK));
    for side in [-1.0, 1.0] {
        let tip = [vec2(2.0, -3.5), vec2(5.5, 0.0), vec2(2.0, 3.5)]
            .map(|v| pos2(x + side * v.x, y + v.y));
        painter.line(tip.to_vec(), Stroke::new(1.5, theme::INK));
    }
}

/// The values of a pixel in both halves and the reference, one a line.
pub fn probe(shown: &Shown, pixel: Option<[u32; 2]>) -> String {
    let head = match pixel {
        Some([x, y]) => format!("Pixel {x}, {y}"),
        None => "Point at a pixel".to_owned(),
    };
    let [left, right] = &shown.halves;
    let mut text = format!("{head:<18} red     green   blue      standard error\n");
    for (name, shot) in [
        ("Left", left),
        ("Right", right),
        ("Reference", &shown.truth),
    ] {
        let [radiance, error] = match (shot, pixel) {
            (Some(shot), Some(pixel)) => probed_values(shot, pixel),
            _ => [String::new(), String::new()],
        };
        text += &format!("{name:<16} {radiance:<23}  {error}\n");
    }
    text
}

/// Radiance and standard error of a pixel of the whole picture; empty if there is none.
fn probed_values(shot: &Shot, [x, y]: [u32; 2]) -> [String; 2] {
    let values = |image: &RgbImage| {
        pixel(image, x / shot.scale, y / shot.scale)
            .map(|rgb| rgb.map(|c| format!("{c:7.4}")).join(" "))
            .unwrap_or_default()
    };
    let Some(frame) = &shot.frame else {
        return Default::default();
    };
    let error = frame.standard_error.as_ref();
    [
        values(&frame.radiance),
        error.map(values).unwrap_or_default(),
    ]
}
