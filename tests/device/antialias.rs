//! Antialiased edges against the area of a disc.

use crate::harness::{constant_environment, request, scene, with_pipeline};
use glam::DVec3;
use splitsum::base::names::Listed;
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Projection, Sphere};
use splitsum::instrument::shade::{Diffuse, Method};
use std::f64::consts::PI;

/// Under constant light a grey sphere has one colour, and its edge pixels lie between that colour
/// and the background. On black, the image sums to the area of the disc.
#[test]
fn edges_mix_the_radiance_of_the_covered_surfaces() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        let size = [24, 24];
        let grey = MaterialOverride {
            albedo: Some([0.5; 3]),
            f0: Some([0.0; 3]),
            ..MaterialOverride::default()
        };
        let (method, half_side) = (Method::listed("none"), 1.05);
        let diffuse = Diffuse::listed("irradiance-map");
        let own = RenderRequest {
            antialias: true,
            background: true,
            ..request(&white, scene("sphere", grey), CameraKind::Ortho, size)
                .shaded(|s| (s.method, s.diffuse) = (method, diffuse))
        };
        let plain = pipeline
            .render(&RenderRequest {
                antialias: false,
                background: false,
                ..own.clone()
            })
            .unwrap();
        let level = plain.radiance.get(12, 12)[0];
        let frame = pipeline.render(&own).unwrap();
        for (texel, hit) in frame.radiance.data.iter().zip(&frame.mask.data) {
            let range = if *hit == 1.0 {
                level..=level
            } else {
                level.min(1.0)..=level.max(1.0)
            };
            // Pixels of one colour differ by f32 rounding.
            assert!(
                range.start() - 1e-6 <= texel[0] && texel[0] <= range.end() + 1e-6,
                "{texel:?} on a surface of {level} before 1"
            );
        }
        let black = pipeline
            .render(&RenderRequest {
                background: false,
                ..own
            })
            .unwrap();
        let area: f64 = black
            .radiance
            .data
            .iter()
            .map(|texel| f64::from(texel[0] / level))
            .sum();
        let disc = PI / (4.0 * half_side * half_side) * f64::from(size[0] * size[1]);
        assert!((area / disc - 1.0).abs() < 2e-3, "{area} pixels of {disc}");
        // Partly covered pixels are not scored; fully covered ones are.
        let scored: f32 = black.mask.data.iter().sum();
        assert!(
            f64::from(scored) < disc && f64::from(scored) > disc - PI * f64::from(size[0]),
            "{scored} of {disc}"
        );
    });
}

/// A dark ball in front of a bright one: among the bright one's pixels, the colours sum to the area
/// of the dark disc.
#[test]
fn edges_between_two_surfaces_are_antialiased_too() {
    with_pipeline(|pipeline| {
        let (white, radius) = (constant_environment([1.0; 3]), 0.4);
        let grey = |albedo: f32| MaterialOverride {
            albedo: Some([albedo; 3]),
            f0: Some([0.0; 3]),
            ..MaterialOverride::default()
        };
        let mut two = scene("sphere", grey(0.8));
        two.materials.extend(scene("sphere", grey(0.2)).materials);
        two.spheres.push(Sphere {
            center: DVec3::new(0.1, 0.05, 1.5),
            radius,
            material: 1,
        });
        let own = RenderRequest {
            antialias: true,
            ..request(
                &white,
                two.apply(&MaterialOverride::default()),
                CameraKind::Ortho,
                [48, 48],
            )
            .shaded(|s| {
                (s.method, s.diffuse) = (Method::listed("none"), Diffuse::listed("irradiance-map"))
            })
        };
        let Projection::Ortho { half_height } = own.camera.projection else {
            unreachable!("an ortho camera")
        };
        let plain = pipeline
            .render(&RenderRequest {
                antialias: false,
                ..own.clone()
            })
            .unwrap();
        let frame = pipeline.render(&own).unwrap();
        let (dark, bright) = (plain.radiance.get(26, 23)[0], plain.radiance.get(8, 24)[0]);
        // The middle of the image, where every point hits the bright ball.
        let inner =
            (0..48 * 48).filter(|i| (12..36).contains(&(i % 48)) && (12..36).contains(&(i / 48)));
        let covered: f64 = inner
            .clone()
            .map(|i| f64::from((bright - frame.radiance.data[i][0]) / (bright - dark)))
            .sum();
        let disc = PI * (radius / half_height * 24.0).powi(2);
        assert!(
            (covered / disc - 1.0).abs() < 5e-3,
            "{covered} pixels of {disc}"
        );
        let unscored = inner.filter(|i| frame.mask.data[*i] == 0.0).count() as f64;
        let edge = 2.0 * PI * radius / half_height * 24.0;
        assert!(
            0.8 * edge < unscored && unscored < 2.0 * edge,
            "{unscored} pixels of an edge of {edge}"
        );
    });
}
