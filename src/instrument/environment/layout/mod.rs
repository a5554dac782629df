//! Texel layouts of the filtered maps: the environment's levels for `sampled`, the prefiltered map
//! and the irradiance map. The environment itself is always equirectangular. These are the f64
//! twins of `shaders/map_layout/`.

mod cube;
mod equirect;
mod octahedral;

use crate::base::names::listed;
use crate::base::pixels::Pixels;
use glam::{DVec2, DVec3};
use std::ops::Range;

/// A layout. Names are the stems of shader files.
#[derive(Debug)]
pub struct MapLayout {
    pub name: &'static str,
    pub about: &'static str,
    /// Positions of the texels, for readers of files.
    pub mapping: &'static str,
    /// Images per level.
    pub face_count: u32,
    pub is_square: bool,
    /// Shortest side, in texels, that can hold a lobe of alpha 1: some hundred texels in all.
    pub side_min: u32,
    /// Default size of a prefiltered map's first level; similar texel counts in all layouts.
    pub prefilter_size: [u32; 2],
    pub irradiance_size: [u32; 2],
    /// Size of the finest filtered level for an environment's size: about as many texels as its
    /// widest row has.
    pub finest_size: fn([u32; 2]) -> [u32; 2],
    /// Face and texture coordinates of a direction.
    pub face_uv: fn(DVec3) -> (u32, DVec2),
    /// Unit direction of a face and texture coordinates; inverse of `face_uv`.
    pub direction: fn(u32, DVec2) -> DVec3,
    /// Mean solid angle (sr) of a texel at a unit direction, for a face size, over a sample of so
    /// many sr.
    pub texel_solid_angle: fn(DVec3, [u32; 2], f64) -> f64,
    /// Face, column and row of the texel at coordinates at most one texel outside a face; `None` at
    /// corners of three.
    texel: TexelAt,
}

/// Arguments: face, coordinates, size of a face.
type TexelAt = fn(u32, [i64; 2], [u32; 2]) -> Option<[u32; 3]>;

/// Every layout; the first is the default.
pub static LAYOUTS: &[MapLayout] = &[cube::LAYOUT, octahedral::LAYOUT, equirect::LAYOUT];

listed!(MapLayout, "layout", LAYOUTS);

impl MapLayout {
    /// Returns the texels (face, column, row) and weights of a linear lookup across all edges, for
    /// a face size.
    pub fn stencil(&self, d: DVec3, size: [u32; 2]) -> [([u32; 3], f64); 4] {
        let (face, uv) = (self.face_uv)(d);
        self.stencil_at(face, uv, size)
    }

    fn stencil_at(&self, face: u32, uv: DVec2, size: [u32; 2]) -> [([u32; 3], f64); 4] {
        let position = uv * DVec2::new(size[0].into(), size[1].into()) - 0.5;
        let low = position.floor();
        let part = position - position.floor();
        let corner =
            |dx: i64, dy: i64| (self.texel)(face, [low.x as i64 + dx, low.y as i64 + dy], size);
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        let weights = [
            [1.0 - part.x, part.x].map(|x| x * (1.0 - part.y)),
            [1.0 - part.x, part.x].map(|x| x * part.y),
        ];
        let weights = [weights[0][0], weights[0][1], weights[1][0], weights[1][1]];
        // At a corner of three faces there is no fourth texel: the mean of the three replaces it.
        match corners.iter().position(Option::is_none) {
            None => std::array::from_fn(|i| (corners[i].unwrap_or_default(), weights[i])),
            Some(lost) => {
                let more = weights[lost] / 3.0;
                let there = corners[(lost + 1) % 4].unwrap_or_default();
                std::array::from_fn(|i| {
                    corners[i].map_or((there, 0.0), |texel| (texel, weights[i] + more))
                })
            }
        }
    }

    /// The layout of every environment.
    pub fn environments() -> &'static Self {
        &equirect::LAYOUT
    }

    /// Whether this is the environment's own layout, so that its levels are the environment's mips.
    pub fn is_environments(&self) -> bool {
        self == Self::environments()
    }
}

impl PartialEq for MapLayout {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Returns the level whose texels cover a sample; `omega_p` is for level 0. Not clamped [Colbert07,
/// section 20.4].
pub fn lod_from_solid_angles(omega_s: f64, omega_p: f64) -> f64 {
    0.5 * (omega_s / omega_p).log2()
}

/// A map with its levels, finest first, each with its faces.
#[derive(Clone, Debug)]
pub struct FilteredMap {
    pub layout: &'static MapLayout,
    pub levels: Vec<Vec<Pixels<DVec3>>>,
}

impl FilteredMap {
    /// Returns width and height of a face of the finest level.
    pub fn size(&self) -> [u32; 2] {
        let face = &self.levels[0][0];
        [face.width, face.height]
    }

    /// Looks up a direction at a fractional level, clamped to the chain; linear in texels and
    /// levels, across edges.
    pub fn value(&self, d: DVec3, lod: f64) -> DVec3 {
        let lod = lod.clamp(0.0, self.levels.len() as f64 - 1.0);
        let fine = lod.floor() as usize;
        let mut levels = self.level_values(d, fine..fine + 2);
        let value = levels.next().unwrap_or_default();
        if lod.fract() == 0.0 {
            return value;
        }
        value.lerp(levels.next().unwrap_or_default(), lod.fract())
    }

    /// Looks up a direction in each of these levels; linear in texels, across edges. Stops at the
    /// last level of the chain.
    pub fn level_values(&self, d: DVec3, levels: Range<usize>) -> impl Iterator<Item = DVec3> {
        let (face, uv) = (self.layout.face_uv)(d);
        let levels = &self.levels[levels.start..levels.end.min(self.levels.len())];
        levels.iter().map(move |faces| {
            let size = [faces[0].width, faces[0].height];
            let stencil = self.layout.stencil_at(face, uv, size);
            stencil
                .into_iter()
                .map(|([face, x, y], weight)| weight * faces[face as usize].get(x, y))
                .sum()
        })
    }

    /// Returns the solid angle (sr) of a texel of the finest level in a direction, its mean over a
    /// sample of `omega_s`.
    pub fn texel_solid_angle(&self, d: DVec3, omega_s: f64) -> f64 {
        (self.layout.texel_solid_angle)(d, self.size(), omega_s)
    }
}
