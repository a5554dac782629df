//! Lines cut at the border of a panel, so that a figure needs no clip paths and thereby no ids.

/// The pieces of a line of points within left, top, right and bottom (Liang and Barsky).
pub fn clip(points: &[[f64; 2]], area: [f64; 4]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut is_open = false;
    for pair in points.windows(2) {
        let Some([from, to]) = segment(pair[0], pair[1], area) else {
            is_open = false;
            continue;
        };
        match pieces.last_mut().filter(|_| is_open) {
            Some(piece) => piece.push(to),
            None => pieces.push(vec![from, to]),
        }
        is_open = to == pair[1];
    }
    pieces
}

fn segment(a: [f64; 2], b: [f64; 2], [left, top, right, bottom]: [f64; 4]) -> Option<[[f64; 2]; 2]> {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (mut start, mut end) = (0.0, 1.0);
    for (toward, room) in [(-dx, a[0] - left), (dx, right - a[0]), (-dy, a[1] - top), (dy, bottom - a[1])] {
        match toward {
            0.0 if room < 0.0 => return None,
            0.0 => (),
            _ if toward < 0.0 => start = f64::max(start, room / toward),
            _ => end = f64::min(end, room / toward),
        }
    }
    let at = |share: f64| [a[0] + share * dx, a[1] + share * dy];
    let from = if start > 0.0 { at(start) } else { a };
    let to = if end < 1.0 { at(end) } else { b };
    (start <= end).then_some([from, to])
}
