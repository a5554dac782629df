//! Contact sheets.

use splitsum::base::pixels::Rgb8Image;
use splitsum::draw::colormap::RELATIVE_ERROR;
use splitsum::draw::figure::sheet::{ContactSheet, Head, Tile, TileRow};

const TILE: [u32; 2] = [90, 60];

/// A sheet of 3 columns whose rows start groups at multiples of `group`; the last tile is missing.
fn sheet(rows: usize, group: usize) -> ContactSheet {
    let head = |label: &str, starts_group: bool| Head {
        label: label.to_owned(),
        starts_group,
    };
    let tile = || Tile::Image {
        image: Rgb8Image::filled(TILE[0], TILE[1], [200; 3]),
        note: "0.0123".to_owned(),
    };
    let mut rows: Vec<_> = (0..rows)
        .map(|i| TileRow {
            head: head("alpha\n0.1", i.is_multiple_of(group)),
            tiles: vec![tile(), tile(), tile()],
        })
        .collect();
    rows.last_mut().unwrap().tiles[2] = Tile::Missing("device lost".to_owned());
    let columns = [
        ("reference", false),
        ("a name that is far too long for its column", true),
        ("split-sum", false),
    ];
    ContactSheet {
        title: "A title".to_owned(),
        caption: "A caption that is long enough to be broken over two lines at the width of this \
                  small sheet."
            .to_owned(),
        tile: TILE,
        columns: columns.map(|(label, starts)| head(label, starts)).to_vec(),
        rows,
        legends: vec![("relative error", RELATIVE_ERROR)],
    }
}

fn all(svg: &str, element: &str, attribute: &str) -> Vec<f64> {
    let number = |element: &str| {
        let start = element.find(&format!(" {attribute}=\""))? + attribute.len() + 3;
        element[start..].split('"').next()?.parse().ok()
    };
    svg.split(&format!("<{element}"))
        .skip(1)
        .filter_map(|rest| number(rest.split('>').next()?))
        .collect()
}

#[test]
fn tiles_form_a_grid_and_no_text_covers_them() {
    let svg = sheet(2, 2).svg();
    let (xs, ys) = (all(&svg, "image", "x"), all(&svg, "image", "y"));
    assert_eq!(
        (xs.len(), &xs[..2], ys[0], ys[3]),
        (5, &xs[3..], ys[1], ys[4])
    );
    let [group_gap, gap] = [xs[1] - xs[0], xs[2] - xs[1]].map(|step| step - f64::from(TILE[0]));
    assert!(
        group_gap > gap && gap > 0.0 && ys[3] > ys[0] + f64::from(TILE[1]),
        "{xs:?} {ys:?}"
    );
    assert!(svg.contains(">device lost</text>") && svg.contains(">0.0123</text>"));
    // Texts are in the margins, above the tiles, or at least a letter's height below the top of
    // one.
    for y in all(&svg, "text", "y") {
        let inside = |top: &&f64| y > **top && y < **top + f64::from(TILE[1]);
        let is_label = |top: &f64| (y - top - f64::from(TILE[1]) / 2.0).abs() < 16.0;
        assert!(ys.iter().find(inside).is_none_or(is_label), "{y}");
    }
    let [width, height] = ["width", "height"].map(|name| all(&svg, "svg", name)[0]);
    assert!(xs[2] + f64::from(TILE[0]) < width && ys[4] + f64::from(TILE[1]) < height);
}

#[test]
fn a_tall_sheet_leaves_out_groups_of_rows() {
    let svg = sheet(60, 3).svg();
    let shown = all(&svg, "image", "x").len() / 3;
    assert!(
        shown > 3 && shown < 60 && shown.is_multiple_of(3),
        "{shown}"
    );
    assert!(
        svg.contains(&format!("first {shown} of 60")),
        "the caption counts them"
    );
}
