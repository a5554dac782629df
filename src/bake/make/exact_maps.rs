//! The exact maps of a bake, and how exact they are when read back.

use super::making::Making;
use super::written::{Loss, Written};
use crate::bake::convention::Convention;
use crate::bake::judge::{Directions, Part, Truth, errors, exact, texels};
use crate::bake::map_form::MapForm;
use crate::bake::parts::{Bake, Map};
use crate::bake::playcanvas_atlas;
use crate::base::pixels::{Pixels, RgbImage};
use crate::instrument::precompute::exact_quadrature;
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::precompute::sh9::reference::{Sh9, project_bilinear, turned};
use glam::DVec3;

/// The exact texels of a level.
pub struct ExactLevel {
    directions: Directions,
    values: Vec<DVec3>,
    alpha: f64,
}

impl ExactLevel {
    /// Rounds the texels to pixels, face by face.
    fn faces(&self) -> Vec<RgbImage> {
        let [width, height] = self.directions.size;
        let texel_count = (width * height) as usize;
        // Rounding may take a series below 0.
        let texel = |value: &DVec3| value.max(DVec3::ZERO).as_vec3().to_array();
        let face =
            |values: &[DVec3]| Pixels::new(width, height, values.iter().map(texel).collect());
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
        let form = making.form();
        let level = |kernel: Kernel, alpha: f64, size: [u32; 2]| {
            let directions = Directions::new(form.layout(), convention.axes, size);
            ExactLevel {
                values: exact::exact(&truth, kernel, &directions, alpha),
                directions,
                alpha,
            }
        };
        let specular = (0..making.level_count)
            .zip(&alphas)
            .map(|(k, alpha)| level(kernel, *alpha, form.level_size(making.side, k)))
            .collect();
        let inside = matches!(form, MapForm::PlayCanvasAtlas).then_some(product.specular);
        let irradiance = product.irradiance.or(inside).map(|name| {
            let (kernel, alpha) = Truth::of_irradiance();
            let size = form.irradiance_size(making.side, making.irradiance_side);
            ExactMap::new(name, vec![level(kernel, alpha, size)])
        });
        let radiance = project_bilinear(&exact_quadrature(&making.environment.image));
        Self {
            specular: ExactMap::new(product.specular, specular),
            irradiance,
            radiance: turned(&radiance, |file| convention.axes.to_world(file)),
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
        for (part, (map, found)) in (0..).zip(self.maps().zip(found)) {
            let found = found.as_ref().expect("it was written");
            for k in 0..map.levels.len() {
                let part = if part == 0 {
                    Part::Level(k)
                } else {
                    Part::Irradiance
                };
                written.push(self.compared_level(making, map, found, part));
            }
        }
        written
    }

    /// Returns the smaller copies of level 0 in an atlas.
    pub fn mips(&self, making: &Making, convention: &Convention) -> Vec<RgbImage> {
        let layout = making.form().layout();
        playcanvas_atlas::mip_sizes(making.side)
            .map(|size| {
                let directions = Directions::new(layout, convention.axes, size);
                let level = ExactLevel {
                    values: exact::mirror(making.environment, &directions),
                    directions,
                    alpha: 0.0,
                };
                level.faces().swap_remove(0)
            })
            .collect()
    }

    fn compared_level(&self, making: &Making, map: &ExactMap, found: &Map, part: Part) -> Written {
        let k = match part {
            Part::Level(k) => k,
            _ => 0,
        };
        let ExactLevel {
            directions,
            values,
            alpha,
        } = &map.levels[k];
        let found = &found.levels[k];
        let found_texels = texels(found, 1.0);
        let epsilon = self.truth.epsilon();
        let errors = errors(directions, &found_texels, values, epsilon, 1.0);
        Written {
            part,
            side: found[0].width,
            alpha: *alpha,
            relmse: errors.relmse,
            bias_rel: errors.bias_rel,
            loss: Loss::of(making, &map.faces[k], errors),
        }
    }
}
