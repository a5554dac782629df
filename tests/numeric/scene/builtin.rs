//! Built-in scenes, and what scenes with the same meshes share.

use glam::DVec3;
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride, SCENES, Scene, is_design};
use std::path::Path;

fn load(name: &str) -> Scene {
    Scene::load(name, Path::new("")).unwrap()
}

#[test]
fn entries_say_which_scene_is_a_design() {
    for entry in SCENES {
        assert_eq!(
            entry.is_design,
            load(entry.name).is_design,
            "{}",
            entry.name
        );
        assert_eq!(entry.is_design, is_design(entry.name), "{}", entry.name);
    }
    assert!(!is_design("ball.obj"));
}

/// Scenes of one mesh keep its hash and its extent. A scene that was just loaded has the same.
#[test]
fn scenes_that_share_meshes_equal_fresh_ones() {
    let plain = MaterialOverride::default();
    let size = [64, 48];
    let known = load("shader-ball");
    let seen = |scene: &Scene, kind| Camera::for_scene(kind, scene, size);
    for toward_viewer in [DVec3::Z, DVec3::X, known.toward_viewer, DVec3::Z] {
        let turned = Scene {
            toward_viewer,
            ..known.clone()
        };
        let fresh = Scene {
            toward_viewer,
            ..load("shader-ball")
        };
        for kind in [CameraKind::Ortho, CameraKind::Perspective] {
            assert_eq!(seen(&turned, kind), seen(&fresh, kind), "{toward_viewer}");
        }
        let hashes = [&turned, &fresh].map(|scene| scene.apply(&plain).hash);
        assert_eq!(hashes[0], hashes[1], "{toward_viewer}");
        assert_eq!(
            hashes[0] == known.hash,
            toward_viewer == known.toward_viewer
        );
        // Materials count, too.
        assert_ne!(turned.coat(0.04, |roughness| roughness).hash, hashes[0]);
    }
}
