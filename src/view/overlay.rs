//! The picture of both halves with its captions, legend, wipe and probe.

use super::picture::at;
use super::theme;
use super::worker::{Shot, Shown};
use crate::base::pixels::{Rgb8Image, RgbImage};
use crate::draw::colormap::{ColorScale, Range};
use crate::draw::markdown::significant;
use crate::experiment::axis::SAMPLES;
use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Color32, FontId, Rect, Stroke, Ui, pos2, vec2};

/// Brightness of a half that is out of date, of 256.
const DIM: u32 = 96;

/// Place of the picture in the window, in its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Canvas {
    pub corner: [u32; 2],
    pub size: [u32; 2],
    /// Share of the width for the left half.
    pub wipe: f32,
    pub is_stale: [bool; 2],
}

impl Canvas {
    /// Calls `put` with each row of each half: its place and colours. Does nothing before the first
    /// picture.
    pub fn paint(&self, shown: &Shown, mut put: impl FnMut(u32, u32, &[[u8; 3]])) {
        let [width, height] = self.size;
        let edge = (self.wipe * width as f32).round() as u32;
        for ((shot, columns), is_stale) in shown
            .halves
            .iter()
            .zip([0..edge, edge..width])
            .zip(self.is_stale)
        {
            let Some(Shot { picture, scale, .. }) = shot else {
                continue;
            };
            let brightness = if is_stale { DIM } else { 256 };
            let across: Vec<Texel> = columns
                .clone()
                .map(|x| Texel::at(x, width, picture.width, *scale))
                .collect();
            let stretched = |y: u32| -> Vec<[u32; 3]> {
                let row = &picture.data[(y * picture.width) as usize..][..picture.width as usize];
                across
                    .iter()
                    .map(|texel| {
                        texel.mean(
                            row[texel.first].map(u32::from),
                            row[texel.second].map(u32::from),
                        )
                    })
                    .collect()
            };
            let mut rows = [(0, stretched(0)), (0, stretched(0))];
            let mut line = vec![[0; 3]; columns.len()];
            for y in 0..height {
                let down = Texel::at(y, height, picture.height, *scale);
                let (near, far) = ((256 - down.weight) * brightness, down.weight * brightness);
                for (row, place) in rows.iter_mut().zip([down.first, down.second]) {
                    if row.0 != place {
                        *row = (place, stretched(place as u32));
                    }
                }
                for ((color, above), below) in line.iter_mut().zip(&rows[0].1).zip(&rows[1].1) {
                    for channel in 0..3 {
                        color[channel] =
                            ((above[channel] * near + below[channel] * far) >> 24) as u8;
                    }
                }
                put(columns.start, y, &line);
            }
        }
    }
}

/// The two texels that a pixel lies between, and the weight of the second, of 256.
struct Texel {
    first: usize,
    second: usize,
    weight: u32,
}

impl Texel {
    /// Interpolates coarse pictures; pixels of whole ones stay squares.
    fn at(at: u32, whole: u32, side: u32, scale: u32) -> Self {
        let place = (at as f32 + 0.5) * side as f32 / whole as f32;
        let place = if scale == 1 {
            place.floor()
        } else {
            (place - 0.5).max(0.0)
        };
        let (first, last) = (place as usize, side as usize - 1);
        Self {
            first: first.min(last),
            second: (first + 1).min(last),
            weight: ((place - first as f32) * 256.0) as u32,
        }
    }

    /// Returns 256 times the weighted mean.
    #[inline]
    fn mean(&self, [r, g, b]: [u32; 3], [s, h, c]: [u32; 3]) -> [u32; 3] {
        let near = 256 - self.weight;
        [
            r * near + s * self.weight,
            g * near + h * self.weight,
            b * near + c * self.weight,
        ]
    }
}

/// Returns the picture as it is saved: at the resolution of the finer half.
pub fn composed(shown: &Shown, wipe: f32) -> Option<Rgb8Image> {
    let [width, height] = shown.size()?;
    let mut image = Rgb8Image::filled(width, height, [0; 3]);
    let canvas = Canvas {
        size: [width, height],
        wipe,
        ..Canvas::default()
    };
    canvas.paint(shown, |x, y, row| {
        image.data[(y * width + x) as usize..][..row.len()].copy_from_slice(row)
    });
    Some(image)
}

/// Writes method, resolution and score of a half into a corner.
pub fn caption(ui: &Ui, place: Rect, align: egui::Align2, shot: &Shot, is_stale: bool) {
    let (point, method) = (&shot.image.point, shot.image.point.method());
    let samples = match method.is_integrated() {
        true => Some(shot.image.view.reference_samples),
        false => method.uses_samples.then(|| point[SAMPLES].count()),
    };
    let mut details = Vec::new();
    if shot.scale > 1 && !is_stale {
        details.push(format!("1/{} of the resolution", shot.scale));
    }
    if let Some(score) = shot.score.filter(|_| !is_stale) {
        let percent = significant(100.0 * score.sqrt(), 2);
        details.push(format!(
            "relMSE {} · {percent} % rms",
            significant(score, 2)
        ));
    }
    let mut job = LayoutJob::default();
    let mut add =
        |text: &str, font: FontId, color| job.append(text, 0.0, TextFormat::simple(font, color));
    add(
        &method.words(samples.map(|count| count.to_string()).as_deref()),
        theme::medium(13.5),
        theme::color(method.role()),
    );
    let (below, color) = if is_stale {
        ("updating".to_owned(), theme::WARN)
    } else {
        (details.join(" · "), theme::MUTED)
    };
    if !below.is_empty() {
        add(&format!("\n{below}"), FontId::proportional(12.0), color);
    }
    job.halign = align.x();
    veiled(ui, place, align, job);
}

/// Writes text on a dark ground, within `place`.
pub fn veiled(ui: &Ui, place: Rect, align: egui::Align2, mut job: LayoutJob) {
    job.wrap.max_width = place.width();
    let galley = ui.painter().layout_job(job);
    let rect = align.anchor_size(align.pos_in_rect(&place), galley.size());
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
    let (low, high) = match colors.range {
        Range::Log { lo, hi } => (
            format!("Error {}", percent(lo)),
            format!("{} or more", percent(hi)),
        ),
        Range::Linear { lo, hi } => (
            format!("{} too dark", percent(-lo)),
            format!("{} too bright", percent(hi)),
        ),
    };
    let font = || FontId::proportional(12.0);
    let [low, high] = [low, high].map(|text| ui.painter().layout_no_wrap(text, font(), theme::INK));
    let (bar, gap) = (vec2(132.0, 8.0), 8.0);
    let size = vec2(
        low.size().x + bar.x + high.size().x + 2.0 * gap,
        low.size().y,
    );
    // To the right of the toolbar, or below it.
    let place = if rect.width() > 800.0 {
        pos2(rect.right() - size.x - 18.0, 20.0)
    } else {
        pos2(rect.left() + 18.0, 58.0)
    };
    let back = Rect::from_min_size(place + vec2(0.0, rect.top()), size);
    ui.painter()
        .rect_filled(back.expand2(vec2(8.0, 5.0)), 6.0, theme::VEIL);
    let first = back.left() + low.size().x + gap;
    for step in 0..bar.x as u32 {
        let [r, g, b] = colors
            .palette
            .color(f64::from(step) / f64::from(bar.x - 1.0));
        let place = pos2(first + step as f32, back.center().y - 0.5 * bar.y);
        ui.painter().rect_filled(
            Rect::from_min_size(place, vec2(1.0, bar.y)),
            0.0,
            Color32::from_rgb(r, g, b),
        );
    }
    ui.painter().galley(back.left_top(), low, theme::INK);
    ui.painter()
        .galley(pos2(first + bar.x + gap, back.top()), high, theme::INK);
}

/// Draws the line between the halves with its handle.
pub fn wipe_line(ui: &Ui, line: Rect) {
    let painter = ui.painter();
    let (x, y) = (line.center().x, line.center().y);
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

pub fn probe(shown: &Shown, probed: Option<[u32; 2]>) -> String {
    let place = probed.map_or_else(
        || "Point at a pixel".to_owned(),
        |[x, y]| format!("Pixel {x}, {y}"),
    );
    let mut text = format!("{place:<18} red     green   blue      standard error\n");
    for (name, shot) in ["Left", "Right", "Reference"]
        .into_iter()
        .zip(shown.halves.iter().chain([&shown.truth]))
    {
        let value = |image: Option<&RgbImage>| {
            let ([x, y], scale) = (probed?, shot.as_ref()?.scale);
            at(image?, x / scale, y / scale).map(|rgb| rgb.map(|c| format!("{c:7.4}")).join(" "))
        };
        let frame = shot.as_ref().map(|shot| &shot.frame);
        let radiance = value(frame.map(|frame| &frame.radiance)).unwrap_or_default();
        let error =
            value(frame.and_then(|frame| frame.standard_error.as_ref())).unwrap_or_default();
        text += &format!("{name:<16} {radiance:<23}  {error}\n");
    }
    text
}
