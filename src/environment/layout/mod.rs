//! How a map of the sphere lies in texels: the layouts of the maps that are looked up filtered.
//!
//! These are the levels of the environment that `sampled` reads, the prefiltered map and the irradiance map. The environment itself is
//! always equirectangular. The twins of `shaders/map_layout/` stand here in f64.

mod cube;
mod equirect;
mod octahedral;

use crate::pixels::Pixels;
use crate::spelling::listed;
use glam::{DVec2, DVec3};

/// A layout. The names are the shader file stems.
#[derive(Debug)]
pub struct MapLayout {
    pub name: &'static str,
    /// One sentence for `splitsum list layouts`.
    pub about: &'static str,
    /// Where the texels lie, for readers of files.
    pub mapping: &'static str,
    /// Images that one level consists of.
    pub face_count: u32,
    /// Whether faces are square.
    pub is_square: bool,
    /// Texels of the shortest side that holds a lobe of alpha 1: some hundred in all.
    pub side_min: u32,
    /// Size of a prefiltered map's first level where none is set; all layouts have about as many texels.
    pub prefilter_size: [u32; 2],
    /// Size of an irradiance map where none is set; likewise.
    pub irradiance_size: [u32; 2],
    /// Size of the finest filtered level for an environment of this size: about as many texels as the environment has where it is widest.
    pub finest_size: fn([u32; 2]) -> [u32; 2],
    /// Face and texture coordinates of a direction.
    pub place: fn(DVec3) -> (u32, DVec2),
    /// Unit direction of a face and texture coordinates; the inverse of `place`.
    pub direction: fn(u32, DVec2) -> DVec3,
    /// Solid angle (sr) of a texel at a unit direction, for a face of that size: its mean over a sample of so many sr.
    pub texel_solid_angle: fn(DVec3, [u32; 2], f64) -> f64,
    /// Face, column and row of the texel at whole coordinates at most one texel outside the face; nothing where three faces meet.
    texel: TexelAt,
}

/// Face, column and row of the texel at whole coordinates of a face of that size.
type TexelAt = fn(u32, [i64; 2], [u32; 2]) -> Option<[u32; 3]>;

/// Every layout; the first is the default.
pub static LAYOUTS: &[MapLayout] = &[cube::LAYOUT, octahedral::LAYOUT, equirect::LAYOUT];

listed!(MapLayout, "layout", LAYOUTS);

impl MapLayout {
    /// The texels (face, column, row) of faces of that size that linear filtering reads in a direction, across all edges, and their weights.
    pub fn stencil(&self, d: DVec3, size: [u32; 2]) -> [([u32; 3], f64); 4] {
        let (face, uv) = (self.place)(d);
        let at = uv * DVec2::new(size[0].into(), size[1].into()) - 0.5;
        let (low, part) = (at.floor(), at - at.floor());
        let corner = |dx: i64, dy: i64| (self.texel)(face, [low.x as i64 + dx, low.y as i64 + dy], size);
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        let weights = [[1.0 - part.x, part.x].map(|x| x * (1.0 - part.y)), [1.0 - part.x, part.x].map(|x| x * part.y)];
        let weights = [weights[0][0], weights[0][1], weights[1][0], weights[1][1]];
        // Where three faces meet there is no fourth texel: the mean of the three stands for it.
        match corners.iter().position(Option::is_none) {
            None => std::array::from_fn(|i| (corners[i].unwrap_or_default(), weights[i])),
            Some(lost) => {
                let more = weights[lost] / 3.0;
                let there = corners[(lost + 1) % 4].unwrap_or_default();
                std::array::from_fn(|i| corners[i].map_or((there, 0.0), |texel| (texel, weights[i] + more)))
            }
        }
    }

    /// Whether it is the environment's own, so that its levels are the environment's mips.
    pub fn is_environments(&self) -> bool {
        *self == equirect::LAYOUT
    }
}

impl PartialEq for MapLayout {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Level at which a texel covers the solid angle `omega_s` of a sample, `omega_p` being that of a texel of level 0; not clamped
/// [Colbert07, section 20.4].
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
    /// Width and height of a face of the finest level.
    pub fn size(&self) -> [u32; 2] {
        let face = &self.levels[0][0];
        [face.width, face.height]
    }

    /// The value in a direction at a real level, clamped to the chain: linear between texels and between levels, across all edges.
    pub fn value(&self, d: DVec3, lod: f64) -> DVec3 {
        let lod = lod.clamp(0.0, self.levels.len() as f64 - 1.0);
        let fine = lod.floor() as usize;
        let coarse = (fine + 1).min(self.levels.len() - 1);
        self.level_value(d, fine).lerp(self.level_value(d, coarse), lod.fract())
    }

    /// Solid angle (sr) of a texel of the finest level there, its mean over a sample of `omega_s`.
    pub fn texel_solid_angle(&self, d: DVec3, omega_s: f64) -> f64 {
        (self.layout.texel_solid_angle)(d, self.size(), omega_s)
    }

    fn level_value(&self, d: DVec3, level: usize) -> DVec3 {
        let faces = &self.levels[level];
        let stencil = self.layout.stencil(d, [faces[0].width, faces[0].height]);
        stencil.into_iter().map(|([face, x, y], weight)| weight * faces[face as usize].get(x, y)).sum()
    }
}
