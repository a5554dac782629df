//! What the rest of a run will cost: from records, else from a probe that the cache keeps, else from constants.

use super::Failure;
use super::cache::CacheArguments;
use super::run::open_device;
use splitsum::experiment::estimate::{
    Estimate, Host, Source, Speeds, constants, estimate, items, lack, probe, recorded,
};
use splitsum::experiment::timing::TimingJob;
use splitsum::experiment::{Cell, Plan, RenderFault};
use splitsum::pipeline::{DeviceChoice, DeviceInfo, DiskCache, chosen_device, is_kept};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Instant;

/// An estimate and what a reader should know of it.
pub struct Estimated {
    pub estimate: Estimate,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// The cost of these cells and timings of a plan that took `load_s` to load, with the records of `folders`.
pub fn estimated(
    plan: &Plan,
    open: &[&Cell],
    jobs: &[TimingJob],
    folders: &[PathBuf],
    cache: &CacheArguments,
    device: Option<usize>,
    load_s: f64,
) -> Result<Estimated, Failure> {
    let choice = device.map_or(DeviceChoice::Default, DeviceChoice::Index);
    let info = match chosen_device(choice) {
        Ok(info) => Some(info),
        Err(error) if device.is_some() => return Err(Failure::input(error)),
        Err(_) => None,
    };
    let mut cache = if info.is_some() { cache.open().map_err(Failure::opening)? } else { None };
    if let (Some(cache), Some(info)) = (&mut cache, &info) {
        cache.set_device(info);
    }
    let mut kept: BTreeSet<&str> = BTreeSet::new();
    for cell in open {
        let is_there = |cache: &DiskCache| is_kept(cache, &plan.reference_request(&plan.reference_point(&cell.point)));
        if !kept.contains(cell.reference.as_str()) && cache.as_ref().is_some_and(is_there) {
            kept.insert(&cell.reference);
        }
    }
    let work = items(plan, open, jobs, &kept);
    let mut notes = Vec::new();
    let mut sources = Vec::new();
    let found = recorded(plan, folders, info.as_ref());
    if found.count > 0 {
        notes.push(format!("records: {} cells and timings in {}", found.count, listed(folders)));
    }
    let needs_more = lack(&found.speeds, &work);
    sources.push((Source::Records, found.speeds));
    if let (Some(info), true) = (&info, needs_more) {
        match probed(plan, cache.as_mut(), device, load_s) {
            Ok((speeds, note)) => {
                notes.push(format!("probe: on {} ({}), {note}", info.name, info.driver));
                sources.push((Source::Probe, speeds));
            }
            Err(fault) => notes.push(format!("no probe: {fault}")),
        }
    } else if needs_more {
        notes.push("no device answers, so nothing was measured".to_owned());
    }
    sources.push((Source::Constants, constants()));
    if !kept.is_empty() {
        notes.push(format!("{} references are in the cache and take no time", kept.len()));
    }
    let host = Host {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        is_cpu_device: info.as_ref().is_none_or(|info: &DeviceInfo| info.device_type == "cpu"),
    };
    let estimate = estimate(plan, open, &work, &sources, host);
    if estimate.parts.iter().any(|(_, part)| part.sources.contains_key(&Source::Constants) && part.seconds > 0.5) {
        notes.push(
            "constants: a guess, the speed of a software driver on 2 cores; nothing of it was measured here".to_owned(),
        );
    }
    Ok(Estimated { estimate, notes })
}

fn listed(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// The speeds of a probe, with a word on how they were had. The cache keeps them by program, device, driver and cells.
fn probed(
    plan: &Plan,
    mut cache: Option<&mut DiskCache>,
    device: Option<usize>,
    load_s: f64,
) -> Result<(Speeds, String), RenderFault> {
    let key = format!("kind=probe\nplan={}\n", plan.hash);
    let known = cache.as_mut().and_then(|cache| cache.load(&key));
    if let Some(speeds) = known.and_then(|bytes| serde_json::from_slice(&bytes).ok()) {
        return Ok((speeds, "kept in the cache from an earlier plan".to_owned()));
    }
    let started = Instant::now();
    let mut pipeline = open_device(device)?;
    let opened_s = load_s + started.elapsed().as_secs_f64();
    let speeds = probe(plan, &mut pipeline, opened_s)?;
    if let (Some(cache), Ok(bytes)) = (cache, serde_json::to_vec(&speeds)) {
        cache.store(&key, &bytes);
    }
    Ok((speeds, format!("in {:.1} s", started.elapsed().as_secs_f64())))
}
