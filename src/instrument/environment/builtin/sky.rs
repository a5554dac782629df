//! A clear sky with the sun over a Lambertian ground.
//!
//! - Sky: the model of Hosek and Wilkie \[HosekWilkie12\], RGB data set.
//! - Sun: a uniform disc (no limb darkening) of 0.53 degrees. Its irradiance on a surface facing it
//!   is `E_c = E0 exp(-m (τr(λc) + τa(λc)))` at the dominant wavelengths `λc` of the Rec.709
//!   primaries, with the air mass of \[KastenYoung89\], `m = 1 / (sin h + 0.50572 (h° +
//!   6.07995)^-1.6364)`, and the optical depths of \[Preetham99\] (appendix): Rayleigh `τr =
//!   0.008735 λ^-4.08`, aerosols `τa = (0.04608 T - 0.04586) λ^-1.3`, λ in µm, T the turbidity.
//!   Ozone, water vapour and mixed gases are omitted: they remove a few per cent of visible light.
//! - The extraterrestrial irradiance `E0` (grey) follows from an energy balance, since the sky data
//!   has no unit: half of the light that the beam loses by scattering reaches the ground as
//!   skylight, `E_sky = E0 sin h (1 - T_beam) / 2` in luminance, with `T_beam` the transmitted
//!   share and `E_sky` the irradiance of the sky on the horizontal. At h = 35 degrees the sun then
//!   gives the horizontal 4.8 (T = 2), 2.9 (T = 3) or 1.1 (T = 6) times the light of the sky,
//!   similar to real skies.
//! - Ground: `L = albedo (E_sky + E sin h) / π`, the same in every direction below the horizon.
//!
//! The map is scaled to a mean luminance of 1 over the sphere.

use super::hosek_wilkie::Sky;
use super::{Builtin, Values, parameter, raster};
use crate::base::color::{REC709_LUMINANCE, luminance};
use crate::base::math::equirect;
use crate::base::pixels::RgbImage;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Radius of the solar disc, radians.
const SUN_HALF_ANGLE: f64 = 0.265 * PI / 180.0;

/// Dominant wavelengths of the Rec.709 primaries, µm.
const WAVELENGTHS_UM: DVec3 = DVec3::new(0.611, 0.549, 0.465);

/// A texel centre this close to the horizon lies on it (the middle row of an odd height).
const HORIZON_EPSILON: f64 = 1e-9;

pub static SKY: Builtin = Builtin {
    name: "sky",
    about: "Hosek-Wilkie clear sky with a sun disc of exact energy over a Lambertian ground; mean \
            luminance 1",
    parameters: &[
        // Below about a degree the energy balance of the sun divides by sin h -> 0.
        parameter("elevation_deg", "solar elevation", 35.0, [1.0, 90.0]),
        parameter(
            "azimuth_deg",
            "solar azimuth, from +z towards +x",
            -45.0,
            [-360.0, 360.0],
        ),
        parameter("turbidity", "haze: 2 very clear, 10 hazy", 3.0, [1.5, 10.0]),
        parameter("albedo", "reflectance of the ground", 0.3, [0.0, 1.0]),
    ],
    make,
};

fn make(values: &Values, size: [u32; 2]) -> RgbImage {
    let elevation = values.get("elevation_deg").to_radians();
    let sun = raster::direction(values.get("azimuth_deg").to_radians(), elevation);
    let turbidity = values.get("turbidity");
    let albedo = values.get("albedo");
    // Rounding to f32 may push the elevation above π/2.
    let elevation_f32 = (elevation as f32).min(std::f32::consts::FRAC_PI_2);
    let model = Sky::new(elevation_f32, turbidity as f32, albedo as f32);
    let dome = raster::at_centers(size, |d| {
        if d.y >= -HORIZON_EPSILON {
            sky_radiance(&model, sun, d)
        } else {
            DVec3::ZERO
        }
    });
    let e_sky = horizontal_irradiance(&dome);
    let e_sun = sun_irradiance(elevation, turbidity, e_sky);
    let ground = albedo * (e_sky + e_sun * elevation.sin()) / PI;

    let mut radiance: Vec<DVec3> = dome
        .data
        .iter()
        .map(|texel| DVec3::from(texel.map(f64::from)))
        .collect();
    add_ground(&mut radiance, size, ground);
    let sun_radiance = e_sun / (TAU * (1.0 - SUN_HALF_ANGLE.cos()));
    raster::cover_cap(size, sun, SUN_HALF_ANGLE, |texel, coverage| {
        radiance[texel] += sun_radiance * coverage
    });

    let scale = 4.0 * PI / luminous_energy(&radiance, size);
    let texels = radiance
        .iter()
        .map(|&texel| (texel * scale).as_vec3().to_array())
        .collect();
    RgbImage::new(size[0], size[1], texels)
}

fn sky_radiance(model: &Sky, sun: DVec3, direction: DVec3) -> DVec3 {
    let theta = direction.y.clamp(0.0, 1.0).acos() as f32;
    let gamma = direction.dot(sun).clamp(-1.0, 1.0).acos() as f32;
    // The fit can dip below 0 in the channel of a low sun.
    DVec3::from_array(model.radiance(theta, gamma).map(f64::from)).max(DVec3::ZERO)
}

/// Sets the texels below the horizon, and half of those on it.
fn add_ground(radiance: &mut [DVec3], [width, height]: [u32; 2], ground: DVec3) {
    for (row, texels) in radiance.chunks_mut(width as usize).enumerate() {
        let y = (PI * (row as f64 + 0.5) / f64::from(height)).cos();
        for texel in texels {
            if y.abs() <= HORIZON_EPSILON {
                *texel = 0.5 * (*texel + ground);
            } else if y < 0.0 {
                *texel = ground;
            }
        }
    }
}

/// Integrates the luminance over the sphere.
fn luminous_energy(radiance: &[DVec3], [width, height]: [u32; 2]) -> f64 {
    let weights = DVec3::from(REC709_LUMINANCE);
    (0..height)
        .zip(radiance.chunks(width as usize))
        .map(|(row, texels)| {
            equirect::texel_solid_angle(row, width, height)
                * texels.iter().sum::<DVec3>().dot(weights)
        })
        .sum()
}

/// Integrates the irradiance of the map's upper half on the horizontal, per channel; exact for
/// constant texels.
fn horizontal_irradiance(dome: &RgbImage) -> DVec3 {
    let mut irradiance = DVec3::ZERO;
    for row in 0..dome.height.div_ceil(2) {
        let theta = |row: u32| (PI * f64::from(row) / f64::from(dome.height)).min(PI / 2.0);
        // ∫ cos θ sin θ dθ over the row's part above the horizon.
        let cosine = 0.5 * (theta(row + 1).sin().powi(2) - theta(row).sin().powi(2));
        let texels = (0..dome.width)
            .map(|x| DVec3::from(dome.get(x, row).map(f64::from)))
            .sum::<DVec3>();
        irradiance += texels * (TAU / f64::from(dome.width) * cosine);
    }
    irradiance
}

/// Returns the sun's irradiance on a surface facing it, in the unit of `e_sky`, the skylight on the
/// horizontal.
fn sun_irradiance(elevation: f64, turbidity: f64, e_sky: DVec3) -> DVec3 {
    let air_mass =
        1.0 / (elevation.sin() + 0.50572 * (elevation.to_degrees() + 6.07995).powf(-1.6364));
    let rayleigh = 0.008735 * WAVELENGTHS_UM.powf(-4.08);
    let aerosols = (0.04608 * turbidity - 0.04586) * WAVELENGTHS_UM.powf(-1.3);
    let transmitted = (-air_mass * (rayleigh + aerosols)).exp();
    let scattered = 1.0 - transmitted.dot(REC709_LUMINANCE.into());
    let e_extraterrestrial =
        luminance(e_sky.as_vec3().to_array()) / (0.5 * elevation.sin() * scattered);
    e_extraterrestrial * transmitted
}
