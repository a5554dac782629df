//! Symmetry of whole frames: light and camera turn together.

use crate::compare::{Worst, relative};
use crate::harness::{filter_error, golden_environment, request, scene, with_pipeline};
use glam::{DQuat, DVec3};
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::environment::{Environment, Placement};
use splitsum::instrument::pipeline::{Frame, RenderRequest};
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride};
use splitsum::instrument::shade::{Diffuse, METHODS};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A smooth map without suns: `1 + 0.5 d.x + 0.3 d.y d.z`, other shares in green and blue.
pub fn smooth_environment() -> Arc<Environment> {
    let size = [256, 128];
    let image = RgbImage::from_fn(size[0], size[1], |x, y| {
        let uv = glam::DVec2::new((f64::from(x) + 0.5) / 256.0, (f64::from(y) + 0.5) / 128.0);
        let d = splitsum::base::math::equirect::direction_from_uv(uv);
        [
            1.0 + 0.5 * d.x + 0.3 * d.y * d.z,
            1.0 - 0.4 * d.y,
            1.0 + 0.6 * d.z,
        ]
        .map(|l| l as f32)
    });
    Arc::new(Environment::from_image("smooth", image))
}

#[test]
fn turning_environment_and_camera_together_changes_nothing() {
    with_pipeline(|pipeline| {
        let filter_error = filter_error();
        let environment = golden_environment();
        // A quarter turn to larger u is exact in the map: about +y by -90 degrees, since phi = 2 pi
        // (0.5 - u).
        let shifted = RgbImage::from_fn(512, 256, |x, y| environment.image.get((x + 384) % 512, y));
        let shifted = Arc::new(Environment::from_image("shifted", shifted));
        let turn = DQuat::from_rotation_y(-TAU / 4.0);
        for method in METHODS
            .iter()
            .filter(|method| !method.is_none() && !method.is_as_printed)
        {
            for kind in [CameraKind::Ortho, CameraKind::Perspective] {
                let still = RenderRequest {
                    reference_samples: 4096,
                    background: true,
                    ..request(
                        &environment,
                        scene("sphere", MaterialOverride::default()),
                        kind,
                        [16, 16],
                    )
                    .shaded(|s| {
                        s.method = method;
                        s.samples = 1024;
                        s.diffuse = Diffuse::listed("sh9");
                    })
                };
                let turned = RenderRequest {
                    environment: shifted.clone(),
                    camera: Camera {
                        eye: turn * still.camera.eye,
                        right: turn * still.camera.right,
                        up: turn * still.camera.up,
                        forward: turn * still.camera.forward,
                        ..still.camera
                    },
                    ..still.clone()
                };
                // The same by the parameter: the environment turns back under the fixed camera.
                let rotated = RenderRequest {
                    environment: shifted.clone(),
                    ..still.shaded(|s| {
                        s.placement = Placement {
                            rotation_deg: 90.0,
                            orientation: 0,
                        }
                    })
                };
                let [a, b, c] =
                    [&still, &turned, &rotated].map(|request| pipeline.render(request).unwrap());
                let name = format!("{} {kind:?}", method.name);
                // The frame about a direction does not turn with it, so points fall on other
                // azimuths of each pixel's lobe. The difference is the method's own error at this
                // sample count; lookups of the prefiltered map have none but the filter's, whose
                // weights may step.
                let is_drawn = method.uses_point_set
                    || still.shaded(|s| s.method = method).has_reference_term();
                let own_error = relative(if is_drawn {
                    0.15
                } else {
                    1e-5_f64.max(filter_error)
                });
                let mut camera = Worst::new(format!("{name} camera turned"), own_error);
                let mut map = Worst::new(
                    format!("{name} map turned back"),
                    relative(2e-4_f64.max(filter_error)),
                );
                let rgb = |frame: &Frame, i: usize| {
                    DVec3::from_array(frame.radiance.data[i].map(f64::from))
                };
                for i in 0..a.radiance.data.len() {
                    camera.add_rgb(rgb(&b, i), rgb(&a, i), || format!("pixel {i}"));
                    map.add_rgb(rgb(&c, i), rgb(&b, i), || format!("pixel {i}"));
                }
                [camera, map].into_iter().for_each(Worst::check);
            }
        }
    });
}
