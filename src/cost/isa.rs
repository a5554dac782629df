//! Counts the instructions in AMD assembly text, inside and outside the loop over samples.
//!
//! RADV's text has labels `BBn:`, one instruction per line, and `(then repeated k times)` for k
//! more of the line before. A loop is the natural loop of a back edge; the loop over samples is the
//! outermost one with an image lookup.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

/// Instructions by executing unit, for one lane of a wave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Full-rate vector arithmetic. A dual-issued pair counts once.
    pub alu: f64,
    /// Quarter-rate vector arithmetic: rcp, rsq, sqrt, log, exp, sin, cos, and 32-bit integer
    /// products.
    pub quarter: f64,
    /// Scalar arithmetic, scalar loads and branches: once per wave.
    pub scalar: f64,
    /// Unfiltered texel loads and stores.
    pub unfiltered: f64,
    /// Lookups in one level.
    pub bilinear: f64,
    /// Lookups between two levels.
    pub trilinear: f64,
    /// Bytes of buffer and shared memory.
    pub memory_bytes: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaderCounts {
    /// Executed once per dispatch.
    pub outside: Counts,
    /// Executed once per sample.
    pub inside: Counts,
    /// Other loops, of unknown length: their instructions count once.
    pub other_loops: usize,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line} of the assembly, {text:?}: {what}")]
pub struct IsaFault {
    pub line: usize,
    pub text: String,
    pub what: &'static str,
}

impl Counts {
    /// Image lookups, filtered or not.
    fn lookups(&self) -> f64 {
        self.unfiltered + self.bilinear + self.trilinear
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.alu += other.alu;
        self.quarter += other.quarter;
        self.scalar += other.scalar;
        self.unfiltered += other.unfiltered;
        self.bilinear += other.bilinear;
        self.trilinear += other.trilinear;
        self.memory_bytes += other.memory_bytes;
    }
}

/// Quarter-rate vector instructions \[LlvmAmdgpu20\].
const QUARTER: [&str; 12] = [
    "v_rcp_",
    "v_rsq_",
    "v_sqrt_",
    "v_log_",
    "v_exp_",
    "v_sin_",
    "v_cos_",
    "v_mul_lo_",
    "v_mul_hi_",
    "v_mad_u64_",
    "v_mad_i64_",
    "v_mad_co_",
];
/// Scalar instructions that no unit executes: waits and hints.
const HINTS: [&str; 9] = [
    "s_waitcnt",
    "s_wait_",
    "s_clause",
    "s_nop",
    "s_delay_alu",
    "s_inst_prefetch",
    "s_set_inst_prefetch",
    "s_code_end",
    "s_endpgm",
];
const MEMORY: [&str; 7] = [
    "buffer_", "tbuffer_", "global_", "flat_", "scratch_", "ds_", "lds_",
];

/// Returns the counts of one instruction; `None` if it is unknown.
fn counted(mnemonic: &str) -> Option<Counts> {
    let begins = |starts: &[&str]| starts.iter().any(|start| mnemonic.starts_with(start));
    let none = Counts::default();
    Some(if begins(&HINTS) {
        none
    } else if begins(&["s_"]) {
        Counts {
            scalar: 1.0,
            ..none
        }
    } else if begins(&QUARTER) {
        Counts {
            quarter: 1.0,
            ..none
        }
    } else if begins(&["v_"]) {
        Counts { alu: 1.0, ..none }
    } else if begins(&["image_sample", "image_gather"]) {
        let is_one_level = mnemonic.split('_').any(|part| part == "lz");
        if is_one_level {
            Counts {
                bilinear: 1.0,
                ..none
            }
        } else {
            Counts {
                trilinear: 1.0,
                ..none
            }
        }
    } else if begins(&["image_"]) {
        Counts {
            unfiltered: 1.0,
            ..none
        }
    } else if begins(&MEMORY) {
        Counts {
            memory_bytes: bytes(mnemonic),
            ..none
        }
    } else if begins(&["exp"]) {
        // Exports of graphics stages; passes over pixels have none.
        none
    } else {
        return None;
    })
}

/// Bytes per lane that a memory instruction moves.
fn bytes(mnemonic: &str) -> f64 {
    let width = |part: &str| match part {
        "dwordx2" | "b64" => Some(8.0),
        "dwordx3" | "b96" | "xyz" => Some(12.0),
        "dwordx4" | "b128" | "xyzw" => Some(16.0),
        _ => None,
    };
    mnemonic.split('_').find_map(width).unwrap_or(4.0)
}

/// Instructions entered only at their label.
#[derive(Default)]
struct Block {
    label: String,
    counts: Counts,
    /// Labels that it jumps to, with their lines.
    jumps: Vec<(String, usize)>,
    /// Whether the next block follows it.
    falls_through: bool,
}

pub fn count(assembly: &str) -> Result<ShaderCounts, IsaFault> {
    let blocks = blocks(assembly)?;
    let loops = loops(assembly, &blocks)?;
    let has_lookup = |body: &&BTreeSet<usize>| {
        body.iter()
            .any(|block| blocks[*block].counts.lookups() > 0.0)
    };
    // The outermost loop with lookups; if there were several, the longest.
    let samples = loops
        .values()
        .filter(has_lookup)
        .max_by_key(|body| body.len());
    let mut counts = ShaderCounts {
        other_loops: loops.len() - usize::from(samples.is_some()),
        ..Default::default()
    };
    for (index, block) in blocks.iter().enumerate() {
        if samples.is_some_and(|body| body.contains(&index)) {
            counts.inside += block.counts;
        } else {
            counts.outside += block.counts;
        }
    }
    Ok(counts)
}

fn blocks(assembly: &str) -> Result<Vec<Block>, IsaFault> {
    let mut blocks = vec![Block {
        falls_through: true,
        ..Block::default()
    }];
    let mut last = None;
    for (index, line) in assembly.lines().enumerate() {
        let text = line.split(';').next().unwrap_or_default().trim();
        let fault = |what| IsaFault {
            line: index + 1,
            text: text.to_owned(),
            what,
        };
        let block = blocks.last_mut().expect("there is always one");
        if text.is_empty() {
            continue;
        }
        if let Some(label) = text.strip_suffix(':') {
            blocks.push(Block {
                label: label.to_owned(),
                falls_through: true,
                ..Block::default()
            });
            last = None;
        } else if let Some(rest) = text.strip_prefix("(then repeated ") {
            let times = rest
                .split(' ')
                .next()
                .and_then(|times| times.parse::<u32>().ok());
            let (times, counts): (u32, Counts) = times
                .zip(last)
                .ok_or_else(|| fault("expected a number of times"))?;
            (0..times).for_each(|_| block.counts += counts);
        } else {
            let mut words = text.split_whitespace();
            let mnemonic = words.next().unwrap_or_default();
            let counts = counted(mnemonic).ok_or_else(|| fault("no instruction of the model"))?;
            block.counts += counts;
            last = Some(counts);
            if mnemonic.starts_with("s_branch") || mnemonic.starts_with("s_cbranch") {
                let to = words.next().ok_or_else(|| fault("a branch to nowhere"))?;
                block.jumps.push((to.to_owned(), index));
            }
            // Code after a jump without a label is unreachable.
            block.falls_through &= !["s_branch", "s_endpgm"].contains(&mnemonic);
        }
    }
    Ok(blocks)
}

/// Finds the blocks of every natural loop, by its first block.
fn loops(assembly: &str, blocks: &[Block]) -> Result<BTreeMap<usize, BTreeSet<usize>>, IsaFault> {
    let places: BTreeMap<&str, usize> = blocks
        .iter()
        .enumerate()
        .map(|(index, block)| (block.label.as_str(), index))
        .collect();
    let mut before = vec![Vec::new(); blocks.len()];
    let mut back_edges = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        if block.falls_through && index + 1 < blocks.len() {
            before[index + 1].push(index);
        }
        for (label, line) in &block.jumps {
            let to = *places.get(label.as_str()).ok_or_else(|| IsaFault {
                line: line + 1,
                text: assembly
                    .lines()
                    .nth(*line)
                    .unwrap_or_default()
                    .trim()
                    .to_owned(),
                what: "no such label",
            })?;
            before[to].push(index);
            // The compiler lays out structured code in order: only loops jump back.
            if to <= index {
                back_edges.push((to, index));
            }
        }
    }
    let mut loops: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (head, tail) in back_edges {
        let body = loops.entry(head).or_insert_with(|| BTreeSet::from([head]));
        let mut open = vec![tail];
        while let Some(block) = open.pop() {
            if body.insert(block) {
                open.extend(&before[block]);
            }
        }
    }
    Ok(loops)
}
