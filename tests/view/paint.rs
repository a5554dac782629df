//! The ways to paint the window: both show the same pixels, and last as long as the window.

use crate::screen::{Screen, Win};
use crate::{SMALL, save_and_render};
use splitsum::base::pixels::Rgb8Image;

/// Compares the screen with a saved picture of [`SMALL`]: each of its pixels is a square of whole
/// pixels, whose colours are divided by `dimmed`.
pub fn assert_shown(win: &Win, picture: &Rgb8Image, dimmed: u32) {
    let seen = win.picture();
    let zoom = seen.width / picture.width;
    assert!(
        zoom >= 1 && seen.width.is_multiple_of(picture.width),
        "{} pixels on {}",
        picture.width,
        seen.width
    );
    // Clear of the toolbar above, the captions below and the wipe.
    let clear = |x: u32, y: u32| (30..110).contains(&y) && x.abs_diff(64) > 3;
    let all = (0..128).flat_map(|y| (0..128).map(move |x| (x, y)));
    for (x, y) in all.filter(|&(x, y)| clear(x, y)) {
        let color = picture
            .get(x, y)
            .map(|channel| (u32::from(channel) * dimmed / 256) as u8);
        for (dx, dy) in (0..zoom).flat_map(|dy| (0..zoom).map(move |dx| (dx, dy))) {
            assert_eq!(
                seen.get(zoom * x + dx, zoom * y + dy),
                color,
                "({dx}, {dy}) of pixel ({x}, {y})"
            );
        }
    }
}

/// Brightness of a whole and of an outdated picture, of 256.
pub const BRIGHT: u32 = 256;
const DIM: u32 = 96;

const WAYS_TO_PAINT: [&str; 2] = ["swapchain", "cpu"];

/// A small window, painted in one of these ways.
fn painted<'a>(paint: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let own = ["--right", "sampled", "--samples", "8", "--paint", paint];
    [&SMALL[..], &own, more].concat()
}

#[test]
fn both_ways_to_paint_show_the_saved_picture_and_dim_it() {
    let Some(screen) = Screen::open() else { return };
    for paint in WAYS_TO_PAINT {
        let tables = [
            "--prefilter",
            "sampled",
            "--prefilter-size",
            "256x256",
            "--prefilter-sample-count",
            "512",
        ];
        let win = screen.window(&painted(paint, &tables));
        win.few_samples();
        win.wait_done();
        assert_eq!(win.report()["paint"], paint);
        let picture = save_and_render(&win, 1);
        assert_shown(&win, &picture, BRIGHT);
        // Tables of another environment take seconds; until then the last picture is dimmed.
        win.choose("environment", "choice builtin:sky");
        win.wait("a dimmed picture", |report| {
            report["stale"] == serde_json::json!([true, true])
        });
        assert_shown(&win, &picture, DIM);
        win.close();
    }
}

#[test]
fn both_ways_to_paint_stretch_pictures_alike() {
    let Some(screen) = Screen::open() else { return };
    // Coarse pictures of so many samples stay for seconds, and texels are not whole pixels.
    let large = [
        "--size",
        "1000x900",
        "--samples",
        "256",
        "--environment",
        "builtin:studio",
    ];
    let methods = ["--method", "sampled", "--right", "sampled"];
    let [by_device, on_cpu] = WAYS_TO_PAINT.map(|paint| {
        let win = screen.window(&[&large[..], &methods, &["--paint", paint]].concat());
        win.wait("coarse halves", |report| {
            report["scales"] == serde_json::json!([2, 2])
        });
        let seen = win.picture();
        assert_eq!(
            win.report()["scales"],
            serde_json::json!([2, 2]),
            "the picture came too soon"
        );
        win.close();
        seen
    });
    assert_eq!(
        [by_device.width, by_device.height],
        [on_cpu.width, on_cpu.height]
    );
    // Clear of the toolbar, the captions and the wipe.
    let [width, height] = [by_device.width, by_device.height];
    let rows = height / 4..height * 3 / 4;
    let clear = |x: &u32| x.abs_diff(width / 2) > 15;
    for (x, y) in rows.flat_map(|y| (0..width).filter(clear).map(move |x| (x, y))) {
        assert_eq!(by_device.get(x, y), on_cpu.get(x, y), "pixel ({x}, {y})");
    }
}

#[test]
fn a_window_survives_resizes_icons_and_lost_surfaces() {
    let Some(screen) = Screen::open() else { return };
    let faults = "present:4:surface-lost,present:7:out-of-date,present:20:surface-lost";
    for paint in WAYS_TO_PAINT {
        let win = screen.window_with(
            &painted(paint, &["--validation"]),
            &[("SPLITSUM_TEST_FAULTS", faults)],
        );
        win.few_samples();
        for (width, height) in [(900, 500), (1270, 1400), (820, 700)] {
            win.resize(width, height);
        }
        win.minimise_and_restore();
        win.resize(1000, 800);
        win.key("Right");
        win.wait_done();
        assert_eq!(win.report()["paint"], paint);
        assert!(win.report()["frames"].as_u64().unwrap() > 25);
        let picture = save_and_render(&win, 1);
        assert_shown(&win, &picture, BRIGHT);
        // The exit code is 1 if the validation layer wrote a message.
        win.close();
    }
    // A surface that is lost again at once is not made for ever.
    let faults = "present:4:surface-lost,present:5:surface-lost";
    let mut win = screen.started(
        &painted("swapchain", &[]),
        &[("SPLITSUM_TEST_FAULTS", faults)],
    );
    let (code, message) = win.end();
    assert!(
        code == Some(75) && message.contains("the window's surface was lost"),
        "{code:?}: {message}"
    );
}

#[test]
fn a_device_that_cannot_present_paints_on_the_cpu_and_says_so() {
    let Some(screen) = Screen::open() else { return };
    let win = screen.window_with(
        &painted("swapchain", &["--validation"]),
        &[("SPLITSUM_TEST_FAULTS", "surface:1:not-present")],
    );
    let report = win.report();
    assert_eq!(report["paint"], "cpu");
    let line = report["notice"].as_str().unwrap().to_owned();
    assert!(
        line.contains("cannot present in this window")
            && line.ends_with("the window is painted on the CPU"),
        "{line}"
    );
    win.few_samples();
    win.wait_done();
    let picture = save_and_render(&win, 1);
    assert_shown(&win, &picture, BRIGHT);
    let logged = win.close();
    assert_eq!(logged.matches(&line).count(), 1, "{logged}");
}
