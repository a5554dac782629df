//! Other sources of a bake: the light with its lamps cut, another encoding, or summed without solid angles.

use super::Cause;
use super::texel::{CURVES, CUTS, Change, Cut};
use crate::environment::Environment;
use crate::pixels::RgbImage;
use glam::DVec3;
use std::f64::consts::PI;

/// Largest relative difference of a bake's mean and its source's.
pub const SAME_MEAN: f64 = 0.02;
/// Texels below this share of a cut are not cut.
pub const UNCUT: f64 = 0.98;

pub fn rounded(x: f64) -> f64 {
    let digits = 10.0_f64.powf(2.0 - x.max(1e-9).log10().floor());
    (x * digits).round() / digits
}

/// Lists changed maps whose mean is a bake's over a gain: convolutions keep the mean.
pub fn sources(environment: &Environment, mean: DVec3, gains: &[f64]) -> Vec<(Cause, Environment)> {
    let image = &environment.image;
    let [by_channel, by_hue] = &CUTS;
    let changed = |(cut, most): (Cut, f64), curve: Option<Change>| {
        move |texel: [f32; 3]| {
            let x = cut(DVec3::from_array(texel.map(f64::from)), most);
            curve.map_or(x, |curve| curve(x))
        }
    };
    let mean_of = |cut: (Cut, f64), curve: Option<Change>| {
        let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
        let step = if curve.is_some() { image.height.div_ceil(512) as usize } else { 1 };
        for (y, row) in image.data.chunks_exact(image.width as usize).enumerate().step_by(step) {
            let weight = (PI * (y as f64 + 0.5) / f64::from(image.height)).sin();
            whole += weight * row.len() as f64;
            sum += weight * row.iter().map(|texel| changed(cut, curve)(*texel)).sum::<DVec3>();
        }
        sum / whole
    };
    let largest = image.data.iter().flatten().fold(1e-3, |most: f32, x| most.max(*x)).into();
    let is_same = |own: DVec3, mean: DVec3| (own - mean).abs().cmple(SAME_MEAN * mean).all();
    let cut_by = |gain: f64, (hue, cut): &(&str, Cut)| {
        let (mut low, mut high) = (1e-3, largest);
        for _ in 0..24 {
            let middle = f64::sqrt(low * high);
            let is_more = mean_of((*cut, middle), None).element_sum() > mean.element_sum() / gain;
            if is_more { high = middle } else { low = middle }
        }
        let ldr = if hue.is_empty() && (high - 1.0).abs() < 0.05 { ": LDR" } else { "" };
        let is_cut = high < UNCUT * largest && is_same(mean_of((*cut, high), None), mean / gain);
        is_cut.then(|| (format!("cut at {}{hue}{ldr}", rounded(high)), (*cut, high), None))
    };
    let curves = CURVES.iter().flat_map(|(words, curve)| {
        let cut = |most: f64| (by_channel.1, most);
        [((*words).to_owned(), cut(largest), Some(*curve)), (format!("cut at 1 and {words}"), cut(1.0), Some(*curve))]
    });
    let alike = curves.filter(|(_, cut, curve)| is_same(mean_of(*cut, *curve), mean));
    let cuts = gains.iter().flat_map(|gain| [by_channel, by_hue].into_iter().filter_map(|cut| cut_by(*gain, cut)));
    let source = |(words, cut, curve): (String, (Cut, f64), Option<Change>)| {
        let image = image.map(|texel| changed(cut, curve)(texel).as_vec3().to_array());
        let cause = Cause { kind: "source", words: format!("source {words}") };
        (cause, Environment::from_image(environment.name.clone(), image))
    };
    cuts.chain(alike).map(source).collect()
}

/// A map whose mean over the sphere is the sum over the pixels of another one, without their solid angles.
pub fn without_solid_angles(environment: &Environment) -> (Cause, Environment) {
    let (image, name) = (&environment.image, environment.name.clone());
    let sin = |y: u32| (PI * (f64::from(y) + 0.5) / f64::from(image.height)).sin() as f32;
    let over_sin = RgbImage::from_fn(image.width, image.height, |x, y| image.get(x, y).map(|value| value / sin(y)));
    let words = "source summed without the solid angle of its pixels, sin θ".to_owned();
    (Cause { kind: "source", words }, Environment::from_image(name, over_sin))
}
