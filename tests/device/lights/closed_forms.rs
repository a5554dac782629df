//! Direct lights against formulas of these tests.

use super::{ROUNDING, light, under};
use crate::compare::{Tolerance, Worst, relative};
use crate::harness::{scene, with_pipeline};
use crate::methods::{radiance, sights};
use glam::DVec3;
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::MODELS;
use splitsum::instrument::scene::light::{Cone, Emitter};
use splitsum::instrument::scene::{Camera, CameraKind, Light, MaterialOverride};
use splitsum::instrument::shade::{Diffuse, Method};
use std::f64::consts::PI;

/// A Lambert surface of albedo a under irradiance E shows a E cos / π; a point light of intensity I
/// at distance d gives E = I / d²; a spot falls off to its edge. The test has its own formulas.
#[test]
fn a_lambert_surface_under_each_kind_of_light() {
    let albedo = [0.5f32, 0.25, 1.0];
    let body = MaterialOverride {
        albedo: Some(albedo),
        metallic: Some(0.0),
        ..MaterialOverride::default()
    };
    let position = DVec3::new(0.5, 1.0, 3.0);
    let axis = DVec3::new(-0.4, -0.9, -2.2).normalize();
    let (inner, outer) = (0.08f64, 0.2f64);
    let cone = Cone { inner, outer };
    let direction = axis;
    let sun = DVec3::new(1.0, 2.0, 3.0).normalize();
    let color = [4.0f32, 5.0, 6.0];
    let cases = [
        ("directional", Light::directional(-sun, color)),
        ("point", light(Emitter::Point { position }, color)),
        (
            "spot",
            light(
                Emitter::Spot {
                    position,
                    direction,
                    cone,
                },
                color,
            ),
        ),
        (
            "range",
            Light {
                range: Some(2.6),
                ..light(Emitter::Point { position }, color)
            },
        ),
    ];
    with_pipeline(|pipeline| {
        for (name, light) in cases {
            let request = under(vec![light], scene("sphere", body), 41);
            let request = request.shaded(|s| s.method = Method::listed("none"));
            let frame = pipeline.render(&request).unwrap();
            // Next to the edge of a cone the rounding of positions counts.
            let tolerance = Tolerance {
                floor: 1e-7,
                ..relative(1e-4)
            };
            let mut worst = Worst::new(name, tolerance);
            let mut shares = [0u32; 3];
            for sight in sights(&request, 1) {
                let to_light = position - sight.position;
                let distance = to_light.length();
                let l = to_light / distance;
                let (l, share) = match name {
                    "directional" => (sun, 1.0),
                    "point" => (l, 1.0 / distance.powi(2)),
                    "range" => {
                        let window = (1.0 - (distance / 2.6).powi(4)).max(0.0);
                        (l, window / distance.powi(2))
                    }
                    _ => {
                        let cosine = (-l).dot(axis);
                        let edge = (cosine - outer.cos()) / (inner.cos() - outer.cos());
                        let edge = edge.clamp(0.0, 1.0).powi(2);
                        shares[if edge == 0.0 {
                            0
                        } else if edge == 1.0 {
                            2
                        } else {
                            1
                        }] += 1;
                        (l, edge / distance.powi(2))
                    }
                };
                let cosine = sight.surface.n.dot(l).max(0.0);
                let expected = DVec3::from_array(
                    [0, 1, 2]
                        .map(|c| f64::from(albedo[c]) / PI * f64::from(color[c]) * share * cosine),
                );
                worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                    format!("{:?}", sight.pixel)
                });
            }
            worst.check();
            let has_all = name != "spot" || shares.iter().all(|count| *count > 10);
            assert!(has_all, "pixels out of, at and in the cone: {shares:?}");
        }
    });
}

/// Where view, normal and light coincide, nothing is masked and every model has D = 1 / (π alpha²):
/// a point light of intensity I at distance d shows F0 I / (4 π alpha² d²).
#[test]
fn a_lobe_at_normal_incidence_shows_its_peak() {
    const SIDE: u32 = 3;
    const F0: f32 = 0.37;
    let middle = (SIDE * SIDE / 2) as usize;
    with_pipeline(|pipeline| {
        for brdf in MODELS {
            let mut worst = Worst::new(brdf.name(), relative(ROUNDING));
            for alpha in [0.07f32, 0.33, 0.9] {
                let body = MaterialOverride {
                    albedo: Some([0.0; 3]),
                    f0: Some([F0; 3]),
                    alpha: Some(alpha),
                    ..MaterialOverride::default()
                };
                for (distance, intensity) in [(0.25, 0.003f32), (1.7, 8.0), (30.0, 500.0)] {
                    // The sphere's nearest point is (0, 0, 1).
                    let position = DVec3::new(0.0, 0.0, 1.0 + distance);
                    let light = light(Emitter::Point { position }, [intensity; 3]);
                    let mut request = under(vec![light], scene("sphere", body), SIDE)
                        .shaded(|s| (s.brdf, s.diffuse) = (*brdf, Diffuse::listed("none")));
                    request.camera =
                        Camera::for_scene(CameraKind::Ortho, &request.scene, request.size);
                    let frame = pipeline.render(&request).unwrap();
                    let peak = 1.0 / (PI * f64::from(alpha).powi(2));
                    let expected =
                        f64::from(F0) * peak / 4.0 * f64::from(intensity) / f64::powi(distance, 2);
                    worst.add(frame.radiance.data[middle][0].into(), expected, || {
                        format!("alpha {alpha} at {distance}")
                    });
                }
            }
            worst.check();
        }
    });
}
