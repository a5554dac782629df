//! Speeds from a few seconds of work on the device: small images of each method at two sample counts, the tables with few samples, a short
//! reference, the scores of one cell.

use super::items::{image_kind, reference_kind, table_kind};
use super::records::mean_bytes;
use super::speeds::{Amount, Line, Speeds};
use crate::pipeline::{Frame, RenderRequest};
use crate::precompute::{PrecomputeSettings, table_of};
use crate::runner::axis::{Point, SIZE};
use crate::runner::images;
use crate::runner::plan::{Cell, Plan};
use crate::runner::renderer::{RenderFault, Renderer};
use crate::runner::scoring::{ReferenceImage, Rendered, ScoreFault};
use crate::runner::store::{Store, StoreError};
use crate::runner::value::Value;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Most pixels of a probe's image.
const PIXELS_MAX: f64 = 16384.0;
/// Most samples of a probe's image or table.
const SAMPLES_MAX: f64 = 4e6;
/// Samples a pixel of the references that are compared: fewer, and more.
const REFERENCE_SAMPLES: [u32; 2] = [64, 512];
/// A reference that stops by its error is rendered as it will be, with this side at most.
const SIDE_MAX: f64 = 48.0;

/// What was measured so far.
struct Probe<'p> {
    plan: &'p Plan,
    renderer: &'p mut dyn Renderer,
    measured: Vec<(String, Amount, f64)>,
    /// First renders, which pay for compiling their shaders.
    first_s: f64,
}

/// Measures what the cells of a plan will cost on a renderer that took `opened_s` to open.
pub fn probe(plan: &Plan, renderer: &mut dyn Renderer, opened_s: f64) -> Result<Speeds, RenderFault> {
    let mut probe = Probe { plan, renderer, measured: Vec::new(), first_s: 0.0 };
    let mut kinds: BTreeMap<String, Vec<&Cell>> = BTreeMap::new();
    for cell in &plan.cells {
        kinds.entry(image_kind(&cell.point)).or_default().push(cell);
    }
    let (mut references, mut baked) = (Vec::new(), Vec::new());
    let mut files = Vec::new();
    for (kind, cells) in &kinds {
        // The middle of the sweep stands for all of it.
        let cell = cells[cells.len() / 2];
        let brdf = cell.point.settings().brdf.name();
        if !baked.contains(&(brdf, cell.point.settings().method.uses_prefiltered)) {
            baked.push((brdf, cell.point.settings().method.uses_prefiltered));
            probe.tables(&cell.point)?;
        }
        let counts: Vec<u32> = cells.iter().map(|cell| cell.point.settings().samples).collect();
        let frame = probe.images(kind, &cell.point, &counts)?;
        let reference = reference_kind(&plan.reference_point(&cell.point));
        if !references.contains(&reference) {
            probe.references(&reference, &cell.point)?;
            references.push(reference);
        }
        files.extend(probe.scores(cell, frame)?);
    }
    let mut speeds = Speeds::fit(&probe.measured);
    speeds.set("start", Line { fixed: opened_s + probe.first_s, ..Line::default() });
    mean_bytes(&files).into_iter().for_each(|(kind, line)| speeds.set(kind, line));
    Ok(speeds)
}

impl Probe<'_> {
    /// The point with an image of at most so many pixels.
    fn small(point: &Point, pixels_max: f64) -> Point {
        let size = point.settings().size.map(f64::from);
        let scale = (pixels_max / (size[0] * size[1])).sqrt().min(1.0);
        let mut small = point.clone();
        small[SIZE] = Value::Pair(size.map(|side| ((side * scale).round() as u32).max(1)));
        small
    }

    /// The request of a small image, with tables of few samples.
    fn request(&self, point: &Point) -> RenderRequest {
        let request = self.plan.request(&Self::small(point, PIXELS_MAX));
        RenderRequest {
            precompute: few_samples(&request.precompute),
            reference_samples: REFERENCE_SAMPLES[0],
            ..request
        }
    }

    fn timed(&mut self, request: &RenderRequest) -> Result<(Frame, f64), RenderFault> {
        let started = Instant::now();
        let frame = self.renderer.render(request)?;
        Ok((frame, started.elapsed().as_secs_f64()))
    }

    fn tables(&mut self, point: &Point) -> Result<(), RenderFault> {
        let request = self.request(point);
        let timed = self.renderer.time_precompute(&request, 1, 1)?;
        let image = &request.environment.image;
        let texels = f64::from(image.width) * f64::from(image.height);
        let mut tables: BTreeMap<&str, f64> = BTreeMap::new();
        for (pass, ms) in &timed.passes {
            *tables.entry(table_of(pass)).or_default() += ms.iter().sum::<f64>();
        }
        for (table, ms) in tables {
            let samples = request.precompute.samples_of(table).unwrap_or(texels);
            let kind = table_kind(table, request.brdf.name());
            self.measured.push((kind, Amount { pixels: 0.0, samples }, ms / 1e3));
        }
        Ok(())
    }

    /// Renders the fewest and the most of these sample counts, each twice: the faster counts.
    fn images(&mut self, kind: &str, point: &Point, counts: &[u32]) -> Result<Frame, RenderFault> {
        let request = self.request(point);
        let pixels = f64::from(request.size[0]) * f64::from(request.size[1]);
        let most = ((SAMPLES_MAX / pixels) as u32).max(1);
        let ends = [counts.iter().min(), counts.iter().max()].map(|count| count.map_or(1, |count| (*count).min(most)));
        let (mut frame, first_s) = self.timed(&RenderRequest { samples: ends[0], ..request.clone() })?;
        let mut fastest_s = f64::INFINITY;
        for samples in ends {
            // As `cost::amount` counts.
            let specular = if request.method.uses_samples { samples } else { 1 };
            let diffuse = if request.diffuse.is_reference() { request.reference_samples } else { 0 };
            let amount = Amount { pixels, samples: pixels * f64::from(specular + diffuse) };
            let request = RenderRequest { samples, ..request.clone() };
            let is_reference = request.method.is_reference();
            let request = RenderRequest {
                reference_samples: if is_reference { samples } else { request.reference_samples },
                ..request
            };
            let (_, one) = self.timed(&request)?;
            let (rendered, two) = self.timed(&request)?;
            (frame, fastest_s) = (rendered, fastest_s.min(one.min(two)));
            self.measured.push((kind.to_owned(), amount, one.min(two)));
            if ends[0] == ends[1] {
                break;
            }
        }
        self.first_s += (first_s - fastest_s).max(0.0);
        Ok(frame)
    }

    fn references(&mut self, kind: &str, point: &Point) -> Result<(), RenderFault> {
        let of = |pixels_max: f64| {
            let point = self.plan.reference_point(&Self::small(point, pixels_max));
            // Not the count of the point, which has none where only the diffuse term is drawn.
            let nominal = self.plan.config.reference.samples;
            let request = self.plan.reference_request(&point);
            let pixels = f64::from(request.size[0]) * f64::from(request.size[1]);
            let terms =
                f64::from(u8::from(request.method.uses_samples) + u8::from(request.diffuse.is_reference())).max(1.0);
            (RenderRequest { precompute: few_samples(&request.precompute), ..request }, nominal, pixels, terms)
        };
        let (request, nominal, pixels, terms) = of(PIXELS_MAX);
        let few = RenderRequest {
            reference_samples: REFERENCE_SAMPLES[0],
            samples: REFERENCE_SAMPLES[0],
            reference_error: None,
            ..request.clone()
        };
        let (_, first_s) = self.timed(&few)?;
        self.first_s += first_s;
        if request.reference_error.is_some() && request.has_reference_term() {
            let (request, nominal, pixels, terms) = of(SIDE_MAX * SIDE_MAX);
            let (_, seconds) = self.timed(&request)?;
            // Counted as if it took all the samples it may: how early it stops is in the speed.
            let samples = pixels * f64::from(nominal) * terms;
            self.measured.push((kind.to_owned(), Amount { pixels, samples }, seconds));
            return Ok(());
        }
        for samples in REFERENCE_SAMPLES.map(|samples| samples.min(nominal)) {
            let request = RenderRequest { reference_samples: samples, samples, ..request.clone() };
            let (_, seconds) = self.timed(&request)?;
            self.measured.push((
                kind.to_owned(),
                Amount { pixels, samples: pixels * f64::from(samples) * terms },
                seconds,
            ));
        }
        Ok(())
    }

    /// Scores a cell in a folder of its own; returns kind, pixels and bytes of its files.
    fn scores(&mut self, cell: &Cell, frame: Frame) -> Result<Vec<(&'static str, f64, f64)>, RenderFault> {
        let fault = |error: &dyn std::fmt::Display| RenderFault {
            message: format!("the probe: {error}"),
            device_lost: false,
            is_input: false,
        };
        let point = self.plan.reference_point(&Self::small(&cell.point, PIXELS_MAX));
        let request = self.plan.reference_request(&point);
        let (reference, _) = self.timed(&RenderRequest {
            reference_samples: REFERENCE_SAMPLES[0],
            samples: REFERENCE_SAMPLES[0],
            reference_error: None,
            precompute: few_samples(&request.precompute),
            ..request
        })?;
        let pixels =
            Amount { pixels: f64::from(frame.radiance.width) * f64::from(frame.radiance.height), samples: 0.0 };
        let curve = cell.point.settings().curve;
        let started = Instant::now();
        let test = Arc::new(self.renderer.tonemap(&frame.radiance, curve)?);
        self.measured.push(("display".to_owned(), pixels, started.elapsed().as_secs_f64()));
        let shown = Arc::new(self.renderer.tonemap(&reference.radiance, curve)?);

        let dir = tempfile::tempdir().map_err(|error| fault(&error))?;
        let store = Store::own(dir.path()).map_err(|error| fault(&error))?;
        let [linear, of_reference] = images::linear_files(self.plan, cell);
        images::write_radiance(&store.image_path(&of_reference), &reference).map_err(|error| fault(&error))?;
        let started = Instant::now();
        images::write_radiance(&store.image_path(&linear), &frame).map_err(|error| fault(&error))?;
        let rendered = Rendered {
            cell,
            frame: Arc::new(frame),
            reference: Arc::new(ReferenceImage::of_frame(Arc::new(reference), None)),
            pictures: [test, shown],
            bias_variance: None,
            linear: Arc::new(OnceLock::new()),
        };
        let device = self.renderer.device();
        let score = || {
            rendered.score(self.plan, &store, &device).map_err(|error| match error {
                ScoreFault::Cell(reason) => fault(&reason),
                ScoreFault::Store(error) => fault(&error),
            })
        };
        let record = score()?;
        self.measured.push(("score first".to_owned(), pixels, started.elapsed().as_secs_f64()));
        let started = Instant::now();
        score()?;
        self.measured.push(("score again".to_owned(), pixels, started.elapsed().as_secs_f64()));
        store.write_cell(&record).map_err(|error: StoreError| fault(&error))?;
        let length = |path: &std::path::Path| std::fs::metadata(path).map_or(0.0, |metadata| metadata.len() as f64);
        let mut files = vec![("bytes record", 0.0, length(&store.cell_path(&cell.id)))];
        for name in images::files(self.plan, cell) {
            let kind = super::items::file_kind(&name, name == of_reference);
            files.push((kind, pixels.pixels, length(&store.image_path(&name))));
        }
        Ok(files)
    }
}

/// The same tables from few samples.
fn few_samples(settings: &PrecomputeSettings) -> PrecomputeSettings {
    let mut few = *settings;
    let share = |pass: &str| (SAMPLES_MAX / settings.samples_of(pass).unwrap_or(1.0)).min(1.0);
    let fewer = |count: u32, share: f64| ((f64::from(count) * share) as u32).max(1);
    few.prefilter_sample_count = fewer(few.prefilter_sample_count, share("prefilter"));
    few.dfg_sample_count = fewer(few.dfg_sample_count, share("dfg"));
    few.irradiance_sample_count = few.irradiance_sample_count.map(|count| fewer(count, share("irradiance").sqrt()));
    few
}
