//! Finds faces of a cube that are black, swapped, turned or flipped.

use super::directions::Directions;
use super::{Cause, EXPLAINED, Truth, relative_square};
use crate::bake::container::FACE_COUNT;
use crate::bake::convention::Axes;
use glam::DVec3;

/// Faces in the order of a cube map.
const NAMES: [&str; FACE_COUNT] = ["+x", "-x", "+y", "-y", "+z", "-z"];

const TURNS: [&str; 8] = [
    "",
    "turned by 90° clockwise",
    "turned by 180°",
    "turned by 90° counter-clockwise",
    "flipped left to right",
    "flipped top to bottom",
    "transposed",
    "transposed across the other diagonal",
];

/// Returns the place in the right face of the texel at (x, y) of a turned one.
fn turned(turn: usize, x: usize, y: usize, last: usize) -> (usize, usize) {
    let (u, v) = (last - x, last - y);
    [
        (x, y),
        (y, u),
        (u, v),
        (v, x),
        (u, y),
        (x, v),
        (y, x),
        (v, u),
    ][turn]
}

/// Names the faces that are black where the right ones are not, unless all are, and lists the
/// texels of the others.
pub fn black(
    directions: &Directions,
    found: &[DVec3],
    exact: &[DVec3],
) -> (Option<Cause>, Vec<usize>) {
    let texels = found.len() / directions.layout.face_count as usize;
    let is_black = |values: &[DVec3], face: usize| {
        values[face * texels..][..texels]
            .iter()
            .all(|x| *x == DVec3::ZERO)
    };
    let faces = 0..directions.layout.face_count as usize;
    let (lost, seen): (Vec<usize>, Vec<usize>) =
        faces.partition(|face| is_black(found, *face) && !is_black(exact, *face));
    if lost.is_empty() || seen.is_empty() {
        return (None, (0..found.len()).collect());
    }
    let words: Vec<String> = lost
        .iter()
        .map(|face| format!("face {} is black", NAMES[*face]))
        .collect();
    let seen = seen
        .into_iter()
        .flat_map(|face| face * texels..(face + 1) * texels)
        .collect();
    (
        Some(Cause {
            kind: "black",
            words: words.join("; "),
        }),
        seen,
    )
}

/// Names the slip in the faces of a grid of texels, with the relMSE that it leaves; `None` if all
/// faces are right, or wrong in another way.
pub fn slip(
    truth: &Truth,
    directions: &Directions,
    found: &[DVec3],
    exact: &[DVec3],
) -> Option<(Cause, f64)> {
    let [width, height] = directions.size;
    let texels = found.len() / FACE_COUNT;
    let side = texels.isqrt();
    // Without the black faces of a cube there are fewer.
    if directions.layout.face_count as usize != FACE_COUNT
        || width != height
        || FACE_COUNT * side * side != found.len()
    {
        return None;
    }
    let place = |turn: usize, index: usize| {
        let (x, y) = turned(turn, index % side, index / side, side - 1);
        y * side + x
    };
    let off = |face: usize, of: usize, turn: usize| -> f64 {
        let square = |index: usize| {
            let at = face * texels + index;
            directions.weights[at]
                * relative_square(
                    found[at],
                    exact[of * texels + place(turn, index)],
                    truth.epsilon(),
                )
        };
        (0..texels).map(square).sum()
    };
    let (mut left, mut held) = (0.0, [(0, 0); FACE_COUNT]);
    for (face, held) in held.iter_mut().enumerate() {
        let as_it_is = off(face, face, 0);
        let all = (0..FACE_COUNT).flat_map(|of| (0..TURNS.len()).map(move |turn| (of, turn)));
        let best = all
            .map(|(of, turn)| (of, turn, off(face, of, turn)))
            .min_by(|a, b| a.2.total_cmp(&b.2))?;
        // A face that resembles another is right where it is.
        let best = if best.2 > EXPLAINED * as_it_is {
            (face, 0, as_it_is)
        } else {
            best
        };
        left += best.2;
        *held = (best.0, best.1);
    }
    // Other axes move every face.
    let lands = |axes: Axes, face: usize, (of, turn): (usize, usize)| {
        let is_at = |index: usize| {
            let from = directions
                .axes
                .to_file(directions.world[face * texels + index]);
            axes.to_world(from)
                .distance(directions.world[of * texels + place(turn, index)])
                < 1e-6
        };
        // A face of one texel has no turn.
        is_at(0) && is_at(1.min(texels - 1))
    };
    let holds = |axes: &Axes| (0..FACE_COUNT).all(|face| lands(*axes, face, held[face]));
    let cause = match Axes::all()
        .find(holds)
        .filter(|axes| *axes != directions.axes)
    {
        Some(axes) => Cause {
            kind: "axes",
            words: format!("other axes: --axes={axes}"),
        },
        None => Cause {
            kind: "faces",
            words: words(held)?,
        },
    };
    Some((cause, left / directions.weights.iter().sum::<f64>()))
}

fn words(held: [(usize, usize); FACE_COUNT]) -> Option<String> {
    let moved = |face: usize| held[face] != (face, 0);
    let odd: Vec<usize> = (0..FACE_COUNT).filter(|face| moved(*face)).collect();
    if let Some(turn) =
        (1..TURNS.len()).find(|turn| (0..FACE_COUNT).all(|face| held[face] == (face, *turn)))
    {
        return Some(format!("every face is {}", TURNS[turn]));
    }
    if let [a, b] = odd[..]
        && [held[a], held[b]] == [(b, 0), (a, 0)]
    {
        return Some(format!("faces {} and {} are swapped", NAMES[a], NAMES[b]));
    }
    if odd.len() > 2 && (0..FACE_COUNT).all(|face| held.contains(&(face, 0))) {
        let order = held.map(|(of, _)| NAMES[of]).join(" ");
        return Some(format!(
            "faces in the order {order}; expected {}",
            NAMES.join(" ")
        ));
    }
    let one = |face: &usize| match held[*face] {
        (of, turn) if of == *face => format!("face {} is {}", NAMES[*face], TURNS[turn]),
        (of, 0) => format!("face {} holds {}", NAMES[*face], NAMES[of]),
        (of, turn) => format!("face {} holds {}, {}", NAMES[*face], NAMES[of], TURNS[turn]),
    };
    (!odd.is_empty()).then(|| odd.iter().map(one).collect::<Vec<_>>().join("; "))
}
