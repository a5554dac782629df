//! Where the pixels of a header belong: windows and orientation.

use super::color_label::integer;
use crate::base::pixels::file::{Fault, filled};
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;

/// Attribute of programs that keep the pixels in stored order (OpenImageIO), with the values of
/// TIFF and Exif.
const ORIENTATION: &str = "Orientation";

/// The image that a header describes, beside the pixels that it stores.
pub(super) struct Frame {
    pub width: usize,
    pub height: usize,
    /// Column and row of the first stored pixel in the image; may be negative.
    left: i64,
    top: i64,
    stored_width: usize,
    stored_height: usize,
    orientation: Orientation,
}

impl Frame {
    /// Returns the display window with the data window in it. An image of one size for both is the
    /// usual case; any other gets a warning.
    pub fn of_header(header: &Header, warnings: &mut Vec<String>) -> Result<Self, Fault> {
        let Vec2(stored_width, stored_height) = header.layer_size;
        let Vec2(x, y) = header.own_attributes.layer_position;
        let display = header.shared_attributes.display_window;
        let Vec2(width, height) = display.size;
        let left = i64::from(x) - i64::from(display.position.0);
        let top = i64::from(y) - i64::from(display.position.1);
        let is_outside = left >= width as i64
            || top >= height as i64
            || left + stored_width as i64 <= 0
            || top + stored_height as i64 <= 0;
        if is_outside {
            return Err(Fault::new(
                format!(
                    "the data window ({stored_width}x{stored_height} at {x}, {y}) lies outside the \
                     display window ({width}x{height} at {}, {})",
                    display.position.0, display.position.1
                ),
                "pixels inside the display window",
            ));
        }
        let frame = Self {
            width,
            height,
            left,
            top,
            stored_width,
            stored_height,
            orientation: Orientation::of_header(header, warnings),
        };
        if !frame.is_whole() {
            warnings.push(format!(
                "The data window ({stored_width}x{stored_height} at {x}, {y}) differs from the \
                 display window ({width}x{height} at {}, {}); pixels outside the display window \
                 were cropped, and those without data are 0.",
                display.position.0, display.position.1
            ));
        }
        Ok(frame)
    }

    fn is_whole(&self) -> bool {
        self.left == 0
            && self.top == 0
            && (self.width, self.height) == (self.stored_width, self.stored_height)
    }

    /// Moves stored values to their pixels; others keep `empty`.
    pub fn to_display_window<T: Copy>(&self, stored: Vec<T>, empty: T) -> Result<Vec<T>, Fault> {
        let placed = if self.is_whole() {
            stored
        } else {
            self.in_display_window(&stored, empty)?
        };
        Ok(self.orientation.apply(placed, self.width, self.height))
    }

    /// Width and height as displayed, which an orientation may swap.
    pub fn display_size(&self) -> [usize; 2] {
        if self.orientation.is_transposed {
            [self.height, self.width]
        } else {
            [self.width, self.height]
        }
    }

    fn in_display_window<T: Copy>(&self, stored: &[T], empty: T) -> Result<Vec<T>, Fault> {
        let mut placed = filled(self.width * self.height, empty)?;
        let first_column = self.left.max(0);
        let end_column = (self.left + self.stored_width as i64).min(self.width as i64);
        let first_row = self.top.max(0);
        let end_row = (self.top + self.stored_height as i64).min(self.height as i64);
        let length = (end_column - first_column) as usize;
        for row in first_row..end_row {
            let from =
                (row - self.top) as usize * self.stored_width + (first_column - self.left) as usize;
            let to = row as usize * self.width + first_column as usize;
            placed[to..to + length].copy_from_slice(&stored[from..from + length]);
        }
        Ok(placed)
    }
}

/// How stored pixels are turned to be seen upright.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Orientation {
    /// The stored rows are the columns of the image. Applied first.
    is_transposed: bool,
    is_mirrored: bool,
    is_upside_down: bool,
}

impl Orientation {
    fn of_header(header: &Header, warnings: &mut Vec<String>) -> Self {
        let Some(value) = integer(header, ORIENTATION) else {
            return Self::default();
        };
        let Some(orientation) = Self::from_exif(value) else {
            warnings.push(format!(
                "The header's {ORIENTATION} {value} is not from 1 to 8; it is ignored."
            ));
            return Self::default();
        };
        if orientation != Self::default() {
            warnings.push(format!(
                "The image was turned as the header's {ORIENTATION} {value} asks; programs that \
                 ignore it show it otherwise."
            ));
        }
        orientation
    }

    /// The eight values of Exif: which corner of the image the first stored pixel is.
    fn from_exif(value: i32) -> Option<Self> {
        let [is_transposed, is_mirrored, is_upside_down] = match value {
            1 => [false, false, false],
            2 => [false, true, false],
            3 => [false, true, true],
            4 => [false, false, true],
            5 => [true, false, false],
            6 => [true, true, false],
            7 => [true, true, true],
            8 => [true, false, true],
            _ => return None,
        };
        Some(Self {
            is_transposed,
            is_mirrored,
            is_upside_down,
        })
    }

    fn apply<T: Copy>(self, stored: Vec<T>, width: usize, height: usize) -> Vec<T> {
        if self == Self::default() {
            return stored;
        }
        let [seen_width, seen_height] = if self.is_transposed {
            [height, width]
        } else {
            [width, height]
        };
        let mut seen = Vec::with_capacity(stored.len());
        for row in 0..seen_height {
            for column in 0..seen_width {
                let x = if self.is_mirrored {
                    seen_width - 1 - column
                } else {
                    column
                };
                let y = if self.is_upside_down {
                    seen_height - 1 - row
                } else {
                    row
                };
                let index = if self.is_transposed {
                    x * width + y
                } else {
                    y * width + x
                };
                seen.push(stored[index]);
            }
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the pixel of the first stored row and column is seen, by Exif: 1 top left, 2 top
    /// right, 3 bottom right, 4 bottom left, then the same with rows as columns.
    #[test]
    fn the_first_stored_pixel_is_seen_at_its_corner() {
        let stored = vec!['a', 'b', 'c', 'd', 'e', 'f'];
        for (value, seen) in [
            (1, "abcdef"),
            (2, "cbafed"),
            (3, "fedcba"),
            (4, "defabc"),
            (5, "adbecf"),
            (6, "daebfc"),
            (7, "fcebda"),
            (8, "cfbead"),
        ] {
            let orientation = Orientation::from_exif(value).expect("from 1 to 8");
            let found: String = orientation
                .apply(stored.clone(), 3, 2)
                .into_iter()
                .collect();
            assert_eq!(found, seen, "{value}");
        }
        assert_eq!(Orientation::from_exif(0), None);
        assert_eq!(Orientation::from_exif(9), None);
    }

    #[test]
    fn stored_pixels_are_placed_in_the_display_window() {
        let frame = |left, top| Frame {
            width: 4,
            height: 3,
            left,
            top,
            stored_width: 2,
            stored_height: 2,
            orientation: Orientation::default(),
        };
        let place = |left, top| {
            frame(left, top)
                .to_display_window(vec![1, 2, 3, 4], 0)
                .expect("small")
        };
        assert_eq!(place(1, 1), [0, 0, 0, 0, 0, 1, 2, 0, 0, 3, 4, 0]);
        // Overscan is cropped.
        assert_eq!(place(-1, -1), [4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(place(3, 2), [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
    }
}
