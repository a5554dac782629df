//! The compared texels of a DFG table.

use crate::base::pixels::RgbImage;
use glam::{DVec2, DVec3};

/// Number of texels that stand out.
const ODD_COUNT: usize = 16;

/// A texel of a table.
pub struct TableTexel {
    /// Texture coordinates of its centre.
    pub uv: DVec2,
    /// The first two channels.
    pub value: DVec2,
}

impl TableTexel {
    fn new(table: &RgbImage, [x, y]: [u32; 2]) -> Self {
        let size = DVec2::new(table.width.into(), table.height.into());
        Self {
            uv: (DVec2::new(x.into(), y.into()) + 0.5) / size,
            value: DVec3::from_array(table.get(x, y).map(f64::from)).truncate(),
        }
    }
}

/// Picks the texels that differ most from the mean of their neighbours: a row or a texel that is
/// wrong by itself.
pub fn odd_texels(table: &RgbImage) -> Vec<TableTexel> {
    let value = |x: u32, y: u32| TableTexel::new(table, [x, y]).value;
    let neighbours = |i: u32, last: u32| [i.saturating_sub(1), (i + 1).min(last)];
    let difference = |index: u32| {
        let x = index % table.width;
        let y = index / table.width;
        let in_row: DVec2 = neighbours(x, table.width - 1)
            .map(|x| value(x, y))
            .iter()
            .sum();
        let in_column: DVec2 = neighbours(y, table.height - 1)
            .map(|y| value(x, y))
            .iter()
            .sum();
        (value(x, y) - (in_row + in_column) / 4.0)
            .abs()
            .max_element()
    };
    let mut ranked: Vec<(f64, u32)> = (0..table.width * table.height)
        .map(|index| (difference(index), index))
        .collect();
    ranked.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    ranked
        .iter()
        .take(ODD_COUNT)
        .map(|(_, index)| TableTexel::new(table, [index % table.width, index / table.width]))
        .collect()
}

/// Picks about `lines` x `lines` texels, evenly, edges included.
pub fn spread_texels(table: &RgbImage, lines: u32) -> Vec<TableTexel> {
    let columns = spread(table.width, lines);
    spread(table.height, lines)
        .iter()
        .flat_map(|y| columns.iter().map(|x| TableTexel::new(table, [*x, *y])))
        .collect()
}

fn spread(side: u32, lines: u32) -> Vec<u32> {
    match side.min(lines) {
        1 => vec![0],
        count => (0..count).map(|k| k * (side - 1) / (count - 1)).collect(),
    }
}
