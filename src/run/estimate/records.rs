//! Speeds from the records of runs: what their cells and timings took, and how large their files are.

use super::constants::constants;
use super::items::{all_tables, amount, file_kind, kind_of, ladder_amount};
use super::speeds::{Amount, Speeds};
use crate::experiment::axis::{AXES, ENVIRONMENT, Point, SIZE};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::files::names_in;
use crate::pipeline::DeviceInfo;
use crate::precompute::table_of;
use crate::run::statistics::median;
use crate::run::store::{CELLS_FOLDER, CHUNKS_FOLDER, CellRecord, Store, TIMINGS_FOLDER};
use crate::run::timing::{FRAME, PassSamples, TimingRecord};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Speeds from the records below these folders, each a run's or one that chunks share, and how many cells and timings took part. Records of
/// another device than `device` say nothing.
pub fn recorded(plan: &Plan, dirs: &[PathBuf], device: Option<&DeviceInfo>) -> (Speeds, usize) {
    let is_ours = |name: &str, driver: &str| device.is_none_or(|device| device.name == name && device.driver == driver);
    let mut found = Found { plan, measured: Vec::new(), count: 0 };
    let mut seen = BTreeSet::new();
    for store in dirs.iter().flat_map(|dir| folders(dir)).map(|dir| Store::at(&dir)) {
        for id in store.ids(CELLS_FOLDER) {
            let record = store.cell(&id).ok().flatten().filter(|record| is_ours(&record.device, &record.driver));
            if let Some(record) = record.filter(|_| seen.insert(id)) {
                found.cell(&store, &record);
            }
        }
        for id in store.ids(TIMINGS_FOLDER) {
            let record = store.timing::<TimingRecord>(&id).ok().flatten();
            let record = record.filter(|record| is_ours(&record.device, &record.driver));
            if let Some(record) = record.filter(|_| seen.insert(id)) {
                found.timing(&record);
            }
        }
    }
    (constants().scaled_to(&found.measured), found.count)
}

struct Found<'p> {
    plan: &'p Plan,
    /// Kind, amount, and the seconds or bytes that it took.
    measured: Vec<(String, Amount, f64)>,
    count: usize,
}

impl Found<'_> {
    fn cell(&mut self, store: &Store, record: &CellRecord) {
        let (plan, spent) = (self.plan, &record.spent);
        // Records of older programs do not say where their time went.
        let Some(point) = point_of(&record.axes).filter(|_| spent.score_ms > 0.0) else { return };
        self.count += 1;
        let size = amount(plan, &point);
        let reference = plan.reference_point(&point);
        let mut add = |kind: String, amount, ms: f64| self.measured.push((kind, amount, ms / 1e3));
        if let Some(ms) = spent.image_ms {
            let times = f64::from(1 + plan.repeats_of(&point).unwrap_or(0));
            add(kind_of("image", &point), size, ms / times);
        }
        if let (Some(ms), Some(drawn)) = (spent.ladder_ms, ladder_amount(plan, &point)) {
            add("ladder".to_owned(), drawn, ms);
        }
        if let Some(ms) = spent.reference_ms {
            add(kind_of("reference", &reference), amount(plan, &reference), ms);
        }
        // An environment or scene of another experiment is not loaded: its tables say nothing.
        let known = plan.inputs.has_environment(point[ENVIRONMENT].text());
        let tables = if known { [all_tables(plan, &point), all_tables(plan, &reference)].concat() } else { Vec::new() };
        for (_, kind, samples) in tables {
            let ms = kind.split(' ').nth(1).and_then(|name| spent.tables_ms.get(name));
            ms.into_iter().for_each(|ms| add(kind.clone(), Amount { pixels: 0.0, samples }, *ms));
        }
        let pixels = Amount { pixels: size.pixels, samples: 0.0 };
        add("display".to_owned(), pixels, spent.display_ms);
        let score = if spent.image_ms.is_some() { "score first" } else { "score again" };
        add(score.to_owned(), pixels, spent.score_ms);
        let length = |path: &Path| std::fs::metadata(path).map_or(0.0, |metadata| metadata.len() as f64);
        self.measured.push(("bytes record".to_owned(), pixels, length(&store.cell_path(&record.cell))));
        for name in record.files.keys() {
            // NAME.ID.exr
            let id = name.rsplit('.').nth(1).unwrap_or_default();
            let is_reference = store.reference(id).ok().flatten().is_some();
            self.measured.push((file_kind(name, is_reference).to_owned(), pixels, length(&store.image_path(name))));
        }
    }

    fn timing(&mut self, record: &TimingRecord) {
        let Some(mut point) = point_of(&record.axes) else { return };
        self.count += 1;
        if record.phase == FRAME {
            point[SIZE] = Value::Pair(record.size);
            let kind = kind_of("frame", &point);
            self.measured.push((kind, amount(self.plan, &point), median(&record.wall_ms) / 1e3));
            return;
        }
        // Tables are timed once for all environments of a size: one of the plan's stands for them.
        let image = |cell: &Cell| &self.plan.inputs.environment(cell.point[ENVIRONMENT].text()).image;
        let is_as_large = |cell: &&Cell| [image(cell).width, image(cell).height] == record.environment_size;
        let Some(cell) = self.plan.cells.iter().find(is_as_large) else { return };
        point[ENVIRONMENT] = cell.point[ENVIRONMENT].clone();
        for (_, kind, samples) in all_tables(self.plan, &point) {
            let is_own = |pass: &&PassSamples| kind.split(' ').nth(1) == Some(table_of(&pass.pass));
            let times: Vec<f64> = record.passes.iter().filter(is_own).map(|pass| median(&pass.ms) / 1e3).collect();
            if !times.is_empty() {
                self.measured.push((kind, Amount { pixels: 0.0, samples }, times.iter().sum()));
            }
        }
    }
}

/// The folder itself and those of the attempts at chunks below it.
fn folders(dir: &Path) -> Vec<PathBuf> {
    let below = |dir: PathBuf| names_in(&dir).into_iter().map(move |name| dir.join(name));
    let attempts = below(dir.join(CHUNKS_FOLDER)).flat_map(below);
    std::iter::once(dir.to_owned()).chain(attempts).collect()
}

/// The point whose values are written so; what is missing has its default.
fn point_of(axes: &BTreeMap<String, String>) -> Option<Point> {
    let mut point = Point::default();
    for (axis, value) in AXES.iter().zip(&mut point.0) {
        if let Some(text) = axes.get(axis.name).filter(|text| !text.is_empty()) {
            *value = axis.kind.parse_text(text).ok()?;
        }
    }
    Some(point)
}
