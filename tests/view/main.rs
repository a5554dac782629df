//! The window, driven by real input on a virtual display: Xvfb, xdotool and a window manager, on
//! any Vulkan device.

#![expect(
    clippy::too_many_lines,
    reason = "a test states its cases and follows one scenario"
)]

#[path = "../shared/occluded.rs"]
mod occluded;
mod paint;
mod screen;

use occluded::{OCCLUDED, occluded_scene};
use paint::{BRIGHT, assert_shown};
use screen::{Screen, Win};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Rgb8Image, exr};
use splitsum::experiment::axis::{AXES, AxisId, Named, PREFILTER_BY, Part, SCENE};
use splitsum::experiment::value::Kind;
use splitsum::instrument::precompute::PrefilterBy;
use splitsum::instrument::shade::{DIFFUSE, METHODS};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_splitsum"))
}

/// Whether a control offers more than one value: files are typed.
fn has_choice(axis: AxisId) -> bool {
    match AXES[axis].kind {
        Kind::Input => false,
        Kind::NameOrFile { names, .. } => names().len() > 1,
        _ => true,
    }
}

/// A small state with a short reference.
const SMALL: [&str; 6] = [
    "--size",
    "128x128",
    "--environment",
    "builtin:studio",
    "--perceptual-roughness",
    "0.4",
];

fn png(path: &Path) -> Rgb8Image {
    let image = image::open(path).unwrap().to_rgb8();
    let (width, height) = image.dimensions();
    Rgb8Image::new(width, height, image.pixels().map(|pixel| pixel.0).collect())
}

/// Runs the commands that a window saved, in its folder.
fn render_again(folder: &Path) {
    let text = std::fs::read_to_string(folder.join("render.sh")).unwrap();
    for line in text
        .lines()
        .filter_map(|line| line.strip_prefix("splitsum "))
    {
        let words = line.split(' ').map(|word| word.replace('\'', ""));
        let output = program().current_dir(folder).args(words).output().unwrap();
        assert!(
            output.status.success(),
            "{line}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

/// Saves the state of the window and compares both linear images with the output of the saved
/// `render` commands, bit for bit.
fn save_and_render(win: &Win, number: u32) -> Rgb8Image {
    win.key("ctrl+s");
    let folder = win.dir().join(format!("view-{number}"));
    let end = format!("view-{number}");
    win.wait("the saved state", |report| {
        report["notice"]
            .as_str()
            .is_some_and(|notice| notice.starts_with("Saved") && notice.ends_with(&end))
    });
    render_again(&folder);
    for side in ["left", "right"] {
        let [shown, again] = ["", "-again"].map(|end| {
            exr::read(&folder.join(format!("{side}{end}.exr")))
                .unwrap()
                .rgb
        });
        assert!(shown.data.iter().flatten().any(|x| *x > 0.0));
        let bits = |image: &splitsum::base::pixels::RgbImage| {
            image
                .data
                .as_flattened()
                .iter()
                .map(|x| x.to_bits())
                .collect::<Vec<_>>()
        };
        assert!(
            bits(&shown) == bits(&again),
            "{side} of view-{number} is not what render makes"
        );
    }
    png(&folder.join("picture.png"))
}

#[test]
fn the_window_shows_and_saves_the_images_of_render() {
    let Some(screen) = Screen::open() else { return };
    let win = screen.window(&[&SMALL[..], &["--right", "sampled", "--samples", "8"]].concat());
    win.few_samples();
    win.wait_done();
    let picture = save_and_render(&win, 1);
    assert_shown(&win, &picture, BRIGHT);
    // The halves equal `render`'s; the left one's display image too.
    let folder = win.dir().join("view-1");
    let text = std::fs::read_to_string(folder.join("render.sh")).unwrap();
    let left = text
        .lines()
        .find(|line| line.contains("left-again"))
        .unwrap()
        .replace("left-again.exr", "left.png");
    let words: Vec<&str> = left.split(' ').skip(1).collect();
    assert!(
        program()
            .current_dir(&folder)
            .args(&words)
            .status()
            .unwrap()
            .success()
    );
    let left = png(&folder.join("left.png"));
    assert!(
        (0..64).all(|x| (0..128).all(|y| left.get(x, y) == picture.get(x, y))),
        "the left half"
    );

    // Another view: turned camera, turned light, nearer; the command lines carry them.
    let before = win.state();
    win.drag("image", [0.4, 0.5], [0.6, 0.6], None);
    win.drag("image", [0.4, 0.5], [0.6, 0.5], Some("shift"));
    win.wheel("image", 3);
    let after = win.state();
    assert_ne!(before["orbit"], after["orbit"]);
    assert!(
        after["orbit"][2].as_f64().unwrap() < 1.125,
        "the wheel zooms: {}",
        after["orbit"]
    );
    assert_ne!(
        before["axes"]["environment_rotation_deg"],
        after["axes"]["environment_rotation_deg"]
    );
    win.wait_done();
    save_and_render(&win, 2);

    // The saved command opens the same state.
    let folder = win.dir().join("view-2");
    let text = std::fs::read_to_string(folder.join("view.sh")).unwrap();
    win.close();
    let words: Vec<String> = text
        .lines()
        .last()
        .unwrap()
        .split(' ')
        .skip(2)
        .map(|word| word.replace('\'', ""))
        .collect();
    let again = screen.window(&words.iter().map(String::as_str).collect::<Vec<_>>());
    again.wait_done();
    assert_eq!(again.state(), after);
    again.close();
}

#[test]
fn keys_work_as_in_the_report() {
    let Some(screen) = Screen::open() else { return };
    let win = screen.window(&SMALL);
    win.few_samples();
    win.wait_done();
    let picture = |win: &Win| win.state()["picture"].as_str().unwrap().to_owned();
    for (key, name) in [("e", "error"), ("s", "signed error"), ("s", "image")] {
        win.key(key);
        assert_eq!(picture(&win), name, "{key}");
        win.wait_done();
    }
    let exposure = |win: &Win| {
        win.state()["axes"]["exposure"]
            .as_str()
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    win.key("bracketright");
    assert!((exposure(&win) - 2f64.sqrt()).abs() < 1e-9);
    win.key("bracketleft");
    assert_eq!(exposure(&win), 1.0);
    win.key("d");
    assert_eq!(win.state()["wipe"], 1.0);
    win.key("Right");
    win.key("Up");
    assert_eq!(win.state()["orbit"], serde_json::json!([5.0, 5.0, 1.125]));
    win.key("0");
    assert_eq!(win.state()["orbit"], serde_json::json!([0.0, 0.0, 1.125]));
    win.key("1");
    assert_eq!(win.state()["axes"]["method"], METHODS[0].name);
    win.wait_done();
    // Space shows the other half, as long as it is down.
    let one = win.picture();
    win.hold("space", true);
    let other = win.picture();
    win.hold("space", false);
    assert!(one.data != other.data && win.picture().data == one.data);
    // Drags the wipe by any point of its line.
    win.key("d");
    for (height, to) in [(0.5, 6.0), (0.25, -5.0)] {
        win.drag("wipe", [0.5, height], [to, height], None);
        let state = win.state();
        let moved = state["wipe"].as_f64().unwrap() - 0.5;
        assert!(
            if to > 1.0 { moved > 0.05 } else { moved < 0.05 },
            "{moved}"
        );
        assert_eq!(
            state["orbit"],
            serde_json::json!([0.0, 0.0, 1.125]),
            "the line is above the camera"
        );
    }
    win.close();
}

#[test]
fn every_control_moves_its_axis() {
    let Some(screen) = Screen::open() else { return };
    let method = METHODS
        .iter()
        .find(|method| method.uses_lod_bias && method.uses_point_set)
        .unwrap()
        .name;
    // These methods read all tables, made of samples, so that their controls are in use.
    let right = METHODS
        .iter()
        .find(|method| method.uses_prefiltered() && method.uses_bend)
        .unwrap()
        .name;
    let diffuse = DIFFUSE
        .iter()
        .find(|diffuse| diffuse.uses_irradiance_map)
        .unwrap()
        .name;
    let folder = occluded_scene();
    let scene = folder.path().join(OCCLUDED);
    let win = screen.window(
        &[
            &[
                "--size",
                "32x32",
                "--scene",
                scene.to_str().expect("a path in UTF-8"),
                "--environment",
                "builtin:constant",
                "--method",
                method,
                "--right",
                right,
            ][..],
            &["--metallic", "0.5"],
            &[
                "--diffuse",
                diffuse,
                "--prefilter",
                PrefilterBy::Sampled.name(),
                "--prefilter-sample-count",
                "16",
            ],
            &[
                "--dfg-sample-count",
                "16",
                "--irradiance-sample-count",
                "8x8",
            ],
        ]
        .concat(),
    );
    win.few_samples();
    win.resize(1200, 2500);
    win.wait_done();
    win.choose("environment", "choice builtin:sky");
    assert_eq!(win.state()["axes"]["environment"], "builtin:sky");
    win.wait_done();
    let mut moved = BTreeSet::new();
    // Controls of the scene and of how tables are computed come last: they determine which of the
    // others are in use.
    let is_way =
        |index: AxisId| AXES[index].part == Part::Method || [PREFILTER_BY, SCENE].contains(&index);
    let (ways, others): (Vec<AxisId>, Vec<AxisId>) = AXES
        .ids()
        .filter(|index| has_choice(*index))
        .partition(|&index| is_way(index));
    for index in others.into_iter().chain(ways) {
        let axis = &AXES[index];
        let name = match axis.name {
            "method" => "left",
            "albedo" => "albedo red",
            _ => Named::usual(index).name(),
        };
        let value = |win: &Win| win.state()["axes"][axis.name].clone();
        let before = value(&win);
        let is_pair = matches!(axis.kind, Kind::Pair { .. });
        if is_pair && win.has(name) {
            win.drag(name, [0.5, 0.5], [1.5, 0.5], None);
        } else if win.has(name) {
            // A tenth is the default of one axis.
            win.click(
                name,
                [if axis.name == "ema_factor" { 0.4 } else { 0.1 }, 0.5],
            );
            let current = format!("choice {}", before.as_str().unwrap_or_default());
            let others = win
                .controls()
                .into_iter()
                .filter(|name| name.starts_with("choice ") && *name != current);
            // Selects the topmost other entry: a long list is scrolled.
            if let Some(choice) = others.min_by_key(|choice| win.place(choice)[1] as u32) {
                win.click(&choice, [0.5, 0.5]);
            }
        }
        if value(&win) != before {
            moved.insert(axis.name);
        }
    }
    let all: BTreeSet<&str> = AXES
        .ids()
        .filter(|index| has_choice(*index))
        .map(|index| AXES[index].name)
        .collect();
    let left: Vec<_> = all.difference(&moved).copied().collect();
    assert!(left.is_empty(), "not moved: {left:?}");
    win.close();
}

#[test]
fn an_outdated_picture_is_dimmed_and_errors_keep_the_reference() {
    let Some(screen) = Screen::open() else { return };
    // Tables of another environment take seconds, and a half is dimmed after 250 ms.
    let tables = [
        "--prefilter",
        "sampled",
        "--prefilter-size",
        "512x512",
        "--prefilter-sample-count",
        "512",
    ];
    let win = screen.window(&[&SMALL[..], &["--reference-samples", "256"], &tables].concat());
    win.wait_done();
    let dimmed = || win.report()["dimmed"].as_u64().unwrap();
    let before = dimmed();
    for key in ["e", "e", "s"] {
        win.key(key);
        win.wait("the other picture", |report| {
            assert_eq!(report["reference"], 256, "after {key}");
            report["is_done"] == true && report["asked"] == report["shown"]
        });
    }
    win.choose("environment", "choice builtin:sky");
    win.wait("a dimmed picture", |_| dimmed() > before);
    win.wait_done();
    assert_eq!(win.report()["stale"], serde_json::json!([false, false]));
    win.close();
}

#[test]
fn the_window_shows_what_the_image_is_made_of() {
    let Some(screen) = Screen::open() else { return };
    let win =
        screen.window(&[&SMALL[..], &["--method", "split-sum", "--right", "sampled"]].concat());
    win.wait_done();
    let colors_of = |entry: &str| {
        win.choose("made of", &format!("choice {entry}"));
        win.wait_done();
        let picture = win.picture();
        let [x, y] = [picture.width / 4, picture.height / 2];
        [picture.get(x, y), picture.get(3 * x, y)]
    };
    // The sphere faces the camera a little to the left and right of its middle: red is 0.5 n.x + 0.5.
    let [left, right] = colors_of("normal");
    assert!(
        left[0] < 100 && right[0] > 155 && left[2] > 155,
        "{left:?} {right:?}"
    );
    // Only the split sum reads a prefiltered map.
    let [_, right] = colors_of("prefiltered");
    assert_eq!(right, [0x31, 0x36, 0x3b]);
    win.key("e");
    win.wait_done();
    win.close();
}

#[test]
fn files_are_opened_by_their_paths() {
    let Some(screen) = Screen::open() else { return };
    let win = screen.window(&SMALL);
    let quad = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(win.dir().join("a.obj"), quad).unwrap();
    std::fs::write(
        win.dir().join("b.obj"),
        format!("mtllib b.mtl\nusemtl red\n{quad}"),
    )
    .unwrap();
    std::fs::write(win.dir().join("b.mtl"), "newmtl red\nKd 1 0 0\n").unwrap();
    // A model without materials keeps the window's, one with materials shows them.
    for (name, metallic) in [("a", "1"), ("b", "")] {
        win.click("open scene", [0.5, 0.5]);
        [name, "period", "o", "b", "j", "Return"]
            .into_iter()
            .for_each(|key| win.key(key));
        let axes = win.state()["axes"].clone();
        assert!(
            axes["scene"]
                .as_str()
                .unwrap()
                .ends_with(&format!("{name}.obj"))
                && axes["metallic"] == metallic,
            "{axes}"
        );
    }
    win.wait_done();
    win.close();
}

#[test]
fn faults_of_display_device_and_files_are_reported() {
    let output = program()
        .arg("view")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&output.stderr).contains("no display"),
        "{output:?}"
    );
    let output = program()
        .args(["view", "--environment", "nothing.hdr"])
        .env("DISPLAY", ":4095")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let output = program()
        .arg("view")
        .env("DISPLAY", ":4095")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let Some(screen) = Screen::open() else { return };
    let mut win = screen.started(&SMALL, &[("SPLITSUM_TEST_FAULTS", "submit:60:device-lost")]);
    let (code, message) = win.end();
    assert!(
        code == Some(75) && message.contains("the device was lost"),
        "{code:?}: {message}"
    );

    // After a file that is not a map the window keeps the previous one.
    let mut win = screen.window(&SMALL);
    win.few_samples();
    std::fs::write(win.dir().join("no.hdr"), "no picture").unwrap();
    win.click("open environment", [0.5, 0.5]);
    ["n", "o", "period", "h", "d", "r", "Return"]
        .into_iter()
        .for_each(|key| win.key(key));
    let is_reported = |report: &serde_json::Value| {
        report["notice"]
            .as_str()
            .is_some_and(|text| text.contains("no first line"))
    };
    win.wait("the fault of the file", is_reported);
    win.wait_done();
    assert_eq!(win.state()["axes"]["environment"], "builtin:studio");
    // The window is taken away from the program.
    win.act(&format!("windowclose {}", win.id()));
    let (code, message) = win.end();
    assert!(
        code == Some(75) && message.contains("the window was taken away"),
        "{code:?}: {message}"
    );
}

#[test]
fn random_input_leaves_no_message_and_no_leak() {
    let Some(screen) = Screen::open() else { return };
    let seconds = std::env::var("SPLITSUM_WINDOW_SECONDS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(2);
    let win = screen.window(&[
        "--size",
        "96x96",
        "--environment",
        "builtin:sky",
        "--validation",
        "--paint",
        "swapchain",
    ]);
    win.few_samples();
    win.wait_done();
    // Memory does not grow with the number of pictures of one size. Random input reaches other
    // sizes, too.
    let turn = |count: u64| {
        for _ in 0..count {
            win.key("Right");
            win.wait_done();
        }
        win.memory_kib()
    };
    // A leak shows after every picture, a new arena of some thread once.
    let pictures = (2 * seconds).max(10);
    let memory: Vec<u64> = (0..4).map(|_| turn(pictures)).collect();
    println!("after each {pictures} pictures: {memory:?} KiB");
    let growth = memory
        .windows(2)
        .map(|ends| ends[1].saturating_sub(ends[0]));
    let least = growth.min().expect("three stages");
    // The validation layer remembers each object's name.
    assert!(least <= pictures * 32, "memory grows: {memory:?} KiB");
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = |below: u64| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let keys = "e s t d 0 1 2 4 plus minus Left Up space bracketleft Tab Escape"
        .split(' ')
        .collect::<Vec<_>>();
    let until = Instant::now() + Duration::from_secs(seconds);
    let (mut actions, mut most) = (0, 0);
    while Instant::now() < until {
        let [x, y] = [next(1280), next(790)];
        win.act(&match next(6) {
            0 => format!("key {}", keys[next(keys.len() as u64) as usize]),
            1 => "mousedown 1 mousemove_relative -- 37 -11 mouseup 1".to_owned(),
            2 => ["click 4", "click 5"][next(2) as usize].to_owned(),
            3 => "keydown shift mousedown 1 mousemove_relative -- -23 5 mouseup 1 keyup shift"
                .to_owned(),
            4 => "click 1".to_owned(),
            _ => format!("mousemove --window {} {x} {y}", win.id()),
        });
        (actions, most) = (actions + 1, win.memory_kib().max(most));
        assert!(win.is_alive(), "the window ended");
    }
    println!("random input for {seconds} s: {actions} actions, at most {most} KiB");
    // The exit code is 1 if the validation layer wrote a message.
    win.close();
}
