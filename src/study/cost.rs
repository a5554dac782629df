//! What methods cost by the model of [`crate::cost`], as table, text and figure.

use super::figure::{Figure, Mark, Panel, Scale, Series, Shape};
use crate::cost::child::Compiler;
use crate::cost::family::{Card, Family, Texel};
use crate::cost::isa::Counts;
use crate::cost::model::{Bound, FRAME, Pass};
use crate::table::csv::{Cell, to_text};
use crate::table::markdown::{Align, MarkdownTable};

/// One shading pass on one family.
#[derive(Debug)]
pub struct Shaded {
    pub family: &'static Family,
    pub compiler: Compiler,
    pub method: &'static str,
    /// Empty for a method that does not use the model.
    pub brdf: &'static str,
    pub uses_samples: bool,
    pub pass: Pass,
}

/// Every pass that was asked for, family by family.
#[derive(Debug)]
pub struct Costs {
    pub shaded: Vec<Shaded>,
    /// Samples a pixel, in order.
    pub sample_counts: Vec<u32>,
    pub texel: (&'static str, Texel),
    pub layout: &'static str,
}

/// The caveat that stands wherever numbers do.
pub const CAVEAT: &str = "A model, not a measurement: no GPU ran. A bound lies between perfect overlap of all units and none, with full \
                          waves and caches that always hit; memory traffic beyond them is left out (docs/cost.md).";

const CLASSES: [&str; 7] = ["alu", "quarter_rate", "scalar", "unfiltered", "bilinear", "trilinear", "memory_bytes"];

fn classes(counts: &Counts) -> [f64; 7] {
    let Counts { alu, quarter, scalar, unfiltered, bilinear, trilinear, memory_bytes } = *counts;
    [alu, quarter, scalar, unfiltered, bilinear, trilinear, memory_bytes]
}

impl Shaded {
    fn name(&self) -> String {
        if self.brdf.is_empty() { self.method.to_owned() } else { format!("{} {}", self.method, self.brdf) }
    }

    /// The sample counts at which the method differs; a method without samples has one bound.
    fn counts<'a>(&self, all: &'a [u32]) -> &'a [u32] {
        if self.uses_samples { all } else { &[1] }
    }
}

impl Costs {
    /// Families with their passes.
    fn families(&self) -> impl Iterator<Item = &[Shaded]> {
        self.shaded.chunk_by(|a, b| a.family.name == b.family.name)
    }

    fn milliseconds(&self, shaded: &Shaded, card: &Card, samples: u32) -> Bound {
        shaded.pass.cycles(shaded.family, self.texel.1, samples).milliseconds(card)
    }

    /// One row a pass, card and sample count.
    pub fn csv(&self) -> Vec<u8> {
        let first = ["driver", "family", "generation", "card", "method", "brdf", "layout", "texel", "samples"];
        let counted = ["outside", "inside"].map(|part| CLASSES.map(|class| format!("{part}_{class}"))).concat();
        let last = [
            "other_loops",
            "wave",
            "vector_registers",
            "waves",
            "busiest_unit",
            "model_cycles_least",
            "model_cycles_most",
            "model_ms_least",
            "model_ms_most",
        ];
        let columns: Vec<String> =
            first.map(str::to_owned).into_iter().chain(counted).chain(last.map(str::to_owned)).collect();
        let row = |shaded: &Shaded, card: &Card, samples: u32| {
            let Shaded { family, compiler, method, brdf, uses_samples, pass } = shaded;
            let words = [&compiler.driver, family.name, family.generation.name, card.name, method, brdf, self.layout];
            let words = words.into_iter().chain([self.texel.0]).map(Cell::from);
            let numbers = [&pass.counts.outside, &pass.counts.inside].map(classes).concat().into_iter().map(Cell::from);
            let cycles = pass.cycles(family, self.texel.1, samples);
            let time = cycles.milliseconds(card);
            let bounds = [cycles.least, cycles.most, time.least, time.most].map(Cell::from);
            let compiled = [pass.wave, pass.vector_registers, pass.waves].map(Cell::from);
            words
                .chain([uses_samples.then_some(samples).into()])
                .chain(numbers)
                .chain([pass.counts.other_loops.into()])
                .chain(compiled)
                .chain([pass.busiest(family, self.texel.1, samples).into()])
                .chain(bounds)
                .collect::<Vec<Cell>>()
        };
        let mut rows = Vec::new();
        for shaded in &self.shaded {
            for card in shaded.family.cards {
                rows.extend(shaded.counts(&self.sample_counts).iter().map(|samples| row(shaded, card, *samples)));
            }
        }
        to_text(&columns, rows.iter().map(Vec::as_slice)).to_vec()
    }

    /// Two tables a family: its code, and the bounds of each card.
    pub fn markdown(&self) -> String {
        let mut text = format!("{CAVEAT}\n");
        for family in self.families() {
            let (Family { name, generation, cards, .. }, driver) = (family[0].family, &family[0].compiler.driver);
            text += &format!("\n## {name}, {} ({driver}, {} maps, {})\n", generation.name, self.layout, self.texel.0);
            text += &format!("\nInstructions a pixel: fixed, then a sample.\n\n{}", self.code(family));
            for card in *cards {
                let [width, height] = FRAME;
                text += &format!(
                    "\nModel bound for {width}x{height} on {}, ms:\n\n{}",
                    card.name,
                    self.bounds(family, card)
                );
            }
            if let Some(table) = self.afforded(family) {
                text += &format!("\nSamples a pixel at equal model cost, between the ends of both bounds:\n\n{table}");
            }
        }
        text
    }

    fn code(&self, family: &[Shaded]) -> MarkdownTable {
        let numbers =
            ["part", "ALU", "quarter-rate", "scalar", "texels", "bilinear", "trilinear", "bytes", "registers", "waves"];
        let mut columns = vec![("method", Align::Left)];
        columns.extend(numbers.map(|name| (name, Align::Right)));
        columns.push(("model cycles", Align::Right));
        let mut table = MarkdownTable::new(&columns);
        for shaded in family {
            let Pass { counts, vector_registers, waves, .. } = shaded.pass;
            let part = |part: &str, counts: Counts| {
                let bound = shaded.pass.cycles_of(&counts, shaded.family, self.texel.1);
                let mut row = vec![shaded.name(), part.to_owned()];
                row.extend(classes(&counts).map(|count| count.to_string()));
                row.extend([vector_registers.to_string(), waves.to_string(), range(bound)]);
                row
            };
            table.row(&part("fixed", counts.outside));
            if shaded.uses_samples {
                table.row(&part("a sample", counts.inside));
            }
        }
        table
    }

    fn bounds(&self, family: &[Shaded], card: &Card) -> MarkdownTable {
        let names: Vec<String> = family.iter().map(Shaded::name).collect();
        let columns = names.iter().map(|name| (name.as_str(), Align::Right));
        let columns: Vec<(&str, Align)> = std::iter::once(("N", Align::Right)).chain(columns).collect();
        let mut table = MarkdownTable::new(&columns);
        for samples in &self.sample_counts {
            let cells = family.iter().map(|shaded| range(self.milliseconds(shaded, card, *samples)));
            table.row(&std::iter::once(samples.to_string()).chain(cells).collect::<Vec<_>>());
        }
        table
    }

    /// How many samples each method that samples takes at the cost of each that does not.
    fn afforded(&self, family: &[Shaded]) -> Option<MarkdownTable> {
        let (sampling, fixed): (Vec<_>, Vec<_>) = family.iter().partition(|shaded| shaded.uses_samples);
        let names: Vec<String> = fixed.iter().map(|shaded| format!("at {}", shaded.name())).collect();
        let columns = names.iter().map(|name| (name.as_str(), Align::Right));
        let mut table =
            MarkdownTable::new(&std::iter::once(("method", Align::Left)).chain(columns).collect::<Vec<_>>());
        let texel = self.texel.1;
        for own in &sampling {
            let cells = fixed.iter().map(|other| {
                let [least, most] = own.pass.afforded(own.family, texel, other.pass.cycles(other.family, texel, 1));
                format!("{least} to {most}")
            });
            table.row(&std::iter::once(own.name()).chain(cells).collect::<Vec<_>>());
        }
        (!sampling.is_empty() && !fixed.is_empty()).then_some(table)
    }

    /// Both ends over N, a panel a card. `None` without two sample counts.
    pub fn figure(&self) -> Option<Figure> {
        let [first, .., last] = self.sample_counts[..] else { return None };
        let names: Vec<String> = self.families().next()?.iter().map(Shaded::name).collect();
        let mut panels: Vec<(String, Vec<Mark>, Vec<f64>)> = Vec::new();
        for family in self.families() {
            for card in family[0].family.cards {
                let (mut marks, mut values) = (Vec::new(), Vec::new());
                for (series, shaded) in family.iter().enumerate() {
                    let at: Vec<u32> = if shaded.uses_samples { self.sample_counts.clone() } else { vec![first, last] };
                    let bounds = at.iter().map(|n| (f64::from(*n), self.milliseconds(shaded, card, *n)));
                    let [least, most]: [Vec<[f64; 2]>; 2] = bounds
                        .map(|(n, bound)| ([n, bound.least], [n, bound.most]))
                        .unzip::<_, _, Vec<_>, Vec<_>>()
                        .into();
                    values.extend(least.iter().chain(&most).map(|point| point[1]));
                    marks.extend([least, most].map(|points| Mark::new(Shape::Line(points), series)));
                }
                panels.push((format!("{} ({})", card.name, family[0].family.generation.name), marks, values));
            }
        }
        let x = Scale::log("samples a pixel", self.sample_counts.iter().map(|n| f64::from(*n)))?;
        let y = Scale::log("model bound, ms", panels.iter().flat_map(|(_, _, values)| values.clone()))?;
        let panel = |(title, marks, _)| Panel { title, x: x.clone(), y: y.clone(), marks };
        let [width, height] = FRAME;
        Some(Figure {
            title: "What the specular pass costs, by a model of compiled code".to_owned(),
            note: format!(
                "Both ends of each bound, {width}x{height}, {} {} maps; no GPU was measured",
                self.layout, self.texel.0
            ),
            panels: panels.into_iter().map(panel).collect(),
            series: names.into_iter().map(|name| Series { name, is_dashed: false }).collect(),
            ramp: None,
        })
    }
}

/// Both ends in three digits.
fn range(bound: Bound) -> String {
    let short = |x: f64| {
        let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
        rounded.to_string()
    };
    format!("{} to {}", short(bound.least), short(bound.most))
}
