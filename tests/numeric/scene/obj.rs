//! OBJ files, written by the tests into a temporary folder.

use crate::cpu_time;
use crate::gbuffer_twin::gbuffer;
use crate::snapshot::assert_snapshot;
use glam::DVec3;
use splitsum::instrument::scene::{Camera, CameraKind, Mesh, Scene};
use std::fmt::Write;

/// Rounding of f32 positions of order 1 in sums of areas.
const F32_ROUNDING: f64 = 1e-6;

/// Writes the files (name, bytes) into a new folder and loads `scene.obj`, the first.
fn load(files: &[(&str, &[u8])]) -> Result<Scene, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("a file in the temporary folder");
    }
    Scene::load(files[0].0, folder.path()).map_err(|error| error.to_string())
}

fn load_text(text: &str) -> Result<Scene, String> {
    load(&[("scene.obj", text.as_bytes())])
}

fn loaded(text: &str) -> Scene {
    load_text(text).expect("a readable file")
}

fn of_material(lines: &str) -> Result<Scene, String> {
    let obj = format!("mtllib m.mtl\n{QUAD}usemtl m\nf 1 2 3 4\n");
    load(&[
        ("scene.obj", obj.as_bytes()),
        ("m.mtl", format!("newmtl m\n{lines}\n").as_bytes()),
    ])
}

fn areas(mesh: &Mesh) -> Vec<DVec3> {
    let corners: Vec<DVec3> = mesh.corners().collect();
    corners
        .chunks_exact(3)
        .map(|p| 0.5 * (p[1] - p[0]).cross(p[2] - p[0]))
        .collect()
}

fn triangle_count(scene: &Scene) -> usize {
    scene
        .meshes
        .iter()
        .map(|mesh| mesh.triangles().count())
        .sum()
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn every_form_of_a_face_gives_the_same_square() {
    let expected = loaded(&format!("{QUAD}f 1 2 3 4\n"));
    assert_eq!(triangle_count(&expected), 2);
    let forms = [
        format!("{QUAD}f 1 2 3 4"),
        format!("{QUAD}f -4 -3 -2 -1\n"),
        format!("{QUAD}vn 0 0 1\nf 1//1 2//1 3//1 4//1\n"),
        format!("{QUAD}vn 0 0 7\nf 1//1 2//1 3//1 4//1 # a square\n"),
        format!("{QUAD}f 1 2 \\\n 3 4\n"),
        format!("\u{feff}# C:\\models\\\n{QUAD}o a\ng b c\ns 1\nf 1 2 3 4\n"),
        format!("{QUAD}f 1 2 3 4\n").replace('\n', "\r\n"),
        format!("{QUAD}\tf\t1  2\t3 4  \n").replace("v ", "v\t"),
        "v 0 0 0 1\nv 1. +0 0\nv 1e0 10E-1 .0 1\nv 0 1 0 0.5 0.5\nf 1 2 3 4\n".to_owned(),
    ];
    for text in forms {
        let scene = loaded(&text);
        assert_eq!(scene.hash, expected.hash, "{text:?}");
        assert_eq!(scene.warnings, Vec::<String>::new(), "{text:?}");
    }
}

#[test]
fn normals_of_some_corners_are_replaced() {
    let expected = loaded(&format!("{QUAD}f 1 2 3 4\n"));
    let scene = loaded(&format!("{QUAD}vn 1 0 0\nf 1//-1 2// 3 4//1\n"));
    assert_eq!(scene.hash, expected.hash);
    assert!(
        scene.warnings[0].contains("1 groups of faces lack some normals"),
        "{:?}",
        scene.warnings
    );
}

/// Positions, faces, materials: each wrong line is reported with the expected form.
#[test]
fn wrong_files_are_refused_with_the_line() {
    let scenes = [
        "",
        QUAD,
        "v 0 0 nan\n",
        "v 0 0 0\nv 1e39 0 0\n",
        "v 0 0 1e20\n",
        "v 0 0\n",
        "\n\nv 0 0 zero\n",
        "v 0 0 0\nvn 0 1\n",
        "v 0 0 0\nf 1 1 2\nv 1 0 0\n",
        "v 0 0 0\nf 1 1 0\n",
        "v 0 0 0\nf 1 1 -2\n",
        "v 0 0 0\nf 1/1 1/1 1/1\n",
        "v 0 0 0\nf 1//3 1 1\n",
        "v 0 0 0\nf 99999999999999999999 1 1\n",
        "v 0 0 0\nf 9223372036854775807 1 1\n",
        "v 0 0 0\nf 1 -9223372036854775808 1\n",
        "v 0 0 0\nvt 0 0\nvn 0 0 1\nf 1/1/1/1 1 1\n",
        "v 0 0 0\nf 1 \\\n1\n",
        // The first wrong line is reported.
        "v 0 0 0\nf 1 1 7\nf 1 1 0\n",
        "usemtl\n",
        "v 0 0 0\nf 1 1 1\n",
    ];
    let scenes = scenes.map(|text| (text, load_text(text)));
    let huge = format!("v 0 0 0\nf{}\n", " 1".repeat(70_000));
    let said = load_text(&huge).expect_err("a face of 70,000 corners");
    assert!(
        said.contains("scene.obj:2: f: 70000 corners; expected 3 to 65536"),
        "{said}"
    );
    let materials = [
        "Kd 1 1",
        "Kd 1 1 x",
        "Kd spectral a.rfl",
        "Ke xyz 0.3 0.3 0.3",
        "Ns inf",
        "Ns 1e999",
        "Pr",
        "map_Kd",
        "newmtl",
    ];
    let materials = materials.map(|text| (text, of_material(text)));
    let shown = scenes.into_iter().chain(materials).map(|(text, scene)| {
        let message = scene.expect_err(text);
        format!(
            "{text:?}\n    {}",
            &message[message
                .find("scene.obj")
                .or(message.find("m.mtl"))
                .unwrap_or(0)..]
        )
    });
    assert_snapshot(
        "obj_files_that_are_refused",
        &shown.collect::<Vec<_>>().join("\n"),
    );
}

#[test]
fn materials_and_groups_keep_their_faces() {
    let text = format!(
        "mtllib missing.mtl\nmtllib two words.mtl\nmtllib a.mtl b.mtl\n{QUAD}v 0 0 1\nusemtl red \
         one\nf 1 2 3\no other\nusemtl gold\nf 1 3 4\n\
         usemtl nowhere\nf 1 2 5\nusemtl red one\nf 2 3 5\nl 1 2\n"
    );
    let scene = load(&[
        ("scene.obj", text.as_bytes()),
        ("two words.mtl", b"newmtl red one\nKd 1 0 0\nPr 0.5\n"),
        ("a.mtl", b"newmtl gold\nKd 1 2 0.5\nPr 0.5\nPm 1\nNi 1.5\n"),
        ("b.mtl", b"newmtl unused\nKd 0.5 0.5 0.5\n"),
    ])
    .expect("a readable file");
    let counts: Vec<(&str, usize)> = scene
        .meshes
        .iter()
        .map(|mesh| {
            (
                scene.materials[mesh.material].name.as_str(),
                mesh.triangles().count(),
            )
        })
        .collect();
    assert_eq!(counts, [("red one", 2), ("gold", 1), ("default", 1)]);
    let [red, gold, default] = &scene.materials[..] else {
        panic!("{:?}", scene.materials)
    };
    assert_eq!(
        (red.albedo, red.alpha, red.metallic, red.f0),
        ([1.0, 0.0, 0.0], 0.25, 0.0, [0.04; 3])
    );
    assert_eq!(
        (gold.albedo, gold.alpha, gold.metallic),
        ([1.0, 1.0, 0.5], 0.25, 1.0)
    );
    assert!((gold.f0[0] - 0.04).abs() < 1e-7);
    assert_eq!((default.albedo, default.alpha), ([0.8; 3], 0.25));
    let gold = "a.mtl: material \"gold\": Kd 2 is outside";
    let expected = [
        "1 x l",
        "missing.mtl: cannot read",
        gold,
        "material \"nowhere\" is not defined",
    ];
    assert_eq!(scene.warnings.len(), expected.len(), "{:?}", scene.warnings);
    assert!(
        scene
            .warnings
            .iter()
            .zip(expected)
            .all(|(warning, part)| warning.contains(part)),
        "{:?}",
        scene.warnings
    );
    // Callers put the scene's name before each warning.
    assert!(
        scene
            .warnings
            .iter()
            .all(|warning| !warning.contains("scene.obj")),
        "{:?}",
        scene.warnings
    );
}

/// Joining by copies took time quadratic in the number of lines: minutes here.
#[test]
fn a_statement_of_a_million_lines_is_read_at_once() {
    let start = cpu_time();
    let scene = loaded(&format!("{QUAD}f 1 2 3 {}4\n", "\\\n".repeat(1_000_000)));
    assert_eq!(triangle_count(&scene), 2);
    let taken = cpu_time() - start;
    assert!(taken.as_secs() < 10, "{taken:?}");
}

/// Twice the texels of the largest accepted map, in 100 bytes: refused by its header.
#[test]
fn a_map_too_large_for_memory_is_left_out_by_its_header() {
    let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x40\0\0\0\x20\0\x08\x02\0\0\0".to_vec();
    let mut crc = flate2::Crc::new();
    crc.update(&header[12..]);
    header.extend(crc.sum().to_be_bytes());
    header.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    let scene = load(&[
        (
            "scene.obj",
            format!("mtllib m.mtl\n{QUAD}usemtl m\nf 1 2 3 4\n").as_bytes(),
        ),
        ("m.mtl", b"newmtl m\nmap_Kd bomb.png\n"),
        ("bomb.png", &header),
    ]);
    let warnings = scene.expect("a readable file").warnings;
    assert!(
        warnings[0].contains("16384x8192 texels; expected at most 67108864"),
        "{warnings:?}"
    );
}

#[test]
fn material_parameters_become_alpha_and_f0() {
    let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-6;
    let cases = [
        ("Ns 0", 1.0, 0.04, 1),
        ("Ns 250", (2.0f64 / 252.0).sqrt(), 0.04, 1),
        ("Ns 250\nPr 0.3", 0.09, 0.04, 0),
        ("Pr 0\nKs 1 1 1", 1e-3, 0.04, 0),
        ("Pr 2", 1.0, 0.04, 1),
        ("Ns -5", 1.0, 0.04, 2),
        ("Ni 1.0", 0.25, 0.04, 0),
        ("Ni 2", 0.25, 1.0 / 9.0, 0),
        ("map_Ps r.png\nbump n.png", 0.25, 0.04, 1),
        ("map_Kd missing.png", 0.25, 0.04, 1),
        (
            "map_Kd -s 1 1 -o 0.5 -clamp on missing one.png",
            0.25,
            0.04,
            2,
        ),
    ];
    for (parameters, alpha, f0, warning_count) in cases {
        let scene = of_material(parameters).expect(parameters);
        let material = &scene.materials[0];
        assert!(
            near(material.alpha, alpha) && near(material.f0[0], f0),
            "{parameters}: {material:?}"
        );
        assert_eq!(material.albedo, [0.8; 3], "{parameters}");
        assert_eq!(scene.warnings.len(), warning_count, "{parameters}");
    }
}

/// v counts up in OBJ and rows count down in images; texels are sRGB; Kd multiplies.
#[test]
fn an_albedo_map_is_linear_and_upright() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut texels = image::RgbImage::new(2, 2);
    texels.put_pixel(0, 0, image::Rgb([255, 0, 0]));
    texels.put_pixel(1, 0, image::Rgb([0, 255, 0]));
    texels.put_pixel(0, 1, image::Rgb([0, 0, 255]));
    texels.put_pixel(1, 1, image::Rgb([188, 188, 188]));
    texels
        .save(folder.path().join("four.png"))
        .expect("a texture");
    std::fs::write(
        folder.path().join("m.mtl"),
        "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd four.png\n",
    )
    .expect("a material");
    let text = format!(
        "mtllib m.mtl\n{QUAD}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n"
    );
    std::fs::write(folder.path().join("scene.obj"), text).expect("a mesh");
    let mut scene = Scene::load("scene.obj", folder.path()).expect("a readable file");
    assert_eq!(scene.warnings, Vec::<String>::new());
    scene.toward_viewer = DVec3::Z;
    // Two by two pixels over the unit square: their centres are the texels' centres.
    let size = [2, 2];
    let mut camera = Camera::for_scene(CameraKind::Ortho, &scene, size);
    camera.projection = splitsum::instrument::scene::Projection::Ortho { half_height: 0.5 };
    let albedo = gbuffer(&scene, &camera, size).albedo_metallic;
    // sRGB 188 is 0.50289 linear (IEC 61966-2-1).
    let expected = [
        [0.5, 0.0, 0.0],
        [0.0, 0.5, 0.0],
        [0.0, 0.0, 0.5],
        [0.25144; 3],
    ];
    for (texel, expected) in albedo.data.iter().zip(expected) {
        let error = DVec3::new(texel[0], texel[1], texel[2]) - DVec3::from_array(expected);
        assert!(error.length() < 1e-4, "{texel:?}, expected {expected:?}");
    }
}

/// A star-shaped polygon with `n` corners in the plane through `at` spanned by `a` and `b`; radii
/// alternate, so it is far from convex.
fn star(n: usize, at: DVec3, a: DVec3, b: DVec3) -> (String, f64) {
    let radius = |i: usize| {
        if i.is_multiple_of(2) {
            1.0
        } else {
            0.35 + 0.1 * (i as f64).sin()
        }
    };
    let angle = |i: usize| i as f64 / n as f64 * std::f64::consts::TAU;
    let mut text = String::new();
    for i in 0..n {
        let p = (at + (a * angle(i).cos() + b * angle(i).sin()) * radius(i)).as_vec3();
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    text.push('f');
    (1..=n).for_each(|i| {
        let _ = write!(text, " {i}");
    });
    let area = (0..n)
        .map(|i| 0.5 * radius(i) * radius((i + 1) % n) * (angle(i + 1) - angle(i)).sin())
        .sum();
    (text, area)
}

#[test]
fn polygons_of_any_shape_keep_their_area() {
    let planes = [
        (DVec3::X, DVec3::Y),
        (DVec3::Y, DVec3::X),
        (DVec3::Z, DVec3::X),
        (DVec3::Y, DVec3::Z),
        (
            DVec3::new(1.0, 1.0, 0.0).normalize(),
            DVec3::new(1.0, -1.0, 2.0).normalize(),
        ),
    ];
    for n in [4, 5, 8, 31, 500, 5000] {
        for (a, b) in planes {
            let (text, area) = star(n, DVec3::new(1.0, 2.0, -1.0), a, b);
            let scene = loaded(&text);
            let areas = areas(&scene.meshes[0]);
            // All triangles face one way and their areas sum to the polygon's: none overlaps and
            // none is missing.
            let total: f64 = areas.iter().map(|area| area.length()).sum();
            assert!(
                (total - area).abs() < F32_ROUNDING * n as f64,
                "{n} corners: {total}, expected {area}"
            );
            assert!(
                areas.iter().all(|area| area.dot(a.cross(b)) > 0.0),
                "{n} corners, {a} {b}"
            );
            assert_eq!(areas.len(), n - 2);
            assert_eq!(scene.warnings, Vec::<String>::new());
        }
    }
}

#[test]
fn polygons_with_odd_corners_keep_their_area() {
    // A square with corners in the middle of its sides, a square ring cut open along a doubled
    // edge, a repeated corner.
    let ring = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\nf 1 2 3 4 \
                1 5 6 7 8 5\n";
    let cases = [
        (
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 1 2 0\nv 0 2 0\nv 0 1 0\nf 1 2 3 4 5 6 7\n",
            4.0,
        ),
        (ring, 8.0),
        ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 3 4\n", 1.0),
        // Concave at the corner that a fan from the first corner would cross.
        ("v 0 0 0\nv 4 4 0\nv 0 1 0\nv -4 4 0\nf 1 2 3 4\n", 4.0),
    ];
    for (text, expected) in cases {
        let scene = loaded(text);
        let total: f64 = areas(&scene.meshes[0])
            .iter()
            .map(|area| area.length())
            .sum();
        assert!(
            (total - expected).abs() < F32_ROUNDING,
            "{text:?}: {total}, expected {expected}"
        );
    }
    // Two unequal triangles, and two equal ones, whose vector area is 0.
    for height in [1, 2] {
        let tie = loaded(&format!(
            "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 {height} 0\nf 1 2 3 4\n"
        ));
        assert!(
            tie.warnings
                .iter()
                .any(|warning| warning.contains("cross themselves")),
            "{:?}",
            tie.warnings
        );
    }
}

/// A unit sphere of quads and triangles without normals, cut into two materials.
fn sphere_text(rings: usize) -> String {
    let segments = 2 * rings;
    let mut text = "mtllib m.mtl\nv 0 1 0\n".to_owned();
    for ring in 1..rings {
        for segment in 0..segments {
            let theta = std::f64::consts::PI * ring as f64 / rings as f64;
            let phi = std::f64::consts::TAU * segment as f64 / segments as f64;
            let _ = writeln!(
                text,
                "v {} {} {}",
                theta.sin() * phi.sin(),
                theta.cos(),
                theta.sin() * phi.cos()
            );
        }
    }
    // The upper pole twice, with both zeros.
    text.push_str("v 0 -1 0\nv -0 1 0\n");
    let index = |ring: usize, segment: usize| 2 + (ring - 1) * segments + segment % segments;
    for segment in 0..segments {
        let pole = if segment < rings {
            1
        } else {
            3 + (rings - 1) * segments
        };
        let _ = writeln!(
            text,
            "f {pole} {} {}",
            index(1, segment),
            index(1, segment + 1)
        );
        for ring in 1..rings - 1 {
            let [a, b] = [index(ring, segment), index(ring + 1, segment)];
            let _ = writeln!(text, "usemtl m{}", ring % 2);
            let _ = writeln!(
                text,
                "f {a} {b} {} {}",
                index(ring + 1, segment + 1),
                index(ring, segment + 1)
            );
        }
        let last = 2 + (rings - 1) * segments;
        let _ = writeln!(
            text,
            "f {} {last} {}",
            index(rings - 1, segment),
            index(rings - 1, segment + 1)
        );
    }
    text
}

#[test]
fn computed_normals_of_a_sphere_point_along_its_radii() {
    let materials = ("m.mtl", b"newmtl m0\nnewmtl m1\n".as_slice());
    let scene =
        load(&[("scene.obj", sphere_text(24).as_bytes()), materials]).expect("a readable file");
    // The normals are smooth across the seams of three meshes.
    assert_eq!(scene.meshes.len(), 3);
    let mut count = 0;
    for mesh in &scene.meshes {
        for (n, p) in mesh.normals.iter().zip(&mesh.positions) {
            let [n, p] = [n, p].map(|v| glam::Vec3::from_array(*v).as_dvec3());
            assert!((n.length() - 1.0).abs() < F32_ROUNDING);
            // Of the order of the square of the half angle of a quad, 0.0043; flat normals would be
            // 0.065 off.
            assert!((n - p).length() < 0.003, "normal {n} at {p}");
            count += 1;
        }
    }
    assert!(count > 1000);
}

/// The order of corners does not matter: triangles are wound to agree with the normals of the file.
#[test]
fn winding_follows_given_normals() {
    let front = loaded(&format!("{QUAD}vn 0 0 1\nf 1//1 2//1 3//1 4//1\n"));
    let back = loaded(&format!("{QUAD}vn 0 0 1\nf 4//1 3//1 2//1 1//1\n"));
    for scene in [front, back] {
        assert!(areas(&scene.meshes[0]).iter().all(|area| area.z > 0.0));
    }
}

/// A cube of eight corners, whose faces are preceded by these lines.
fn cube(lines: [&str; 6]) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let side = |bit: u32| 2 * (corner >> bit & 1) - 1;
        let _ = writeln!(text, "v {} {} {}", side(0), side(1), side(2));
    }
    let faces = [
        "1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6",
    ];
    for (line, face) in lines.into_iter().zip(faces) {
        let _ = writeln!(text, "{line}\nf {face}");
    }
    text
}

/// The normals of the corners of each triangle, and the triangle's own.
fn corner_normals(mesh: &Mesh) -> Vec<([DVec3; 3], DVec3)> {
    let vector = |v: [f32; 3]| glam::Vec3::from_array(v).as_dvec3();
    mesh.triangles()
        .zip(areas(mesh))
        .map(|(triangle, area)| {
            let normals = triangle.map(|index| vector(mesh.normals[index as usize]));
            (normals, area.normalize())
        })
        .collect()
}

/// Faces without a smoothing group have their own normals; groups are smooth each by itself.
#[test]
fn smoothing_groups_part_the_normals() {
    let flat = ["s off", "s 0", "s OFF # none"];
    for line in flat {
        for lines in [[line, "", "", "", "", ""], ["", "", "", "", "", line]] {
            let scene = loaded(&cube(lines));
            assert_eq!(scene.meshes[0].positions.len(), 24, "{line}");
            for (normals, own) in corner_normals(&scene.meshes[0]) {
                let off = normals.map(|n| (n - own).length());
                assert!(off.iter().all(|off| *off < F32_ROUNDING), "{line}: {off:?}");
            }
        }
    }
    // A ball: without any `s`, and in one group.
    let ball = loaded(&cube([""; 6]));
    assert_eq!(loaded(&cube(["s 1", "", "", "", "", ""])).hash, ball.hash);
    let diagonal = 1.0 / 3f64.sqrt();
    for (normals, own) in corner_normals(&ball.meshes[0]) {
        assert!(
            normals
                .iter()
                .all(|n| (n.dot(own) - diagonal).abs() < F32_ROUNDING)
        );
    }
    // Two groups: the corners of the pair of faces in group 2 lean 45 degrees.
    let pair = loaded(&cube(["s 2", "s off", "s 2", "s off", "", ""]));
    let smooth = corner_normals(&pair.meshes[0])
        .into_iter()
        .filter(|(normals, own)| normals.iter().any(|n| n.dot(*own) < 0.99));
    let smooth: Vec<_> = smooth.collect();
    assert_eq!(smooth.len(), 4);
    for (normals, own) in smooth {
        for n in normals {
            let cosine = n.dot(own);
            let is_shared = (cosine - 0.5f64.sqrt()).abs() < F32_ROUNDING;
            assert!(is_shared || (cosine - 1.0).abs() < F32_ROUNDING, "{cosine}");
        }
    }
    // Given normals win.
    let given = format!("{QUAD}vn 1 0 1\ns off\nf 1//1 2//1 3//1 4//1\n");
    assert!(loaded(&given).meshes[0].normals[0][0] > 0.7);
}

/// Files that Blender wrote follow its writer's laws; the same lines of another writer don't.
#[test]
fn materials_by_blender_follow_its_laws() {
    const HEAD: &str = "# Blender 5.2.3 LTS MTL File: 'a.blend'\n";
    let of = |head: &str, lines: &str| {
        let obj = format!("mtllib m.mtl\n{QUAD}usemtl m\nf 1 2 3 4\n");
        let mtl = format!("{head}newmtl m\n{lines}\n");
        let files = [("scene.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        load(&files).expect("a readable file")
    };
    let plain =
        "Ns 250\nKa 0.75 0.75 0.75\nKd 0.9 0.6 0.3\nKs 0.25 0.25 0.25\nNi 1.5\nd 1\nillum 3";
    let metal = of(HEAD, plain);
    let material = &metal.materials[0];
    // 250 is 1000 (1 - 0.5)².
    assert!((material.alpha - 0.25).abs() < 1e-6, "{}", material.alpha);
    assert_eq!(material.metallic, 0.75);
    assert!((material.f0[0] - 0.02).abs() < 1e-6, "{:?}", material.f0);
    let [note] = &metal.warnings[..] else {
        panic!("{:?}", metal.warnings)
    };
    for law in ["Blender", "Ns as 1000", "Ka", "Ks"] {
        assert!(note.contains(law), "{note}");
    }
    let other = of("", plain);
    let material = &other.materials[0];
    assert!((f64::from(material.alpha) - (2.0f64 / 252.0).sqrt()).abs() < 1e-6);
    assert_eq!((material.metallic, material.f0), (0.0, [0.04; 3]));
    assert!(other.warnings[0].contains("Phong"), "{:?}", other.warnings);

    let layered = "Pr 0.5\nPm 0\nPs 0.6\nPc 2\nPcr 0.1\naniso 0.7\nanisor 0.25\nKe 3 1.5 0.3\nd 0.4\nTf 1 1 1\nmap_Ks a.png";
    for (head, weight) in [(HEAD, 0.5), ("", 1.0)] {
        let scene = of(head, layered);
        let material = &scene.materials[0];
        assert_eq!(material.coat.weight, weight);
        assert!((material.coat.alpha - 0.01).abs() < 1e-7);
        assert_eq!(material.sheen.color, [0.6; 3]);
        assert_eq!(material.anisotropy.strength, 0.7);
        let turn = f64::from(material.anisotropy.turn);
        assert!((turn - std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{turn}");
        assert_eq!(material.emission.color, [3.0, 1.5, 0.3]);
        let unread = scene.warnings.last().expect("a warning");
        assert!(unread.contains("not read: d, map_Ks"), "{unread}");
    }
}

/// 3ds Max repeats the albedo map as the map of the ambient colour.
#[test]
fn an_albedo_map_is_not_occlusion() {
    let scene = of_material("map_Kd a b.png\nmap_Ka a b.png").expect("a readable file");
    assert!(!scene.has_occlusion());
    let warnings = scene.warnings.join("; ");
    assert!(warnings.contains("not read: map_Ka"), "{warnings}");
    let empty = of_material("map_Ka").unwrap_err();
    assert!(empty.contains("expected a file"), "{empty}");
}

/// One number is a grey, as of the format's description.
#[test]
fn colours_of_one_number_are_grey() {
    let scene = of_material("Kd 0.25\nKe 0.5").expect("a readable file");
    assert_eq!(scene.materials[0].albedo, [0.25; 3]);
    assert_eq!(scene.materials[0].emission.color, [0.5; 3]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

/// Forms of statements that let light through or tint the reflection.
#[test]
fn statements_of_glass_and_metal_are_named() {
    for (line, name) in [
        ("d -halo 0.5", "d"),
        ("d 0.5 # half", "d"),
        ("Tf xyz 0.2 0.2 0.2", "Tf"),
        ("Tf spectral glass.rfl", "Tf"),
        ("Tf 0.5", "Tf"),
        ("illum 7", "illum"),
        ("Ks 0.9 0.6 0.2", "Ks"),
    ] {
        let warnings = of_material(line).expect(line).warnings;
        let ending = format!("not read: {name}");
        assert!(
            warnings.len() == 1 && warnings[0].ends_with(&ending),
            "{line}: {warnings:?}"
        );
    }
    for line in [
        "d 1",
        "d -halo 1",
        "Tf 1 1 1",
        "Tf 1",
        "illum 2",
        "Ks 0.5 0.5 0.5",
        "Ks 0.5",
    ] {
        let warnings = of_material(line).expect(line).warnings;
        assert!(warnings.is_empty(), "{line}: {warnings:?}");
    }
}

/// The last definition counts; equal ones need no word.
#[test]
fn materials_with_several_definitions_are_named() {
    let scene = of_material("Kd 1 0 0\nnewmtl m\nKd 0.5 0.25 0.125").unwrap();
    assert_eq!(scene.materials[0].albedo, [0.5, 0.25, 0.125]);
    assert_eq!(
        scene.warnings,
        ["material \"m\" has several definitions; the last one is used"]
    );
    let equal = of_material("Kd 1 0 0\nnewmtl m\nKd 1 0 0").unwrap();
    assert!(equal.warnings.is_empty(), "{:?}", equal.warnings);
}

/// Colours behind positions, ZBrush's comment, and normals without a direction.
#[test]
fn vertex_colours_and_zero_normals_are_named() {
    let colored = QUAD.replace(" 0\n", " 0 1 0 0\n");
    let warnings = loaded(&format!("{colored}f 1 2 3 4\n")).warnings;
    assert_eq!(warnings, ["not read: vertex colours"]);
    let weighted = QUAD.replace(" 0\n", " 0 2\n");
    assert!(
        loaded(&format!("{weighted}f 1 2 3 4\n"))
            .warnings
            .is_empty()
    );
    let warnings = loaded(&format!("{QUAD}#MRGB ffff0000\nf 1 2 3 4\n")).warnings;
    assert_eq!(warnings, ["statements that are not read: 1 x #MRGB"]);
    let scene = loaded(&format!("{QUAD}vn 0 0 0\nf 1//1 2//1 3//1 4//1\n"));
    assert_eq!(
        scene.warnings,
        ["4 normals of zero length are computed from the faces"]
    );
    assert_eq!(scene.hash, loaded(&format!("{QUAD}f 1 2 3 4\n")).hash);
}

/// Statements in the wrong file, and names that nobody knows, are named in a warning.
#[test]
fn statements_in_the_wrong_file_are_named() {
    let obj = format!("mtllib m.mtl\n{QUAD}Kd 1 0 0\nusemtl m\nf 1 2 3 4\n");
    let files = [
        ("scene.obj", obj.as_bytes()),
        (
            "m.mtl",
            b"newmtl m\nPr 0.5\nv 1 2 3\nRoughness 1\n".as_slice(),
        ),
    ];
    let warnings = load(&files).expect("a readable file").warnings;
    assert!(warnings[0].contains("1 x Kd"), "{warnings:?}");
    assert!(
        warnings[1].contains("not read: Roughness, v"),
        "{warnings:?}"
    );
}

/// Faces above the first `usemtl` have the only material there is.
#[test]
fn the_only_material_needs_no_usemtl() {
    let of = |mtl: &str, last: &str| {
        let obj = format!("mtllib m.mtl\n{QUAD}f 1 2 3\n{last}f 1 3 4\n");
        let files = [("scene.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        load(&files).expect("a readable file")
    };
    let one = "newmtl red\nKd 1 0 0\nPr 0.5\n";
    for last in ["", "usemtl red\n"] {
        let scene = of(one, last);
        assert_eq!(scene.materials.len(), 1);
        assert_eq!(scene.materials[0].albedo, [1.0, 0.0, 0.0]);
        assert_eq!(scene.warnings, Vec::<String>::new());
    }
    let scene = of(&format!("{one}newmtl blue\n"), "usemtl red\n");
    assert_eq!(scene.materials.len(), 2);
    assert!(
        scene.warnings[0].contains("1 faces are above the first usemtl"),
        "{:?}",
        scene.warnings
    );
}

/// Grey maps of roughness and metallic, and a map of normals, which needs tangents.
#[test]
fn maps_of_the_pbr_fields_are_read() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let save = |name: &str, texel: [u8; 3]| {
        image::RgbImage::from_pixel(1, 1, image::Rgb(texel))
            .save(folder.path().join(name))
            .expect("a texture");
    };
    save("grey.png", [102; 3]);
    save("bent.png", [255, 128, 128]);
    save("red.png", [51, 255, 255]);
    let text = format!(
        "mtllib m.mtl\n{QUAD}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n"
    );
    std::fs::write(folder.path().join("scene.obj"), text).expect("a mesh");
    let lines =
        "newmtl m\nKd 1 1 1\nmap_Pr grey.png\nmap_Pm grey.png\nmap_Ke grey.png\nmap_Ka red.png\n";
    for normal in ["norm bent.png", "norm -bm 1.0 bent.png"] {
        std::fs::write(folder.path().join("m.mtl"), format!("{lines}{normal}\n"))
            .expect("a material");
        let scene = Scene::load("scene.obj", folder.path()).expect("a readable file");
        assert_eq!(scene.warnings, Vec::<String>::new());
        let mut camera = Camera::for_scene(CameraKind::Ortho, &Scene::sphere(), [1, 1]);
        camera.eye = DVec3::new(0.4, 0.3, 3.0);
        let seen = gbuffer(&scene, &camera, [1, 1]);
        let [x, .., alpha] = seen.normal_alpha.data[0];
        assert!((alpha - 0.16).abs() < 1e-6 && x > 0.7, "{alpha} {x}");
        assert!((seen.albedo_metallic.data[0][3] - 0.4).abs() < 1e-6);
        let emission = gbuffer(&scene.emission(), &camera, [1, 1]);
        let linear = f64::from(splitsum::base::color::srgb_decode(0.4));
        assert!((emission.albedo_metallic.data[0][0] - linear).abs() < 1e-6);
        let occlusion = gbuffer(&scene.occlusions(), &camera, [1, 1]);
        assert!((occlusion.albedo_metallic.data[0][0] - 0.2).abs() < 1e-6);
    }
}
