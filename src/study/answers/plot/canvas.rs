//! Marks and text on a picture in pixels. Everything below draws through this: `plotters` writes the SVG.

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoTextStyle, RGBColor, ShapeStyle, WHITE};

/// Why a picture could not be drawn. The canvas is memory, so this is a fault of the drawing library.
#[derive(Debug, thiserror::Error)]
#[error("a plot could not be drawn: {0}")]
pub struct PlotError(String);

type Area<'s> = DrawingArea<SVGBackend<'s>, Shift>;
type Fault<'s> = DrawingAreaErrorKind<<SVGBackend<'s> as plotters::backend::DrawingBackend>::ErrorType>;

fn fault(error: Fault) -> PlotError {
    PlotError(error.to_string())
}

pub type Rgb = [u8; 3];

/// Text and axes.
pub const INK: Rgb = [34, 34, 34];
/// Notes.
pub const MUTED: Rgb = [95, 95, 95];
/// Grid lines.
pub const GRID: Rgb = [225, 225, 225];

/// Colours for names, in the order in which they are used: the set of Okabe and Ito without its yellow, which is too pale on white.
const NAMES: [Rgb; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [0, 0, 0]];

/// The colour of the `index`th name.
pub fn name_color(index: usize) -> Rgb {
    NAMES[index % NAMES.len()]
}

/// Pixels between the left ends of two characters, for a font of one pixel: what a sans-serif needs at most on average.
const CHARACTER_WIDTH: f64 = 0.56;

/// Roughly how wide a text is, pixels. There is no font here to measure it with.
pub fn text_width(text: &str, size: i32) -> i32 {
    (text.chars().count() as f64 * f64::from(size) * CHARACTER_WIDTH).ceil() as i32
}

/// What tells series apart besides colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
}

impl Marker {
    /// The marker of the `index`th series.
    pub fn of(index: usize) -> Self {
        [Self::Circle, Self::Square, Self::Triangle, Self::Diamond, Self::Cross][index % 5]
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    Solid,
    Dashed,
    Dotted,
}

/// How a text is set.
#[derive(Clone, Copy)]
pub struct Look {
    pub size: i32,
    pub color: Rgb,
    pub h: HPos,
    pub is_bold: bool,
    pub is_upright: bool,
}

/// Text of a size from its left end, centred in height.
pub const fn look(size: i32) -> Look {
    Look { size, color: INK, h: HPos::Left, is_bold: false, is_upright: false }
}

impl Look {
    pub const fn centred(self) -> Self {
        Self { h: HPos::Center, ..self }
    }

    pub const fn right(self) -> Self {
        Self { h: HPos::Right, ..self }
    }

    pub const fn bold(self) -> Self {
        Self { is_bold: true, ..self }
    }

    pub const fn color(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// Reads from bottom to top.
    pub const fn upright(self) -> Self {
        Self { is_upright: true, ..self }
    }
}

/// `plotters` has no dashes of SVG, and many short lines are no line to restyle: widths that no line has stand for dashed ones until the
/// text is whole.
const DASHED: u32 = 1000;
const DOTTED: u32 = 2000;
/// The widths of lines in use.
const WIDTHS: std::ops::RangeInclusive<u32> = 1..=3;

/// A white picture.
pub struct Canvas<'s> {
    area: Area<'s>,
}

/// The SVG of what `draw` draws; `title` is what a screen reader says.
pub fn picture(
    title: &str,
    [width, height]: [i32; 2],
    draw: impl FnOnce(&Canvas) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (width as u32, height as u32)).into_drawing_area();
        area.fill(&WHITE).map_err(fault)?;
        let canvas = Canvas { area };
        draw(&canvas)?;
        canvas.area.present().map_err(fault)?;
    }
    for width in WIDTHS {
        for (code, dashes) in [(DASHED, "7 4"), (DOTTED, "2 3")] {
            let dashed = format!("stroke-width=\"{width}\" stroke-dasharray=\"{dashes}\"");
            svg = svg.replace(&format!("stroke-width=\"{}\"", code + width), &dashed);
        }
    }
    let escaped = title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    Ok(svg.replacen('>', &format!(" role=\"img\">\n<title>{escaped}</title>"), 1))
}

impl Canvas<'_> {
    pub fn text(&self, text: &str, at: (i32, i32), look: Look) -> Result<(), PlotError> {
        let style = ("sans-serif", f64::from(look.size) * FONT_UNIT).into_text_style(&self.area);
        let color = rgb(look.color);
        let style = style.color(&color).pos(Pos::new(look.h, VPos::Center));
        let style = if look.is_bold { with_font_style(style, FontStyle::Bold) } else { style };
        let style = if look.is_upright { style.transform(FontTransform::Rotate270) } else { style };
        self.area.draw(&Text::new(text.to_owned(), at, style)).map_err(fault)
    }

    /// Lines through points.
    pub fn path(&self, points: &[(i32, i32)], color: Rgb, width: u32, stroke: Stroke) -> Result<(), PlotError> {
        if points.len() < 2 {
            return Ok(());
        }
        let width = match stroke {
            Stroke::Solid => width,
            Stroke::Dashed => DASHED + width,
            Stroke::Dotted => DOTTED + width,
        };
        let style = ShapeStyle::from(rgb(color)).stroke_width(width);
        self.area.draw(&PathElement::new(points.to_vec(), style)).map_err(fault)
    }

    pub fn filled(&self, points: &[(i32, i32)], color: Rgb, opacity: f64) -> Result<(), PlotError> {
        self.area.draw(&Polygon::new(points.to_vec(), rgb(color).mix(opacity).filled())).map_err(fault)
    }

    pub fn rectangle(&self, a: (i32, i32), b: (i32, i32), color: Rgb) -> Result<(), PlotError> {
        self.area.draw(&Rectangle::new([a, b], rgb(color).filled())).map_err(fault)
    }

    pub fn frame(&self, a: (i32, i32), b: (i32, i32), color: Rgb) -> Result<(), PlotError> {
        self.area.draw(&Rectangle::new([a, b], ShapeStyle::from(rgb(color)).stroke_width(1))).map_err(fault)
    }

    pub fn marker(&self, (x, y): (i32, i32), marker: Marker, color: Rgb) -> Result<(), PlotError> {
        const R: i32 = 4;
        match marker {
            Marker::Circle => self.area.draw(&Circle::new((x, y), R, rgb(color).filled())).map_err(fault),
            Marker::Square => self.rectangle((x - R + 1, y - R + 1), (x + R - 1, y + R - 1), color),
            Marker::Triangle => {
                self.filled(&[(x, y - R - 1), (x + R + 1, y + R - 1), (x - R - 1, y + R - 1)], color, 1.0)
            }
            Marker::Diamond => {
                self.filled(&[(x, y - R - 1), (x + R + 1, y), (x, y + R + 1), (x - R - 1, y)], color, 1.0)
            }
            Marker::Cross => {
                self.path(&[(x - R, y - R), (x + R, y + R)], color, 2, Stroke::Solid)?;
                self.path(&[(x - R, y + R), (x + R, y - R)], color, 2, Stroke::Solid)
            }
        }
    }
}

impl Canvas<'_> {
    /// A hollow arrow head: what lies beyond the drawing, upwards for 1 and downwards for -1.
    pub fn arrow(&self, (x, y): (i32, i32), up: i32, color: Rgb) -> Result<(), PlotError> {
        const R: i32 = 6;
        let corners = [(x, y - up * R), (x + R, y + up * (R - 1)), (x - R, y + up * (R - 1))];
        self.filled(&corners, [255, 255, 255], 1.0)?;
        let [tip, right, left] = corners;
        self.path(&[tip, right, left, tip, right], color, 2, Stroke::Solid)
    }
}

/// The SVG backend divides font sizes by this.
const FONT_UNIT: f64 = 1.24;

fn rgb([r, g, b]: Rgb) -> RGBColor {
    RGBColor(r, g, b)
}

fn with_font_style(mut style: plotters::style::TextStyle, font: FontStyle) -> plotters::style::TextStyle {
    style.font = style.font.style(font);
    style
}
