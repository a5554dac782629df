//! What methods cost by the model of [`crate::cost`], as table, text and figure.

use crate::cost::child::Compiler;
use crate::cost::family::{FRAME, Family, Texel};
use crate::cost::isa::Counts;
use crate::cost::model::{Bound, Pass};
use crate::figure::ink::SERIES;
use crate::figure::{Figure, Mark, Panel, Scale, Series, Shape};
use crate::run::columns::{Column, column};
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
    pub layout: &'static str,
    /// What else was asked for and changes its code: `masking=uncorrelated`.
    pub options: String,
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
}

/// The caveat that stands wherever numbers do.
pub const CAVEAT: &str = "A model, not a measurement: no GPU ran. A bound lies between perfect overlap of all units and none, with full \
                          waves and maps that stay in caches (docs/cost.md).";

/// Methods of a figure: as many as have a colour of their own.
const DRAWN_MAX: usize = SERIES.len();

/// Numbers that are counted, in the order of [`classes`].
const CLASSES: [(&str, &str); 8] = [
    ("alu", "Full-rate vector instructions a pixel"),
    ("quarter_rate", "Quarter-rate vector instructions a pixel"),
    ("scalar", "Scalar instructions a wave"),
    ("unfiltered", "Texels a pixel without a filter"),
    ("bilinear", "Lookups a pixel in one level"),
    ("trilinear", "Lookups a pixel between two levels"),
    ("memory_bytes", "Bytes of buffers a pixel"),
    ("dram_bytes", "Bytes of memory that a dispatch streams a pixel"),
];

fn classes(counts: &Counts) -> [f64; 8] {
    let Counts { alu, quarter, scalar, unfiltered, bilinear, trilinear, memory_bytes, dram_bytes } = *counts;
    [alu, quarter, scalar, unfiltered, bilinear, trilinear, memory_bytes, dram_bytes]
}

const FIRST: &[Column] = &[
    column("driver", "Name and version of the driver that compiled."),
    column("family", "Family of GPUs."),
    column("generation", "Its generation."),
    column("card", "The card that stands for the family."),
    column("method", "Specular method."),
    column("brdf", "Microfacet model; empty where the code does not hang on it."),
    column("layout", "Layout of the filtered maps."),
    column("options", "Other axes that were set and change the code, `name=value`."),
    column("texel", "How the maps' texels are stored."),
    column("samples", "Samples a pixel; empty for methods without."),
];

const LAST: &[Column] = &[
    column("other_loops", "Loops whose length the assembly does not tell; counted once."),
    column("wave", "Lanes of a wave."),
    column("vector_registers", "Vector registers of a lane."),
    column("waves", "Waves that a vector unit can hold, as Mesa counts them: on RDNA waves of 32 lanes."),
    column("busiest_unit", "The unit that sets the lower end."),
    column(
        "model_cycles_least",
        "Cycles of a compute unit a pixel, lower end of the model's bound, at the boost clock.",
    ),
    column("model_cycles_most", "The upper end, at the game clock."),
    column("model_ms_least", "Milliseconds for 1920x1080 on the card, lower end."),
    column("model_ms_most", "The upper end."),
];

/// The columns of `costs.csv` with their meaning.
pub fn columns() -> Vec<(String, String)> {
    let known = |columns: &[Column]| -> Vec<(String, String)> {
        columns.iter().map(|column| (column.name.to_owned(), column.about.to_owned())).collect()
    };
    let counted =
        [("outside", "outside the loop over samples, once a dispatch"), ("inside", "inside it, once a sample")].map(
            |(part, place)| CLASSES.map(|(class, about)| (format!("{part}_{class}"), format!("{about}, {place}."))),
        );
    [known(FIRST), counted.concat(), known(LAST)].concat()
}

impl Shaded {
    fn name(&self) -> String {
        let values = self.options.split_whitespace().filter_map(|option| Some(option.split_once('=')?.1));
        let words = [self.method, self.brdf].into_iter().chain(values).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join(" ")
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

    fn milliseconds(&self, shaded: &Shaded, samples: u32) -> Bound {
        shaded.pass.cycles(shaded.family, self.texel.1, samples).milliseconds(&shaded.family.card)
    }

    /// One row a pass and sample count.
    pub fn csv(&self) -> Vec<u8> {
        let names: Vec<String> = columns().into_iter().map(|(name, _)| name).collect();
        let row = |shaded: &Shaded, samples: u32| {
            let Shaded { family, compiler, method, brdf, layout, options, uses_samples, pass } = shaded;
            let (generation, card, texel) = (family.generation.name, family.card.name, self.texel.0);
            let words = [&compiler.driver, family.name, generation, card, method, brdf, layout, options, texel];
            let numbers = [&pass.counts.outside, &pass.counts.inside].map(classes).concat().into_iter().map(Cell::from);
            let cycles = pass.cycles(&family.at_boost(), self.texel.1, samples);
            let time = self.milliseconds(shaded, samples);
            let bounds = [cycles.least, cycles.most, time.least, time.most].map(Cell::from);
            let compiled = [pass.wave, pass.vector_registers, pass.waves].map(Cell::from);
            let words = words.into_iter().map(Cell::from).chain([uses_samples.then_some(samples).into()]);
            words
                .chain(numbers)
                .chain([pass.counts.other_loops.into()])
                .chain(compiled)
                .chain([pass.busiest(family, self.texel.1, samples).into()])
                .chain(bounds)
                .collect::<Vec<Cell>>()
        };
        let of_pass = |shaded| Shaded::counts(shaded, &self.sample_counts).iter().map(move |n| row(shaded, *n));
        let rows: Vec<Vec<Cell>> = self.shaded.iter().flat_map(of_pass).collect();
        to_text(&names, rows.iter().map(Vec::as_slice)).to_vec()
    }

    /// Two tables a family: its code, and the bounds of each card.
    pub fn markdown(&self) -> String {
        let [width, height] = FRAME;
        let mut text = format!("{CAVEAT}\n");
        for family in self.families() {
            let (Family { name, generation, card, .. }, driver) = (family[0].family, &family[0].compiler.driver);
            text += &format!("\n## {}: {name}, {} ({driver}, {} maps)\n", card.name, generation.name, self.texel.0);
            text += &format!("\nInstructions a pixel: fixed, then a sample.\n\n{}", self.code(family));
            text += &format!("\nModel bound for {width}x{height}, ms:\n\n{}", self.bounds(family));
            if let Some(table) = self.afforded(family) {
                text += &format!("\nSamples a pixel at equal model cost, between the ends of both bounds:\n\n{table}");
            }
        }
        text
    }

    fn code(&self, family: &[Shaded]) -> MarkdownTable {
        let numbers = [
            "part",
            "ALU",
            "quarter-rate",
            "scalar",
            "texels",
            "bilinear",
            "trilinear",
            "buffer bytes",
            "memory bytes",
            "registers",
            "waves",
        ];
        let mut columns = vec![("method", Align::Left)];
        columns.extend(numbers.map(|name| (name, Align::Right)));
        columns.push(("model cycles at boost", Align::Right));
        let mut table = MarkdownTable::new(&columns);
        for shaded in family {
            let Pass { counts, vector_registers, waves, .. } = shaded.pass;
            let part = |part: &str, counts: Counts| {
                let bound = shaded.pass.cycles_of(&counts, &shaded.family.at_boost(), self.texel.1);
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

    fn bounds(&self, family: &[Shaded]) -> MarkdownTable {
        let names: Vec<String> = family.iter().map(Shaded::name).collect();
        let columns = names.iter().map(|name| (name.as_str(), Align::Right));
        let columns: Vec<(&str, Align)> = std::iter::once(("N", Align::Right)).chain(columns).collect();
        let mut table = MarkdownTable::new(&columns);
        for samples in &self.sample_counts {
            let cells = family.iter().map(|shaded| range(self.milliseconds(shaded, *samples)));
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
                let card = own.family.at_boost();
                let [least, most] = own.pass.afforded(&card, texel, other.pass.cycles(&card, texel, 1));
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
            let (mut marks, mut values) = (Vec::new(), Vec::new());
            for (series, shaded) in family.iter().enumerate().take(DRAWN_MAX) {
                let at: Vec<u32> = if shaded.uses_samples { self.sample_counts.clone() } else { vec![first, last] };
                let bounds = at.iter().map(|n| (f64::from(*n), self.milliseconds(shaded, *n)));
                let [least, most]: [Vec<[f64; 2]>; 2] =
                    bounds.map(|(n, bound)| ([n, bound.least], [n, bound.most])).unzip::<_, _, Vec<_>, Vec<_>>().into();
                values.extend(least.iter().chain(&most).map(|point| point[1]));
                marks.extend([least, most].map(|points| Mark::new(Shape::Line(points), series)));
            }
            let Family { card, generation, .. } = family[0].family;
            panels.push((format!("{} ({})", card.name, generation.name), marks, values));
        }
        let left_out = match names.len() {
            all if all > DRAWN_MAX => format!("; the first {DRAWN_MAX} of {all} methods"),
            _ => String::new(),
        };
        let x = Scale::log("samples a pixel", self.sample_counts.iter().map(|n| f64::from(*n)))?;
        let y = Scale::log("model bound, ms", panels.iter().flat_map(|(_, _, values)| values.clone()))?;
        let panel = |(title, marks, _)| Panel { title, x: x.clone(), y: y.clone(), marks };
        let [width, height] = FRAME;
        Some(Figure {
            title: "What the specular pass costs, by a model of compiled code".to_owned(),
            note: format!(
                "Both ends of each bound, {width}x{height}, {} maps{left_out}; no GPU was measured",
                self.texel.0
            ),
            panels: panels.into_iter().map(panel).collect(),
            series: names.into_iter().take(DRAWN_MAX).map(|name| Series { name, is_dashed: false }).collect(),
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
