//! How a plan is cut: every step in one chunk, and what shares work together.

use super::{Bench, CELL_SECONDS, CELLS, GROUP_CELLS, prices};
use splitsum::experiment::Cell;
use splitsum::run::chunk::Prices;
use splitsum::run::chunk::split::split;
use splitsum::run::estimate::{Host, SAMPLES_PER_SECOND, Source, constants, estimate, items};
use splitsum::run::timing;
use std::collections::{BTreeMap, BTreeSet};

#[test]
fn every_cell_and_timing_is_in_one_chunk_whatever_the_length() {
    let bench = Bench::new(1.0);
    let plan = &bench.plan;
    let costs = prices(25e6, 0.0);
    let jobs = timing::jobs(plan);
    let block_of: BTreeMap<&str, &str> = jobs.iter().map(|job| (job.id.as_str(), job.block.as_str())).collect();
    let single = split(plan, 1e9, &costs);
    assert_eq!((single.len(), single[0].cells.len()), (1, CELLS));
    let order: Vec<&String> = plan.cells.iter().map(|cell| &cell.id).collect();
    assert_eq!(single[0].cells.iter().collect::<Vec<_>>(), order, "cells stand in the order of the plan");
    let mut fewest = usize::MAX;
    for seconds in [1e-6, 0.01, 0.07, 0.3, 0.5, 1.0, 1.5, 2.0, 1e3] {
        let chunks = split(plan, seconds, &costs);
        assert_eq!(chunks, split(plan, seconds, &costs));
        assert!(chunks.len() <= fewest, "{seconds} s: {} chunks", chunks.len());
        fewest = chunks.len();
        assert!(chunks.iter().enumerate().all(|(i, chunk)| chunk.index == i));
        let mut cells: Vec<&String> = chunks.iter().flat_map(|chunk| &chunk.cells).collect();
        let mut timings: Vec<&str> = chunks.iter().flat_map(|chunk| &chunk.timings).map(String::as_str).collect();
        let blocks: Vec<&str> = timings.iter().map(|id| block_of[id]).collect();
        cells.sort();
        cells.dedup();
        timings.sort_unstable();
        timings.dedup();
        assert_eq!(
            (cells.len(), timings.len()),
            (CELLS, jobs.len()),
            "{seconds} s: something is left out or done twice"
        );
        assert_eq!(chunks.iter().map(|c| c.cells.len() + c.timings.len()).sum::<usize>(), CELLS + jobs.len());
        // A block is one run of neighbours in one chunk.
        let runs = blocks.chunk_by(|a, b| a == b).count();
        assert_eq!(runs, blocks.iter().collect::<BTreeSet<_>>().len(), "{seconds} s");
        for chunk in &chunks {
            let here: usize = chunk.blocks(&jobs).iter().map(Vec::len).sum();
            assert_eq!(here, chunk.timings.len());
            for block in chunk.blocks(&jobs) {
                let members = jobs.iter().filter(|job| job.block == block_of[block[0].as_str()]).count();
                assert_eq!(block.len(), members, "{seconds} s: a block is parted");
            }
        }
    }
}

/// A group is 8 x 0.03 s for its cells; its reference and images are nothing beside that.
#[test]
fn cells_of_one_reference_and_environment_share_a_chunk() {
    let bench = Bench::new(1.0);
    let costs = prices(1e12, 0.0);
    let group_of: BTreeMap<&str, &str> =
        bench.plan.cells.iter().map(|cell| (cell.id.as_str(), cell.reference.as_str())).collect();
    let brdf_of: BTreeMap<&str, String> = bench
        .plan
        .cells
        .iter()
        .map(|cell| {
            let text = |axis| cell.point.get(axis).to_string();
            (cell.id.as_str(), format!("{} {}", text("environment"), text("brdf")))
        })
        .collect();
    let cells_of = |seconds: f64| -> Vec<Vec<String>> {
        split(&bench.plan, seconds, &costs)
            .into_iter()
            .map(|chunk| chunk.cells)
            .filter(|cells| !cells.is_empty())
            .collect()
    };
    let group = GROUP_CELLS as f64 * CELL_SECONDS;
    for cells in cells_of(group * 1.01) {
        let references: BTreeSet<&str> = cells.iter().map(|id| group_of[id.as_str()]).collect();
        assert_eq!((cells.len(), references.len()), (GROUP_CELLS, 1));
    }
    // Alpha is the slowest axis of the file, yet both alphas of an environment and model meet: they share a prefiltered map.
    for cells in cells_of(2.0 * group * 1.01) {
        let tables: BTreeSet<&String> = cells.iter().map(|id| &brdf_of[id.as_str()]).collect();
        assert_eq!((cells.len(), tables.len()), (2 * GROUP_CELLS, 1));
    }
    // A group is parted only when it does not fit.
    let halves = cells_of(group * 0.51);
    assert_eq!(halves.len(), 2 * CELLS / GROUP_CELLS);
    assert!(halves.iter().all(|cells| cells.len() == GROUP_CELLS / 2));
    // With a reference that outweighs the images it is never rendered twice.
    let slow = prices(1e2, 0.0);
    assert_eq!(
        split(&bench.plan, 1e-3, &slow).iter().filter(|chunk| !chunk.cells.is_empty()).count(),
        CELLS / GROUP_CELLS
    );
}

/// One truth: a plan in a single chunk is reckoned to take what the estimate of the same prices says, and a faster device less.
#[test]
fn a_chunk_is_as_long_as_the_estimate_says() {
    let bench = Bench::new(1.0);
    let plan = &bench.plan;
    let cells: Vec<&Cell> = plan.cells.iter().collect();
    let work = items(plan, &cells, &timing::jobs(plan), &BTreeSet::new());
    let sources = [(Source::Constants, constants())];
    let estimated = estimate(plan, &cells, &work, &sources, Host::STATED).seconds;
    let seconds = |rate: f64| split(plan, 1e9, &Prices::stated(rate))[0].seconds;
    let stated = seconds(SAMPLES_PER_SECOND);
    // Chunks are told to the millisecond.
    assert!((stated - estimated).abs() <= 5.1e-4, "{stated} s and {estimated} s");
    assert!(seconds(0.1 * SAMPLES_PER_SECOND) > 2.0 * stated && seconds(1e12) < stated);
    let prices = Prices::stated(SAMPLES_PER_SECOND);
    assert!(prices.basis.starts_with("stated, for 6e7 samples a second"), "{}", prices.basis);
}
