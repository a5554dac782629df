//! What the rest of a run will cost: from records, else from a probe that the cache keeps, else from constants.

use super::Failure;
use super::cache::CacheArguments;
use super::run::open_device;
use splitsum::pipeline::{DeviceChoice, DeviceInfo, DiskCache, chosen_device, is_kept};
use splitsum::runner::estimate::{
    Estimate, Host, Item, Source, Speeds, constants, estimate, items, lack, probe, recorded,
};
use splitsum::runner::timing::TimingJob;
use splitsum::runner::{Cell, Plan, RenderFault};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Instant;

/// An estimate and what a reader should know of it.
pub struct Estimated {
    pub estimate: Estimate,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// Where prices of work come from, best first, on the machine that is to do it.
pub struct Sources {
    pub speeds: Vec<(Source, Speeds)>,
    pub host: Host,
    /// One sentence each.
    notes: Vec<String>,
}

/// What is asked beside the plan itself.
pub struct Question<'a> {
    pub open: &'a [&'a Cell],
    pub jobs: &'a [TimingJob<'a>],
    /// With the records that tell.
    pub folders: &'a [PathBuf],
    pub cache: &'a CacheArguments,
    pub device: Option<usize>,
    /// What loading the plan took.
    pub load_s: f64,
}

/// The cost of these cells and timings of a plan.
pub fn estimated(plan: &Plan, asked: &Question) -> Result<Estimated, Failure> {
    let (info, mut cache) = device_and_cache(asked)?;
    let mut kept: BTreeSet<&str> = BTreeSet::new();
    for cell in asked.open {
        let is_there = |cache: &DiskCache| is_kept(cache, &plan.reference_request(&plan.reference_point(&cell.point)));
        if !kept.contains(cell.reference.as_str()) && cache.as_ref().is_some_and(is_there) {
            kept.insert(&cell.reference);
        }
    }
    let work = items(plan, asked.open, asked.jobs, &kept);
    let Sources { speeds, host, mut notes } = sources(plan, asked, &work, info.as_ref(), cache.as_mut());
    if !kept.is_empty() {
        notes.push(format!("{} references are in the cache and take no time", kept.len()));
    }
    let estimate = estimate(plan, asked.open, &work, &speeds, host);
    if estimate.parts.iter().any(|(_, part)| part.sources.contains_key(&Source::Constants) && part.seconds > 0.5) {
        notes.push(
            "constants: a guess, the speed of a software driver on 2 cores; nothing of it was measured here".to_owned(),
        );
    }
    Ok(Estimated { estimate, notes })
}

/// What work costs on this machine, whatever its cache holds: the other machines' need not hold it.
pub fn measured(plan: &Plan, asked: &Question) -> Result<Sources, Failure> {
    let (info, mut cache) = device_and_cache(asked)?;
    let work = items(plan, asked.open, asked.jobs, &BTreeSet::new());
    Ok(sources(plan, asked, &work, info.as_ref(), cache.as_mut()))
}

/// The device that will do the work, where there is one, and its cache.
fn device_and_cache(asked: &Question) -> Result<(Option<DeviceInfo>, Option<DiskCache>), Failure> {
    let choice = asked.device.map_or(DeviceChoice::Default, DeviceChoice::Index);
    let info = match chosen_device(choice) {
        Ok(info) => info,
        Err(error) if asked.device.is_some() => return Err(Failure::input(error)),
        Err(_) => return Ok((None, None)),
    };
    let mut cache = asked.cache.open().map_err(Failure::opening)?;
    if let Some(cache) = &mut cache {
        cache.set_device(&info);
    }
    Ok((Some(info), cache))
}

fn sources(
    plan: &Plan,
    asked: &Question,
    work: &[Item],
    info: Option<&DeviceInfo>,
    cache: Option<&mut DiskCache>,
) -> Sources {
    let (mut notes, mut speeds) = (Vec::new(), Vec::new());
    let found = recorded(plan, asked.folders, info);
    if found.count > 0 {
        notes.push(format!("records: {} cells and timings in {}", found.count, listed(asked.folders)));
    }
    let needs_more = lack(&found.speeds, work);
    speeds.push((Source::Records, found.speeds));
    if let (Some(info), true) = (info, needs_more) {
        match probed(plan, cache, asked.device, asked.load_s) {
            Ok((found, note)) => {
                notes.push(format!("probe: on {} ({}), {note}", info.name, info.driver));
                speeds.push((Source::Probe, found));
            }
            Err(fault) => notes.push(format!("no probe: {fault}")),
        }
    } else if needs_more {
        notes.push("no device answers, so nothing was measured".to_owned());
    }
    speeds.push((Source::Constants, constants()));
    let host = Host {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        is_cpu_device: info.is_none_or(|info| info.device_type == "cpu"),
    };
    Sources { speeds, host, notes }
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
