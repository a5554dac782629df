//! The cost of the rest of a run: from records, else from constants, scaled by a probe of the device.

use super::Failure;
use super::cache::CacheArguments;
use super::run::open_device;
use splitsum::experiment::{Cell, Plan};
use splitsum::pipeline::{DeviceChoice, DeviceInfo, DiskCache, chosen_device, is_kept};
use splitsum::run::RenderFault;
use splitsum::run::estimate::{
    Estimate, Host, Item, Source, Speeds, constants, device_speeds, estimate, items, lack, recorded, samples_per_second,
};
use splitsum::run::timing::TimingJob;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::time::Instant;

/// An estimate and what a reader should know of it.
pub struct Estimated {
    pub estimate: Estimate,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// The question beside the plan itself.
pub struct Question<'a> {
    pub open: &'a [&'a Cell],
    pub jobs: &'a [TimingJob<'a>],
    /// With the records that tell.
    pub folders: &'a [PathBuf],
    pub cache: &'a CacheArguments,
    pub device: Option<usize>,
}

/// The cost of these cells and timings of a plan.
pub fn estimated(plan: &Plan, asked: &Question) -> Result<Estimated, Failure> {
    let (info, cache) = device_and_cache(asked)?;
    let is_there = |cell: &&Cell| {
        let request = plan.reference_request(&plan.reference_point(&cell.point));
        cache.as_ref().is_some_and(|cache| is_kept(cache, &request))
    };
    let first_of_each: BTreeMap<&str, &Cell> = asked.open.iter().map(|cell| (cell.reference.as_str(), *cell)).collect();
    let kept = first_of_each.iter().filter(|(_, cell)| is_there(cell)).map(|(id, _)| *id).collect::<BTreeSet<_>>();
    let work = items(plan, asked.open, asked.jobs, &kept);
    let mut notes = Vec::new();
    let speeds = sources(plan, asked, &work, info.as_ref(), &mut notes);
    let host = Host {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        is_cpu_device: info.is_none_or(|info| info.device_type == "cpu"),
    };
    if !kept.is_empty() {
        notes.push(format!("{} references are in the cache and take no time", kept.len()));
    }
    let estimate = estimate(plan, asked.open, &work, &speeds, host);
    if estimate.parts.iter().any(|(_, part)| part.sources.contains_key(&Source::Constants) && part.seconds > 0.5) {
        let text = "constants: a guess, the speed of a software driver on 2 cores; nothing of it was measured here";
        notes.push(text.to_owned());
    }
    Ok(Estimated { estimate, notes })
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

/// Where prices of work come from, best first, with notes on them.
fn sources(
    plan: &Plan,
    asked: &Question,
    work: &[Item],
    info: Option<&DeviceInfo>,
    notes: &mut Vec<String>,
) -> Vec<(Source, Speeds)> {
    let (recorded, count) = recorded(plan, asked.folders, info);
    if count > 0 {
        let folders: Vec<String> = asked.folders.iter().map(|folder| folder.display().to_string()).collect();
        notes.push(format!("records: {count} cells and timings in {}", folders.join(", ")));
    }
    let needs_more = lack(&recorded, work);
    let mut speeds = vec![(Source::Records, recorded)];
    match info.filter(|_| needs_more).map(|info| (info, probed(plan, asked.device))) {
        Some((info, Ok(Some((found, note))))) => {
            notes.push(format!("probe: {} ({}) draws {note}", info.name, info.driver));
            speeds.push((Source::Probe, found));
        }
        Some((_, Err(fault))) => notes.push(format!("no probe: {fault}")),
        None if needs_more => notes.push("no device answers, so nothing was measured".to_owned()),
        Some((_, Ok(None))) | None => {}
    }
    speeds.push((Source::Constants, constants()));
    speeds
}

/// The speeds of the device by a probe, with a word on it; `None` for a plan without cells.
fn probed(plan: &Plan, device: Option<usize>) -> Result<Option<(Speeds, String)>, RenderFault> {
    let started = Instant::now();
    let rate = samples_per_second(plan, &mut open_device(device)?)?;
    let note =
        |rate: f64| format!("{:.0} million samples a second, in {:.1} s", rate / 1e6, started.elapsed().as_secs_f64());
    Ok(rate.map(|rate| (device_speeds(rate), note(rate))))
}
