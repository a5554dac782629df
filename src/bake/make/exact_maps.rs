//! The exact maps of a bake, and how exact they are when read back.

use super::making::Making;
use crate::bake::container::FACE_COUNT;
use crate::bake::convention::Convention;
use crate::bake::judge::{Directions, GOOD, Truth, errors, exact, texels};
use crate::bake::parts::{Bake, Map};
use crate::bake::sh;
use crate::base::pixels::{Pixels, RgbImage};
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::exact_quadrature;
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::precompute::sh9::reference::{Sh9, project_bilinear};
use glam::DVec3;

/// A level as read back.
#[derive(Clone, Debug)]
pub struct Written {
    pub name: String,
    pub side: u32,
    pub alpha: f64,
    /// relMSE against its integral.
    pub relmse: f64,
    /// Why relMSE is above [`GOOD`].
    pub why: Option<String>,
}

/// The exact texels of a level.
pub struct ExactLevel {
    directions: Directions,
    values: Vec<DVec3>,
    alpha: f64,
}

impl ExactLevel {
    /// Rounds the texels to pixels, face by face.
    fn faces(&self) -> Vec<RgbImage> {
        let texel_count = self.values.len() / FACE_COUNT;
        let side = texel_count.isqrt() as u32;
        // Rounding may take a series below 0.
        let texel = |value: &DVec3| value.max(DVec3::ZERO).as_vec3().to_array();
        let face = |values: &[DVec3]| Pixels::new(side, side, values.iter().map(texel).collect());
        self.values.chunks_exact(texel_count).map(face).collect()
    }
}

/// A map, and the file or folder that it is written to.
pub struct ExactMap {
    pub name: &'static str,
    pub faces: Vec<Vec<RgbImage>>,
    levels: Vec<ExactLevel>,
}

impl ExactMap {
    fn new(name: &'static str, levels: Vec<ExactLevel>) -> Self {
        Self {
            name,
            faces: levels.iter().map(ExactLevel::faces).collect(),
            levels,
        }
    }
}

/// The maps of a bake, and its SH.
pub struct ExactMaps<'a> {
    pub truth: Truth<'a>,
    pub kernel: Kernel,
    /// Width of each prefiltered level.
    pub alphas: Vec<f64>,
    pub specular: ExactMap,
    pub irradiance: Option<ExactMap>,
    /// Coefficients in the file's axes.
    pub radiance: Sh9,
}

impl<'a> ExactMaps<'a> {
    pub fn new(making: &Making<'a>, convention: &Convention) -> Self {
        let product = making.preset.product();
        let alphas = convention
            .alphas(making.level_count as usize)
            .expect("an engine has as many widths as levels");
        let kernel = Kernel::new(making.brdf, making.weight, making.masking);
        let truth = Truth::new(making.environment, kernel, &alphas);
        let level = |kernel: Kernel, alpha: f64, side: u32| {
            let directions = Directions::new(&LAYOUTS[0], convention.axes, [side; 2]);
            ExactLevel {
                values: exact::exact(&truth, kernel, &directions, alpha),
                directions,
                alpha,
            }
        };
        let specular = (0..making.level_count)
            .zip(&alphas)
            .map(|(k, alpha)| level(kernel, *alpha, (making.side >> k).max(1)))
            .collect();
        let irradiance = product.irradiance.map(|name| {
            let (kernel, alpha) = Truth::of_irradiance();
            ExactMap::new(name, vec![level(kernel, alpha, making.irradiance_side)])
        });
        let radiance = project_bilinear(&exact_quadrature(&making.environment.image));
        Self {
            specular: ExactMap::new(product.specular, specular),
            irradiance,
            radiance: sh::turned(&radiance, |file| convention.axes.to_world(file)),
            kernel,
            truth,
            alphas,
        }
    }

    /// Lists the prefiltered map and the irradiance map.
    pub fn maps(&self) -> impl Iterator<Item = &ExactMap> {
        [&self.specular].into_iter().chain(&self.irradiance)
    }

    /// Scores the maps as read back.
    pub fn compared(&self, making: &Making, bake: &Bake) -> Vec<Written> {
        let found = [&bake.specular, &bake.irradiance];
        let mut written = Vec::new();
        for (map, found) in self.maps().zip(found) {
            let found = found.as_ref().expect("it was written");
            for k in 0..map.levels.len() {
                written.push(self.compared_level(making, map, found, k));
            }
        }
        written
    }

    fn compared_level(&self, making: &Making, map: &ExactMap, found: &Map, k: usize) -> Written {
        let ExactLevel {
            directions,
            values,
            alpha,
        } = &map.levels[k];
        let found = &found.levels[k];
        let found_texels = texels(found, 1.0);
        let epsilon = self.truth.epsilon();
        let relmse = errors(directions, &found_texels, values, epsilon, 1.0).relmse;
        let is_only_level = map.levels.len() == 1;
        Written {
            name: if is_only_level {
                "irradiance".to_owned()
            } else {
                k.to_string()
            },
            side: found[0].width,
            alpha: *alpha,
            relmse,
            why: (relmse > GOOD).then(|| why(making, &map.faces[k])),
        }
    }
}

/// Says why a level errs in the pixel format of a bake.
fn why(making: &Making, faces: &[RgbImage]) -> String {
    let name = making.texel.name;
    let largest = making.texel.largest;
    let clipped = faces
        .iter()
        .flat_map(|face| &face.data)
        .filter(|texel| texel.iter().any(|value| *value > largest))
        .count();
    if clipped == 0 {
        format!("{name} rounds dark channels beside bright ones; try another --format")
    } else {
        format!("{clipped} texels are clipped at {largest}, the maximum of {name}")
    }
}
