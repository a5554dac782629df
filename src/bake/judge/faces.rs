//! Finds faces of a cube that are black, swapped, turned or flipped.

use super::directions::Directions;
use super::{EXPLAINED, Truth, relative_square};
use crate::bake::container::FACE_COUNT;
use crate::bake::convention::Axes;
use crate::base::pixels::RgbImage;
use glam::DVec3;

/// A turn or mirror image of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceTurn {
    None,
    Clockwise,
    Half,
    CounterClockwise,
    FlippedLeftRight,
    FlippedTopBottom,
    Transposed,
    /// Across the other diagonal.
    AntiTransposed,
}

impl FaceTurn {
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Clockwise,
        Self::Half,
        Self::CounterClockwise,
        Self::FlippedLeftRight,
        Self::FlippedTopBottom,
        Self::Transposed,
        Self::AntiTransposed,
    ];

    /// Returns a square face as it was before the turn.
    pub fn undone(self, face: &RgbImage) -> RgbImage {
        let mut right = face.clone();
        let last = face.width as usize - 1;
        for y in 0..=last {
            for x in 0..=last {
                let [column, row] = self.source(x, y, last);
                right.data[row * (last + 1) + column] = face.data[y * (last + 1) + x];
            }
        }
        right
    }

    /// Returns column and row in the right face of the texel at (x, y) of the turned one.
    fn source(self, x: usize, y: usize, last: usize) -> [usize; 2] {
        let u = last - x;
        let v = last - y;
        match self {
            Self::None => [x, y],
            Self::Clockwise => [y, u],
            Self::Half => [u, v],
            Self::CounterClockwise => [v, x],
            Self::FlippedLeftRight => [u, y],
            Self::FlippedTopBottom => [x, v],
            Self::Transposed => [y, x],
            Self::AntiTransposed => [v, u],
        }
    }
}

/// What a face of the file holds: a face, turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldFace {
    pub face: usize,
    pub turn: FaceTurn,
}

impl HeldFace {
    fn unchanged(face: usize) -> Self {
        Self {
            face,
            turn: FaceTurn::None,
        }
    }
}

/// A face of the file that holds the wrong texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedFace {
    pub face: usize,
    pub held: HeldFace,
}

/// A slip in the faces of a cube; faces are indices of +x, -x, +y, -y, +z, -z.
#[derive(Clone, Debug, PartialEq)]
pub enum FaceSlip {
    /// Other axes move and turn the faces in the same way.
    Axes(Axes),
    Every(FaceTurn),
    Swapped([usize; 2]),
    /// Unturned faces in this order.
    Reordered([usize; FACE_COUNT]),
    Moved(Vec<MovedFace>),
}

/// The black faces of a level.
pub struct BlackFaces {
    /// Faces that are black where the right ones are not; empty if all are.
    pub faces: Vec<usize>,
    /// Texels of the other faces.
    pub other_texels: Vec<usize>,
}

impl BlackFaces {
    pub fn new(directions: &Directions, found: &[DVec3], exact: &[DVec3]) -> Self {
        let face_count = directions.layout.face_count as usize;
        let texel_count = found.len() / face_count;
        let is_black = |values: &[DVec3], face: usize| {
            values[face * texel_count..][..texel_count]
                .iter()
                .all(|texel| *texel == DVec3::ZERO)
        };
        let (black, others): (Vec<usize>, Vec<usize>) =
            (0..face_count).partition(|face| is_black(found, *face) && !is_black(exact, *face));
        if others.is_empty() {
            return Self {
                faces: Vec::new(),
                other_texels: (0..found.len()).collect(),
            };
        }
        Self {
            faces: black,
            other_texels: others
                .into_iter()
                .flat_map(|face| face * texel_count..(face + 1) * texel_count)
                .collect(),
        }
    }
}

/// Names the slip in the faces of a grid of texels, with the relMSE that it leaves; `None` if all
/// faces are right, or wrong in another way.
pub fn slip(
    truth: &Truth,
    directions: &Directions,
    found: &[DVec3],
    exact: &[DVec3],
) -> Option<(FaceSlip, f64)> {
    let [width, height] = directions.size;
    let texel_count = found.len() / FACE_COUNT;
    let side = texel_count.isqrt();
    // Without the black faces of a cube there are fewer.
    if directions.layout.face_count as usize != FACE_COUNT
        || width != height
        || FACE_COUNT * side * side != found.len()
    {
        return None;
    }
    let cube = Cube {
        truth,
        directions,
        found,
        exact,
        side,
    };
    let mut left = 0.0;
    let mut held = [HeldFace::unchanged(0); FACE_COUNT];
    for (face, held) in held.iter_mut().enumerate() {
        let (nearest, error) = cube.nearest(face);
        left += error;
        *held = nearest;
    }
    let other_axes = Axes::all()
        .find(|axes| cube.are_moved_by(*axes, held))
        .filter(|axes| *axes != directions.axes);
    let slip = match other_axes {
        Some(axes) => FaceSlip::Axes(axes),
        None => named(held)?,
    };
    Some((slip, left / directions.weights.iter().sum::<f64>()))
}

/// The compared texels of a cube, of `side` x `side` texels a face.
struct Cube<'a> {
    truth: &'a Truth<'a>,
    directions: &'a Directions,
    found: &'a [DVec3],
    exact: &'a [DVec3],
    side: usize,
}

impl Cube<'_> {
    fn texel_count(&self) -> usize {
        self.side * self.side
    }

    /// Returns the texel of the level that a texel of a face should hold.
    fn source(&self, held: HeldFace, texel: usize) -> usize {
        let [x, y] = held
            .turn
            .source(texel % self.side, texel / self.side, self.side - 1);
        held.face * self.texel_count() + y * self.side + x
    }

    /// Sums the weighted errors of a face as if it held another.
    fn error(&self, face: usize, held: HeldFace) -> f64 {
        let epsilon = self.truth.epsilon();
        let square = |texel: usize| {
            let index = face * self.texel_count() + texel;
            let exact = self.exact[self.source(held, texel)];
            self.directions.weights[index] * relative_square(self.found[index], exact, epsilon)
        };
        (0..self.texel_count()).map(square).sum()
    }

    /// Finds the face, turned, that a face of the file is nearest to, and its error.
    fn nearest(&self, face: usize) -> (HeldFace, f64) {
        let unchanged = HeldFace::unchanged(face);
        let unchanged_error = self.error(face, unchanged);
        let (best, error) = (0..FACE_COUNT)
            .flat_map(|face| FaceTurn::ALL.map(|turn| HeldFace { face, turn }))
            .map(|held| (held, self.error(face, held)))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .expect("a cube has faces");
        // A face that resembles another is right where it is.
        if error > EXPLAINED * unchanged_error {
            (unchanged, unchanged_error)
        } else {
            (best, error)
        }
    }

    /// Whether other axes move every face as it is held.
    fn are_moved_by(&self, axes: Axes, held: [HeldFace; FACE_COUNT]) -> bool {
        (0..FACE_COUNT).all(|face| {
            let is_moved = |texel: usize| {
                let world = self.directions.world[face * self.texel_count() + texel];
                let file = self.directions.axes.to_file(world);
                let source = self.directions.world[self.source(held[face], texel)];
                axes.to_world(file).distance(source) < 1e-6
            };
            // A face of one texel has no turn.
            is_moved(0) && is_moved(1.min(self.texel_count() - 1))
        })
    }
}

/// Names the simplest slip that leads to these faces; `None` if all are right.
fn named(held: [HeldFace; FACE_COUNT]) -> Option<FaceSlip> {
    let every = |turn: FaceTurn| (0..FACE_COUNT).all(|face| held[face] == HeldFace { face, turn });
    if let Some(turn) = FaceTurn::ALL[1..].iter().find(|turn| every(**turn)) {
        return Some(FaceSlip::Every(*turn));
    }
    let moved: Vec<MovedFace> = held
        .into_iter()
        .enumerate()
        .map(|(face, held)| MovedFace { face, held })
        .filter(|moved| moved.held != HeldFace::unchanged(moved.face))
        .collect();
    if let [a, b] = moved[..]
        && a.held == HeldFace::unchanged(b.face)
        && b.held == HeldFace::unchanged(a.face)
    {
        return Some(FaceSlip::Swapped([a.face, b.face]));
    }
    if moved.len() > 2 && (0..FACE_COUNT).all(|face| held.contains(&HeldFace::unchanged(face))) {
        return Some(FaceSlip::Reordered(held.map(|held| held.face)));
    }
    (!moved.is_empty()).then_some(FaceSlip::Moved(moved))
}
