//! Rotation of the light: a rotated map lights as the map with rotated texels, in every
//! computation.
//!
//! World from map is `Ry(rotation) R_k`, written out here: no code may use only one of the two,
//! transpose them, or swap them.

use crate::compare::{Worst, relative};
use crate::harness::{
    filter_error, golden_environment, lobe_sphere, request, scene, with_pipeline,
};
use crate::methods::{Sight, radiance, sights};
use glam::{DMat3, DVec2, DVec3};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::reflect;
use splitsum::instrument::environment::{Environment, Placement, orientation};
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::scene::{CameraKind, MaterialOverride};
use splitsum::instrument::shade::{Diffuse, METHODS, Method};
use std::f64::consts::TAU;
use std::sync::Arc;

const PLACEMENTS: [Placement; 4] = [
    Placement {
        orientation: 1,
        rotation_deg: 0.0,
    },
    Placement {
        orientation: 0,
        rotation_deg: -70.0,
    },
    Placement {
        orientation: 6,
        rotation_deg: 50.0,
    },
    Placement {
        orientation: Placement::ORIENTATION_MAX,
        rotation_deg: 200.0,
    },
];

fn world_from_map(placement: Placement) -> DMat3 {
    DMat3::from_rotation_y(placement.rotation_deg.to_radians()) * orientation(placement.orientation)
}

const GRADIENTS: [DVec3; 3] = [
    DVec3::new(0.5, 0.3, -0.1),
    DVec3::new(-0.2, 0.6, 0.1),
    DVec3::new(0.1, 0.2, 0.6),
];

/// `1 + g·d` in each channel.
fn linear_environment() -> Arc<Environment> {
    let image = RgbImage::from_fn(256, 128, |x, y| {
        let d = direction_from_uv(DVec2::new(
            (f64::from(x) + 0.5) / 256.0,
            (f64::from(y) + 0.5) / 128.0,
        ));
        GRADIENTS.map(|g| (1.0 + g.dot(d)) as f32)
    });
    Arc::new(Environment::from_image("linear", image))
}

/// `1 + share g·d` of the rotated map, for a direction in the world.
fn linear(placement: Placement, share: f64, d: DVec3) -> DVec3 {
    DVec3::from_array(GRADIENTS.map(|g| 1.0 + share * (world_from_map(placement) * g).dot(d)))
}

fn world_sights(request: &RenderRequest, step: usize) -> Vec<Sight> {
    sights(
        &request.shaded(|s| s.placement = Placement::default()),
        step,
    )
}

#[test]
fn a_linear_map_lights_by_its_turned_gradient() {
    with_pipeline(|pipeline| {
        let environment = linear_environment();
        let white = || {
            scene(
                "sphere",
                MaterialOverride {
                    albedo: Some([1.0; 3]),
                    ..MaterialOverride::default()
                },
            )
        };
        for placement in PLACEMENTS {
            let of = |scene| RenderRequest {
                reference_samples: 16384,
                ..request(&environment, scene, CameraKind::Perspective, [12, 12])
                    .shaded(|s| s.placement = placement)
            };
            // A lobe of 0.002 radians is a mirror; narrow_lobes_are_mirrors bounds the lookup's
            // error, but for lookups 1.6 times as wide.
            for method in METHODS
                .iter()
                .filter(|method| !method.is_none() && !method.is_as_printed)
            {
                let request = of(lobe_sphere(0.001)).shaded(|s| s.method = method);
                let frame = pipeline.render(&request).unwrap();
                let tolerance = if method.name.starts_with("split-sum-major") {
                    1e-2
                } else {
                    5e-3
                };
                let mut worst = Worst::new(
                    format!("{} as a mirror, {placement:?}", method.name),
                    relative(tolerance),
                );
                for sight in world_sights(&request, 5) {
                    let expected =
                        linear(placement, 1.0, reflect(sight.surface.v, sight.surface.n));
                    worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                        format!("{:?}", sight.pixel)
                    });
                }
                worst.check();
            }
            // Irradiance over pi of a linear map: two thirds of the gradient. 5e-3: the texels of
            // the map, the noise of the reference.
            for diffuse in ["sh9", "irradiance-map", "reference"] {
                let (method, diffuse) = (Method::listed("none"), Diffuse::listed(diffuse));
                let request = of(white()).shaded(|s| (s.method, s.diffuse) = (method, diffuse));
                let frame = pipeline.render(&request).unwrap();
                let mut worst = Worst::new(
                    format!("{} of a linear map, {placement:?}", diffuse.name),
                    relative(5e-3),
                );
                for sight in world_sights(&request, 5) {
                    let expected = linear(placement, 2.0 / 3.0, sight.surface.n);
                    worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                        format!("{:?}", sight.pixel)
                    });
                }
                worst.check();
            }
        }
    });
}

#[test]
fn the_background_shows_the_turned_map() {
    with_pipeline(|pipeline| {
        let filter_error = filter_error();
        let (environment, method) = (golden_environment(), Method::listed("none"));
        for (placement, kind) in PLACEMENTS
            .into_iter()
            .flat_map(|p| CameraKind::all().map(move |kind| (p, *kind)))
        {
            let own = RenderRequest {
                background: true,
                ..request(&environment, lobe_sphere(0.5), kind, [40, 24]).shaded(|s| {
                    s.method = method;
                    s.placement = placement;
                    s.environment_scale = 2.0;
                })
            };
            let frame = pipeline.render(&own).unwrap();
            // 1.5e-7 of the map's width is 1e-4 texels.
            let mut worst =
                Worst::new(format!("background {kind:?} {placement:?}"), relative(1e-4));
            for (x, y) in (0..24)
                .flat_map(|y| (0..40).map(move |x| (x, y)))
                .filter(|(x, y)| frame.mask.get(*x, *y) == 0.0)
            {
                let (_, direction) = own.camera.ray(x, y, own.size);
                let direction = world_from_map(placement).transpose() * direction;
                let (actual, expected) = (
                    radiance(&frame, [x, y]),
                    2.0 * environment.radiance(direction),
                );
                // A texel to each side.
                let beside = [DVec3::X, DVec3::Y, DVec3::Z]
                    .into_iter()
                    .flat_map(|axis| [axis, -axis]);
                let beside =
                    beside.map(|axis| 2.0 * environment.radiance(direction + axis * TAU / 512.0));
                let contrast = beside.fold(DVec3::ZERO, |most, texel| {
                    most.max((texel - expected).abs())
                });
                for c in 0..3 {
                    let more = 2.0 * filter_error * contrast[c];
                    worst.add_within(actual[c], expected[c], more, || {
                        format!("channel {c}, {x} {y}")
                    });
                }
            }
            worst.check();
        }
    });
}
