//! The f64 g-buffer.

use crate::gbuffer_twin::gbuffer;
use glam::DVec3;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{GrayImage, exr};
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride, Scene};
use std::path::Path;

/// Two exact renderers may differ in pixels whose centre is this near to the silhouette (in
/// pixels).
const RIM_PIXELS: f64 = 1e-3;

fn xyz(texel: [f64; 4]) -> DVec3 {
    DVec3::new(texel[0], texel[1], texel[2])
}

fn golden_mask(name: &str) -> GrayImage {
    exr::read(&Path::new("tests/golden").join(name))
        .unwrap()
        .rgb
        .map(|[mask, ..]| mask)
}

/// Masks made by another renderer from the same contract.
#[test]
fn masks_equal_the_goldens() {
    for (kind, name) in [
        (CameraKind::Ortho, "mask_ortho.exr"),
        (CameraKind::Perspective, "mask_persp.exr"),
    ] {
        let golden = golden_mask(name);
        let size = [golden.width, golden.height];
        let scene = Scene::load("sphere", Path::new("")).expect("built in");
        let camera = Camera::for_scene(kind, &scene, size);
        let mask = gbuffer(&scene, &camera, size).mask();
        let pixel = 2.0 * camera.extent(1.0)[1] / f64::from(size[1]);
        for y in 0..size[1] {
            for x in 0..size[0] {
                if mask.get(x, y) != golden.get(x, y) {
                    let (origin, direction) = camera.ray(x, y, size);
                    let from_silhouette = (origin.cross(direction).length() - 1.0).abs();
                    assert!(
                        from_silhouette < RIM_PIXELS * pixel,
                        "{name}: pixel ({x}, {y}), {from_silhouette} from the silhouette"
                    );
                }
            }
        }
        assert!(mask.data.iter().sum::<f32>() > 0.5 * mask.data.len() as f32);
    }
}

#[test]
fn a_sphere_is_exact_and_misses_are_zero() {
    let scene = Scene::load("spheres", Path::new("")).expect("built in");
    for &kind in CameraKind::all() {
        let size = [75, 45];
        let camera = Camera::for_scene(kind, &scene, size);
        let images = gbuffer(&scene, &camera, size);
        let n_dot_v = images.n_dot_v(&camera);
        let mut hit_count = [0; 15];
        for y in 0..size[1] {
            for x in 0..size[0] {
                let position = images.position_mask.get(x, y);
                let (normal, f0) = (images.normal_alpha.get(x, y), images.f0_material.get(x, y));
                if position[3] == 0.0 {
                    assert_eq!(
                        [position, normal, images.albedo_metallic.get(x, y), f0],
                        [[0.0; 4]; 4],
                        "{kind:?} ({x}, {y})"
                    );
                    continue;
                }
                let sphere = &scene.spheres[f0[3] as usize];
                hit_count[f0[3] as usize] += 1;
                assert!(
                    (xyz(position) - sphere.center - sphere.radius * xyz(normal)).length() < 1e-12
                );
                assert!((xyz(normal).length() - 1.0).abs() < 1e-12);
                assert!(n_dot_v.get(x, y) >= 0.0);
                let (origin, direction) = camera.ray(x, y, size);
                assert!(
                    (xyz(position) - origin).cross(direction).length() < 1e-12,
                    "{kind:?} ({x}, {y}) is off its ray"
                );
                let material = &scene.materials[sphere.material];
                assert_eq!(normal[3], f64::from(material.alpha));
                let expected = 0.04f32 + (material.albedo[0] - 0.04) * material.metallic;
                assert!((f0[0] - f64::from(expected)).abs() < 1e-7);
            }
        }
        assert!(
            hit_count.iter().all(|&count| count > 50),
            "{kind:?}: {hit_count:?}"
        );
    }
}

#[test]
fn a_mesh_is_shaded_on_both_sides() {
    let plane = Scene::load("plane", Path::new("")).expect("built in");
    let size = [40, 30];
    let above = Camera::for_scene(CameraKind::Perspective, &plane, size);
    let below = Camera {
        eye: above.eye * DVec3::new(1.0, -1.0, 1.0),
        forward: above.forward * DVec3::new(1.0, -1.0, 1.0),
        up: -above.up * DVec3::new(1.0, -1.0, 1.0),
        ..above
    };
    assert!((below.forward.cross(below.up) - below.right).length() < 1e-12);
    for (camera, normal) in [(above, DVec3::Y), (below, DVec3::NEG_Y)] {
        let images = gbuffer(&plane, &camera, size);
        let hits: Vec<usize> = (0..images.position_mask.data.len())
            .filter(|&i| images.position_mask.data[i][3] == 1.0)
            .collect();
        assert!(hits.len() > 300, "{} pixels", hits.len());
        for i in hits {
            assert_eq!(xyz(images.normal_alpha.data[i]), normal);
            assert!(xyz(images.position_mask.data[i]).y.abs() < 1e-12);
        }
    }
}

/// Metals take their f0 from the albedo, dielectrics keep theirs; the albedo itself is stored as it
/// is.
#[test]
fn f0_follows_metallic() {
    let scene = Scene::load("sphere", Path::new("")).expect("built in");
    for (metallic, f0) in [
        (0.0, [0.1, 0.2, 0.3]),
        (1.0, [0.9, 0.5, 0.1]),
        (0.5, [0.5, 0.35, 0.2]),
    ] {
        let values = MaterialOverride {
            albedo: Some([0.9, 0.5, 0.1]),
            f0: Some([0.1, 0.2, 0.3]),
            metallic: Some(metallic),
            alpha: None,
            ..MaterialOverride::default()
        };
        let scene = scene.apply(&values);
        let camera = Camera::for_scene(CameraKind::Ortho, &scene, [1, 1]);
        let images = gbuffer(&scene, &camera, [1, 1]);
        assert!((xyz(images.f0_material.data[0]) - DVec3::from_array(f0)).length() < 1e-6);
        assert!((xyz(images.albedo_metallic.data[0]) - DVec3::new(0.9, 0.5, 0.1)).length() < 1e-6);
        assert_eq!(images.position_mask.data[0], [0.0, 0.0, 1.0, 1.0]);
    }
}
