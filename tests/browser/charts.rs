//! Charts: what is saved is what is shown, axes that can be read and compared, intervals that do not end where they do not.

use crate::chromium::{self, Page};
use crate::fake::Log;
use crate::fixture::assert_clean;
use crate::joined::{joined, texts};
use crate::sections::{report_of, run_of, wait_for_figures};
use image::RgbImage;
use serde_json::{Value, json};
use splitsum::runner::statistics::median;
use splitsum::study::answers::run_folder::RunFolder;
use splitsum::study::report::{ReportOptions, write};
use std::path::Path;

/// Five series, of which one has crosses; counts so few that sampling never wins, which arrows say; times, whose front has rings.
const MARKS: &str = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.05, 0.1, 0.25, 0.5, 1]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 2, 4]";
const TIMING: &str = "[timing]\nwarmup = 1\nrounds = 9";

/// The text of the file that the button `SVG` of a figure saves.
fn saved_svg(page: &mut Page, figure: &str) -> String {
    let script = format!(
        "(() => {{ const make = URL.createObjectURL; let saved; URL.createObjectURL = (blob) => {{ saved = blob; return 'data:,'; }}; \
         [...document.querySelectorAll('[data-figure^=\"{figure}\"] .figure-tools button')].find((b) => b.textContent === 'SVG').click(); \
         URL.createObjectURL = make; return saved.text(); }})()"
    );
    page.eval(&script).as_str().unwrap().to_owned()
}

/// What a browser shows of a rectangle of the page in CSS pixels.
fn seen(page: &mut Page, place: &Value) -> RgbImage {
    let bytes = page.capture([0, 1, 2, 3].map(|i| place[i].as_f64().unwrap()));
    image::load_from_memory(&bytes).unwrap().to_rgb8()
}

/// The share of the ink of `a` that has no like within a pixel in `b`; ink is what is not the paper in the corner.
fn missing_ink(a: &RgbImage, b: &RgbImage) -> f64 {
    let distance = |x: [u8; 3], y: [u8; 3]| x.iter().zip(y).map(|(x, y)| x.abs_diff(y)).max().unwrap();
    let paper = a.get_pixel(0, 0).0;
    let (mut ink, mut missing) = (0.0, 0.0);
    for (x, y, texel) in a.enumerate_pixels().filter(|(_, _, texel)| distance(texel.0, paper) > 48) {
        let (xs, ys) =
            (x.saturating_sub(1)..=(x + 1).min(b.width() - 1), y.saturating_sub(1)..=(y + 1).min(b.height() - 1));
        let is_there = ys.into_iter().any(|v| xs.clone().any(|u| distance(b.get_pixel(u, v).0, texel.0) <= 64));
        ink += 1.0;
        missing += f64::from(!is_there);
    }
    missing / ink
}

#[test]
fn a_saved_drawing_shows_what_the_page_shows() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), MARKS, TIMING);
    for (scheme, figure, kind) in [
        ("light", "convergence", "path.dot"),
        ("light", "time-error", "circle.dot[fill=none]"),
        ("dark", "equal-time-intervals", "path.dot"),
        ("light", "break-even", ".cell rect"),
        ("light", "n-dot-v", "polygon.dot"),
    ] {
        page.resize(1440, 2600, scheme);
        page.go(&report, "#plots");
        wait_for_figures(&mut page);
        let svg = format!("document.querySelector('[data-figure^=\"{figure}\"] .stage svg')");
        assert!(
            page.eval(&format!("{svg}.querySelectorAll('{kind}').length")).as_u64().unwrap() > 0,
            "{figure}: {kind}"
        );
        let place = page.eval(&format!(
            "(() => {{ const b = {svg}.getBoundingClientRect(); return [Math.round(b.left), Math.round(b.top), Math.floor(b.width), Math.floor(b.height)]; }})()"
        ));
        let shown = seen(&mut page, &place);
        let title = page.text(&format!("[data-figure^=\"{figure}\"] h2"));
        let entries = texts(&mut page, &format!("[data-figure^=\"{figure}\"] .legend li"));
        let file = saved_svg(&mut page, figure);
        for page_only in ["var(", " style=", " class=", "tabindex"] {
            assert!(!file.contains(page_only), "{figure} has {page_only}");
        }
        let path = dir.path().join("saved.svg");
        std::fs::write(&path, &file).unwrap();
        let wrapper = dir.path().join("saved.html");
        std::fs::write(
            &wrapper,
            "<body data-ready=\"0\" style=\"margin:0\"><img src=\"saved.svg\" style=\"display:block\">",
        )
        .unwrap();
        page.go(&wrapper, "");
        page.wait("document.images[0].complete && document.images[0].naturalWidth > 0");
        // The drawing's own coordinates begin below the title.
        let top = -file.split("viewBox=\"0 ").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
        let saved = seen(&mut page, &json!([0, top, place[2], place[3]]));
        let differing = [missing_ink(&shown, &saved), missing_ink(&saved, &shown)];
        assert!(differing.iter().all(|share| *share < 0.02), "{figure}: {differing:?}");
        assert!(file.contains(&format!("<title>{title}</title>")), "{figure}: {title}");
        let is_written =
            |text: &String| file.contains(&text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;"));
        assert!(!entries.is_empty() && entries.iter().all(is_written), "{figure}: {entries:?}");
    }
    assert_clean(&page);
}

/// A chart made by the page's own module.
const CHART: &str = "const { xy } = await import('report/chart'); const make = (x, y, marks, width = 600) => { const svg = xy({ x, y, marks })(width, 300, document.createElement('div')); document.body.append(svg); return svg; }; \
                     const labels = (svg, anchor) => [...svg.querySelectorAll(`.tick[text-anchor=${anchor}]`)].map((t) => t.textContent);";

#[test]
fn intervals_leave_the_frame_openly_and_axes_have_labels_at_their_ends() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), MARKS, TIMING);
    page.resize(1440, 900, "light");
    page.go(&report, "#plots");
    // One whisker within, one that leaves below, one that leaves on both sides.
    let drawn = page.eval(&format!(
        "(async () => {{ {CHART} const dot = (x, ys) => ({{ x, y: 1, ys }}); \
         const svg = make({{ label: 'x', domain: [0, 4] }}, {{ label: 'y', log: true, domain: [0.1, 10] }}, \
           [{{ color: '#f00', dots: [dot(1, [0.5, 2]), dot(2, [1e-9, 2]), dot(3, [1e-9, 1e9])] }}]); \
         const lines = [...svg.querySelectorAll('g > line[opacity]')].map((line) => ['y1', 'y2'].map((name) => Math.round(line.getAttribute(name)))); \
         return [svg.querySelectorAll('.open-end').length, lines]; }})()"
    ));
    // The frame reaches from 10 to 258.
    assert_eq!(drawn[0], json!(3));
    let inner = |y: &Value| (11..258).contains(&y.as_i64().unwrap());
    let ends: Vec<[bool; 2]> =
        drawn[1].as_array().unwrap().iter().map(|line| [inner(&line[0]), inner(&line[1])]).collect();
    assert_eq!(ends, [[true, true], [false, true], [false, false]], "{drawn}");
    let ticks = page.eval(&format!(
        "(async () => {{ {CHART} const counts = [1, 2, 4, 8, 16, 32, 40, 64]; \
         const svg = make({{ label: 'x', log: true, domain: [0.8, 70], ticks: counts, format: String }}, {{ label: 'y', log: true, domain: [0.045, 0.18] }}, [], 300); \
         return [labels(svg, 'middle'), labels(svg, 'end')]; }})()"
    ));
    assert_eq!([&ticks[0][0], ticks[0].as_array().unwrap().last().unwrap()], [&json!("1"), &json!("64")], "{ticks}");
    let largest =
        ticks[1].as_array().unwrap().iter().map(|t| t.as_str().unwrap().parse::<f64>().unwrap()).fold(0.0, f64::max);
    assert!(largest > 0.12, "{ticks}");
    // Near the threshold a value has the digits that say on which side it lies.
    let flips = page.eval("import('report/visibility').then(({ flipText }) => [0.0496, 0.0501, 0.0512, 0.31].map((flip) => flipText(flip, 0.05)))");
    assert_eq!(flips, json!(["0.0496", "0.050", "0.051", "0.31"]));
    // Labels of columns are whole, and stand above the cells and below the title.
    let overlaps = page.eval(
        "(async () => { const { mapped } = await import('report/maps'); const columns = Array.from({ length: 9 }, (_, i) => `studio · phong · 128x12${i}`); \
         const map = mapped({ rows: ['1', '2'], columns, rowTitle: 'a', columnTitle: 'title', cell: () => ({ text: '16', color: '#fff', ink: '#000', title: '' }) }); \
         return [360, 648, 1600].map((width) => { const height = map.height(width), svg = map.draw(width, height, document.createElement('div')); \
           svg.setAttribute('width', width); svg.setAttribute('height', height); document.body.append(svg); \
           const frame = svg.getBoundingClientRect(), title = svg.querySelector('.axis + .axis').getBoundingClientRect(), cells = svg.querySelector('.cell').getBoundingClientRect(); \
           const labels = [...svg.querySelectorAll('.tick')].filter((t) => t.getAttribute('text-anchor') !== 'end'), boxes = labels.map((t) => t.getBoundingClientRect()); \
           const words = labels.map((t) => t.textContent).join(' '); svg.remove(); \
           return boxes.filter((b) => b.top < title.bottom - 2 || b.bottom > cells.top + 2 || b.left < frame.left || b.right > frame.right).length + (columns.every((c) => c.split(' · ').every((part) => words.includes(part))) ? 0 : 100); }); })()",
    );
    assert_eq!(overlaps, json!([0, 0, 0]));
    assert_clean(&page);
}

#[test]
fn panels_of_runs_have_the_same_axes() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let (_, report) = joined(dir.path());
    page.resize(1440, 900, "light");
    page.go(&report, "");
    page.wait("document.querySelectorAll('#lead-chart .figure .stage svg').length === 3");
    let ticks: Vec<Vec<String>> =
        (1..=3).map(|run| texts(&mut page, &format!("[data-figure=\"break-even-curves-run-{run}\"] .tick"))).collect();
    assert!(ticks[0].len() > 4 && ticks[0] == ticks[1] && ticks[1] == ticks[2], "{ticks:?}");
}

#[test]
fn effects_of_runs_have_the_same_axes() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let run = |name: &str, counts: &str, biases: &str| {
        let axes = format!(
            "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\"]\nsamples = [{counts}]\nlod_bias = [{biases}]"
        );
        run_of(&dir.path().join(name), &axes, "", Log::default())
    };
    // Other values, and other counts, so that each alone would have axes of its own.
    let dirs = vec![run("few", "4", "0, 1, 2"), run("many", "4, 64", "0, -4, 8")];
    let options = ReportOptions {
        dirs: dirs.clone(),
        out: Some(dir.path().join("joined.html")),
        ..ReportOptions::of_run(&dirs[0])
    };
    let report = write(&options).unwrap().path;
    page.resize(1440, 900, "light");
    page.go(&report, "");
    wait_for_figures(&mut page);
    let ticks = [1, 2].map(|run| texts(&mut page, &format!("[data-figure=\"effects-lod_bias-run-{run}\"] .tick")));
    assert!(
        ticks[0] == ticks[1] && ticks[0].contains(&"−4".to_owned()) && ticks[0].contains(&"8".to_owned()),
        "{ticks:?}"
    );
    assert_clean(&page);
}

#[test]
fn bars_are_as_long_as_the_frames_median() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let report = report_of(dir.path(), MARKS, TIMING);
    let run = RunFolder::read(report.parent().unwrap()).unwrap();
    let frames = run.timings.iter().filter(|record| record.phase == "frame");
    let mut wanted: Vec<f64> = frames.map(|record| median(&record.sums_ms())).collect();
    page.resize(1440, 900, "light");
    page.go(&report, "#plots");
    wait_for_figures(&mut page);
    let labels = texts(&mut page, "[data-figure=\"passes-frame\"] .tick:not([text-anchor])");
    let mut shown: Vec<f64> = labels.iter().map(|text| text.strip_suffix(" ms").unwrap().parse().unwrap()).collect();
    wanted.sort_by(f64::total_cmp);
    shown.sort_by(f64::total_cmp);
    assert!(
        shown.len() == wanted.len() && shown.iter().zip(&wanted).all(|(a, b)| (a / b - 1.0).abs() < 0.01),
        "{shown:?} {wanted:?}"
    );
    // The table of paybacks fits, and its answer is in sight.
    for width in [390, 1440] {
        page.resize(width, 900, "light");
        page.go(&report, "#plots");
        wait_for_figures(&mut page);
        let room = page.eval(
            "(() => { const box = document.querySelector('.payback-table .scroll'), cell = box.querySelector('td.payback').getBoundingClientRect(); \
             return [box.scrollWidth - box.clientWidth, box.getBoundingClientRect().right - cell.right]; })()",
        );
        assert!(room[0].as_f64().unwrap() <= 0.0 && room[1].as_f64().unwrap() >= 0.0, "{width}: {room}");
    }
    assert_clean(&page);
}

fn legend_of(axes: &str, figure: &str, page: &mut Page, dir: &Path) -> Vec<String> {
    let report = report_of(dir, axes, "");
    page.resize(1440, 900, "light");
    page.go(&report, "#plots");
    wait_for_figures(page);
    texts(page, &format!("[data-figure^=\"{figure}\"] .legend li"))
}

#[test]
fn profiles_show_methods_without_samples_and_few_pairs_stand_by_name() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.1]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 2, 3, 4, 5, 6, 7, 8, 9]";
    let lines = legend_of(axes, "n-dot-v", &mut page, &dir.path().join("profile"));
    assert_eq!(lines.len(), 7, "{lines:?}");
    assert_eq!([lines[0].as_str(), lines[1].as_str(), lines[6].as_str()], ["split-sum", "sampled 1", "sampled 9"]);
    let axes = "environment = [\"builtin:constant\", \"builtin:sky\", \"builtin:studio\"]\nbrdf = [\"ggx\"]\nalpha = [0.1]\nmethod = [\"sampled\", \"sampled-unfiltered\"]\nsamples = [4]";
    legend_of(axes, "effects-method", &mut page, &dir.path().join("pairs"));
    let named = texts(&mut page, "[data-figure=\"effects-method\"] svg .mark");
    assert!(["constant", "sky", "studio"].iter().all(|name| named.iter().any(|text| text == name)), "{named:?}");
    assert_eq!(page.eval("document.querySelectorAll('[data-figure=\"effects-method\"] circle.dot').length"), json!(4));
    assert_clean(&page);
}
