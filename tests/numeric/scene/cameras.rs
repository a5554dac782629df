//! Cameras and built-in scenes.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec3Swizzles, Vec4Swizzles};
use splitsum::base::names::Listed;
use splitsum::instrument::scene::{
    Camera, CameraKind, MaterialOverride, Projection, SCENES, Scene,
};
use std::collections::HashSet;
use std::path::Path;

/// f64 rounding of a few operations on numbers of order 10.
const ROUNDING: f64 = 1e-12;

const SIZES: [[u32; 2]; 4] = [[128, 128], [64, 48], [160, 90], [45, 80]];

fn builtin(name: &str) -> Scene {
    Scene::load(name, Path::new("")).expect("a built-in scene")
}

/// Every built-in scene, camera kind and size.
fn for_each_camera(mut check: impl FnMut(&Scene, &Camera, [u32; 2])) {
    // The scene `design` is not a picture, so nothing is framed.
    for scene in SCENES
        .iter()
        .map(|entry| builtin(entry.name))
        .filter(|scene| !scene.is_design)
    {
        for &kind in CameraKind::all() {
            for size in SIZES {
                check(&scene, &Camera::for_scene(kind, &scene, size), size);
            }
        }
    }
}

/// The points that determine whether a scene fits: mesh corners, and points on the spheres.
fn points(scene: &Scene) -> Vec<DVec3> {
    let mut points: Vec<DVec3> = scene
        .meshes
        .iter()
        .flat_map(|mesh| mesh.corners())
        .collect();
    for sphere in &scene.spheres {
        for i in 0..180 {
            for j in 0..360 {
                let (theta, phi) = ((f64::from(i) + 0.5).to_radians(), f64::from(j).to_radians());
                let n = DVec3::new(
                    theta.sin() * phi.cos(),
                    theta.cos(),
                    theta.sin() * phi.sin(),
                );
                points.push(sphere.center + sphere.radius * n);
            }
        }
    }
    points
}

#[test]
fn the_sphere_cameras_follow_the_conventions() {
    let sphere = builtin("sphere");
    let ortho = Camera::for_scene(CameraKind::Ortho, &sphere, [4, 4]);
    let (origin, direction) = ortho.ray(0, 0, [4, 4]);
    assert!(
        (origin - DVec3::new(-1.05 * 0.75, 1.05 * 0.75, origin.z)).length() < ROUNDING,
        "top left pixel at {origin}"
    );
    assert!(origin.z > 1.0);
    assert_eq!(direction, DVec3::NEG_Z);
    let (origin, _) = ortho.ray(3, 2, [4, 4]);
    assert!((origin.xy() - glam::DVec2::new(1.05 * 0.75, -1.05 * 0.25)).length() < ROUNDING);
    assert_eq!(ortho.v_at(DVec3::new(0.3, -0.2, 0.5)), DVec3::Z);

    let perspective = Camera::for_scene(CameraKind::Perspective, &sphere, [4, 4]);
    let (origin, direction) = perspective.ray(0, 3, [4, 4]);
    assert_eq!(origin, DVec3::new(0.0, 0.0, 4.0));
    let slope = 16f64.to_radians().tan() * 0.75;
    assert!(
        (direction - DVec3::new(-slope, -slope, -1.0).normalize()).length() < ROUNDING,
        "bottom left ray {direction}"
    );
    let v = perspective.v_at(DVec3::new(0.0, 1.0, 0.0));
    assert!((v - DVec3::new(0.0, -1.0, 4.0) / 17f64.sqrt()).length() < ROUNDING);
}

#[test]
fn pixels_are_square_and_the_short_side_keeps_its_extent() {
    let sphere = builtin("sphere");
    for &kind in CameraKind::all() {
        let [_, contract] = Camera::for_scene(kind, &sphere, [100, 100]).extent(1.0);
        for (size, [x, y]) in [([200, 100], [2.0, 1.0]), ([100, 300], [1.0, 3.0])] {
            let extent = Camera::for_scene(kind, &sphere, size)
                .extent(f64::from(size[0]) / f64::from(size[1]));
            assert!(
                (extent[0] - x * contract).abs() < ROUNDING
                    && (extent[1] - y * contract).abs() < ROUNDING,
                "{kind:?} {size:?}: {extent:?}"
            );
            let ball = Camera::for_scene(CameraKind::Perspective, &builtin("shader-ball"), size)
                .extent(x / y);
            assert!(
                (ball[0].min(ball[1]) - 16f64.to_radians().tan()).abs() < ROUNDING,
                "{size:?}: {ball:?}"
            );
        }
    }
}

/// Maps the world to Vulkan clip space: x right, y down, depth 0 to 1. `aspect` is width / height.
fn clip_from_world(camera: &Camera, aspect: f64) -> DMat4 {
    let [extent_x, extent_y] = camera.extent(aspect);
    let [depth_scale, depth_offset] = camera.depth_scale_offset();
    let row = |axis: DVec3, offset: f64| axis.extend(offset - axis.dot(camera.eye));
    let x = row(camera.right / extent_x, 0.0);
    let y = row(-camera.up / extent_y, 0.0);
    let z = row(camera.forward * depth_scale, depth_offset);
    let w = match camera.projection {
        Projection::Ortho { .. } => DVec4::W,
        Projection::Perspective { .. } => row(camera.forward, 0.0),
    };
    DMat4::from_cols(x, y, z, w).transpose()
}

#[test]
fn clip_space_and_rays_agree_at_every_pixel_centre() {
    for_each_camera(|scene, camera, size| {
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let clip_from_world = clip_from_world(camera, aspect);
        let world_from_clip = clip_from_world.inverse();
        for (x, y) in [
            (0, 0),
            (size[0] - 1, 0),
            (7, 11),
            (size[0] / 2, size[1] / 2),
            (size[0] - 1, size[1] - 1),
        ] {
            let (origin, direction) = camera.ray(x, y, size);
            let mut last_depth = 0.0;
            for part in [0.01, 0.3, 0.6, 0.99] {
                let along = camera.near + part * (camera.far - camera.near);
                let p = origin + direction * (along / direction.dot(camera.forward));
                let clip = clip_from_world * p.extend(1.0);
                let ndc = clip.xyz() / clip.w;
                let expected = [
                    f64::from(2 * x + 1) / f64::from(size[0]) - 1.0,
                    f64::from(2 * y + 1) / f64::from(size[1]) - 1.0,
                ];
                let off = ndc.xy() - DVec2::from_array(expected);
                assert!(
                    off.abs().max_element() < ROUNDING,
                    "{} {size:?} ({x}, {y}): {ndc}",
                    scene.name
                );
                assert!(
                    ndc.z > last_depth && ndc.z < 1.0,
                    "{}: depth {} after {last_depth}",
                    scene.name,
                    ndc.z
                );
                last_depth = ndc.z;
                let back = world_from_clip * clip;
                let off = (back.xyz() / back.w - p).length();
                assert!(
                    off < ROUNDING * p.length(),
                    "{}: {back} is not {p}",
                    scene.name
                );
            }
        }
    });
}

#[test]
fn cameras_frame_their_scene_tightly() {
    for_each_camera(|scene, camera, size| {
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let clip_from_world = clip_from_world(camera, aspect);
        let mut largest = 0f64;
        for p in points(scene) {
            let clip = clip_from_world * p.extend(1.0);
            let ndc = clip.xyz() / clip.w;
            assert!(
                clip.w > 0.0 && ndc.z > 0.0 && ndc.z < 1.0,
                "{}: {p} is cut off by near or far",
                scene.name
            );
            largest = largest.max(ndc.x.abs()).max(ndc.y.abs());
        }
        // The sphere under the perspective camera has the contract's margin, 1.10.
        assert!(
            largest < 1.0 && largest > 0.9,
            "{} in {size:?} fills {largest}",
            scene.name
        );
    });
}

#[test]
fn an_override_reaches_every_material_and_the_hash() {
    let scene = builtin("spheres");
    let values = MaterialOverride {
        alpha: Some(0.4),
        f0: Some([1.0, 0.5, 0.25]),
        ..MaterialOverride::default()
    };
    let changed = scene.apply(&values);
    assert!(
        changed
            .materials
            .iter()
            .all(|material| material.alpha == 0.4 && material.f0 == [1.0, 0.5, 0.25])
    );
    let metallic = |scene: &Scene| {
        scene
            .materials
            .iter()
            .map(|material| material.metallic)
            .collect::<Vec<_>>()
    };
    assert_eq!(metallic(&changed), metallic(&scene));
    assert_ne!(changed.hash, scene.hash);
    assert_eq!(scene.apply(&MaterialOverride::default()).hash, scene.hash);
    let hashes: HashSet<String> = SCENES
        .iter()
        .map(|entry| builtin(entry.name).hash)
        .collect();
    assert_eq!(hashes.len(), SCENES.len());
}
