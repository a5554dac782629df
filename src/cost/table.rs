//! Tables of the counts of compiled passes.

use super::family::Family;
use super::isa::Counts;
use super::pass::Pass;
use crate::base::csv::{Cell, to_text};
use crate::draw::markdown::{Align, MarkdownTable};

#[derive(Debug)]
pub struct Shaded {
    pub family: &'static Family,
    /// Name and version of the compiling driver.
    pub driver: String,
    pub method: &'static str,
    /// Empty if the method does not use the model.
    pub brdf: &'static str,
    pub layout: &'static str,
    /// Other axes that were set: `masking=separable`.
    pub options: String,
    pub uses_samples: bool,
    pub pass: Pass,
}

/// A class of instructions or lookups that is counted.
struct Class {
    /// Name of its columns, without the part of the code.
    column: &'static str,
    heading: &'static str,
    about: &'static str,
}

const fn class(column: &'static str, heading: &'static str, about: &'static str) -> Class {
    Class {
        column,
        heading,
        about,
    }
}

/// In the order of [`classes`].
const CLASSES: [Class; 7] = [
    class("alu", "ALU", "Full-rate vector instructions a pixel"),
    class(
        "quarter_rate",
        "quarter-rate",
        "Quarter-rate vector instructions a pixel",
    ),
    class("scalar", "scalar", "Scalar instructions a wave"),
    class("unfiltered", "texels", "Texels a pixel without a filter"),
    class("bilinear", "bilinear", "Lookups a pixel in one level"),
    class(
        "trilinear",
        "trilinear",
        "Lookups a pixel between two levels",
    ),
    class("memory_bytes", "buffer bytes", "Bytes of buffers a pixel"),
];

fn classes(counts: &Counts) -> [f64; 7] {
    let Counts {
        alu,
        quarter,
        scalar,
        unfiltered,
        bilinear,
        trilinear,
        memory_bytes,
    } = *counts;
    [
        alu,
        quarter,
        scalar,
        unfiltered,
        bilinear,
        trilinear,
        memory_bytes,
    ]
}

const FIRST: [(&str, &str); 8] = [
    ("driver", "Name and version of the driver that compiled."),
    ("family", "Family of GPUs."),
    ("generation", "Its generation."),
    ("card", "A card of the family."),
    ("method", "Specular method."),
    (
        "brdf",
        "Microfacet model; empty if the code does not depend on it.",
    ),
    ("layout", "Layout of the filtered maps."),
    ("options", "Other axes that were set, `name=value`."),
];

const LAST: [(&str, &str); 4] = [
    ("other_loops", "Loops of unknown length; counted once."),
    ("wave", "Lanes of a wave."),
    ("vector_registers", "Vector registers of a lane."),
    (
        "waves",
        "Waves per vector unit, as Mesa counts them: on RDNA waves of 32 lanes.",
    ),
];

pub fn columns() -> Vec<(String, String)> {
    let known = |columns: &[(&str, &str)]| {
        columns
            .iter()
            .map(|(name, about)| (name.to_string(), about.to_string()))
            .collect()
    };
    let parts = [
        ("outside", "outside the loop over samples, once a dispatch"),
        ("inside", "inside it, once a sample"),
    ];
    let counted = parts.map(|(part, when)| {
        CLASSES.map(|Class { column, about, .. }| {
            (format!("{part}_{column}"), format!("{about}, {when}."))
        })
    });
    [known(&FIRST), counted.concat(), known(&LAST)].concat()
}

pub fn csv(passes: &[Shaded]) -> Vec<u8> {
    let names: Vec<String> = columns().into_iter().map(|(name, _)| name).collect();
    let row = |shaded: &Shaded| {
        let Shaded {
            family,
            driver,
            method,
            brdf,
            layout,
            options,
            uses_samples: _,
            pass,
        } = shaded;
        let words = [
            driver,
            family.name,
            family.generation,
            family.card,
            method,
            brdf,
            layout,
            options,
        ];
        let numbers = [&pass.counts.outside, &pass.counts.inside]
            .map(classes)
            .concat();
        let compiled = [
            pass.counts.other_loops as u32,
            pass.wave,
            pass.vector_registers,
            pass.waves,
        ];
        let numbers = numbers
            .into_iter()
            .map(Cell::from)
            .chain(compiled.map(Cell::from));
        words
            .map(Cell::from)
            .into_iter()
            .chain(numbers)
            .collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Cell>> = passes.iter().map(row).collect();
    to_text(&names, rows.iter().map(Vec::as_slice)).to_vec()
}

/// Writes a table per family: the fixed part of each pass, and the part per sample.
pub fn markdown(passes: &[Shaded]) -> String {
    let tables = passes
        .chunk_by(|a, b| a.family.name == b.family.name)
        .map(|family| {
            let Family {
                name,
                generation,
                card,
                ..
            } = family[0].family;
            format!(
                "## {name}: {generation}, {card} ({})\n\n{}",
                family[0].driver,
                table(family)
            )
        });
    let tables: Vec<String> = tables.collect();
    format!(
        "Counts of compiled code, a pixel: nothing was executed or timed (docs/cost.md).\n\n{}",
        tables.join("\n")
    )
}

fn table(family: &[Shaded]) -> MarkdownTable {
    let numbers = CLASSES
        .iter()
        .map(|class| class.heading)
        .chain(["registers", "waves"]);
    let columns = numbers.map(|name| (name, Align::Right));
    let mut table = MarkdownTable::new(
        &[("method", Align::Left), ("part", Align::Left)]
            .into_iter()
            .chain(columns)
            .collect::<Vec<_>>(),
    );
    for shaded in family {
        let Pass {
            counts,
            vector_registers,
            waves,
            ..
        } = &shaded.pass;
        let mut part = |part: &str, counts: &Counts| {
            let numbers = classes(counts).map(|count| count.to_string());
            let code = [vector_registers, waves].map(u32::to_string);
            table.row(
                &[
                    vec![shaded.name(), part.to_owned()],
                    numbers.to_vec(),
                    code.to_vec(),
                ]
                .concat(),
            );
        };
        part("fixed", &counts.outside);
        if shaded.uses_samples {
            part("a sample", &counts.inside);
        }
    }
    table
}

impl Shaded {
    fn name(&self) -> String {
        let values = self
            .options
            .split_whitespace()
            .filter_map(|option| Some(option.split_once('=')?.1));
        let words = [self.method, self.brdf]
            .into_iter()
            .chain(values)
            .filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join(" ")
    }
}
