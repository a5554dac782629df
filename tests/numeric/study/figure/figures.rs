//! Figures that are hard to draw, and a reader of SVGs.

use crate::study::questions;
use roxmltree::{Document, Node, NodeId};
use splitsum::draw::figure::{Figure, Mark, Panel, Scale, ScaleKind, Series, Shape};

pub fn dots([x, y]: [ScaleKind; 2], points: &[[f64; 2]]) -> Figure {
    let scale = |kind: ScaleKind, label: &str| Scale {
        label: label.to_owned(),
        kind,
    };
    let marks = points
        .iter()
        .enumerate()
        .map(|(i, at)| Mark::new(Shape::Dot(*at), 0).tip(format!("dot {i}")));
    let panel = Panel {
        title: String::new(),
        x: scale(x, "x"),
        y: scale(y, "y"),
        marks: marks.collect(),
    };
    Figure {
        title: "Dots".to_owned(),
        note: "made".to_owned(),
        panels: vec![panel],
        series: series(&["a", "b", "c"]),
    }
}

fn series(names: &[&str]) -> Vec<Series> {
    names
        .iter()
        .map(|name| Series {
            name: (*name).to_owned(),
            is_dashed: name.ends_with("floor"),
            ink: None,
        })
        .collect()
}

/// Long names, shared numbers, and the figures of answers.
pub fn hard() -> Vec<Figure> {
    let made = [long(), shared()];
    made.into_iter().chain(questions::figures()).collect()
}

fn dots_of_nothing(title: &str) -> Figure {
    let note = "relMSE: mean of (image − reference)² / (reference² + 0.01), without a unit; 0 is \
                equal. Whiskers: 95 %";
    Figure {
        title: title.to_owned(),
        note: note.to_owned(),
        panels: Vec::new(),
        series: Vec::new(),
    }
}

/// Three methods with the same numbers.
pub fn shared() -> Figure {
    let points = [[0.1, 1.0], [0.5, 4.0], [0.9, 32.0]];
    let marks = (0..3).flat_map(|series| {
        let dots = points.map(|at| Mark::new(Shape::Dot(at), series).tip("dot"));
        [Mark::new(Shape::Line(points.to_vec()), series)]
            .into_iter()
            .chain(dots)
    });
    let (x, y) = (
        Scale::linear("n·v", [0.0, 1.0]).unwrap(),
        Scale::log("samples", [1.0, 32.0]).unwrap(),
    );
    let panel = Panel {
        title: "alpha 0.1".to_owned(),
        x,
        y,
        marks: marks.collect(),
    };
    let inks = [("sampling", Some(2)), ("textbook", Some(0)), ("ggx", None)];
    let series = inks
        .map(|(name, ink)| Series {
            name: name.to_owned(),
            is_dashed: false,
            ink,
        })
        .to_vec();
    Figure {
        panels: vec![panel.clone(), panel],
        series,
        ..dots_of_nothing("Shared")
    }
}

/// Everything has the longest name.
fn long() -> Figure {
    let name = |i: usize| {
        format!(
            "{i} a name that goes on and on, with commas, without an end in sight, {}",
            "w".repeat(90)
        )
    };
    let marks = (0..6).map(|i| Mark::new(Shape::Dot([i as f64, i as f64]), i).tip(name(i)));
    let steps = || Scale::steps(&name(99), (0..6).map(name).collect());
    let panel = Panel {
        title: name(7),
        x: steps(),
        y: steps(),
        marks: marks.collect(),
    };
    let series = (0..6)
        .map(|i| Series {
            name: name(i),
            is_dashed: false,
            ink: None,
        })
        .collect();
    Figure {
        title: name(1),
        note: name(2),
        panels: vec![panel.clone(), panel],
        series,
    }
}

/// Words that would end a text, an attribute, an element or a section.
pub fn hostile() -> Figure {
    let name = |place: &str| {
        format!("{place} <script>alert(1)</script> \"' & ]]> <!-- </svg> </title> --> &lt; {place}")
    };
    let steps = |place: &str| Scale::steps(&name(place), vec![name("s0"), name("s1")]);
    let shapes = [
        Shape::Dot([0.0, 1.0]),
        Shape::Line(vec![[0.0, 0.0], [1.0, 1.0]]),
        Shape::HorizontalBar {
            y: 0.0,
            base: 0.0,
            to: 1.0,
        },
        Shape::Whisker([0.0, 0.0], [0.0, 1.0]),
        Shape::HorizontalRule(1.0),
        Shape::VerticalRule(1.0),
    ];
    let mark = |(i, shape): (usize, Shape)| {
        Mark::new(shape, 0)
            .tip(name(&format!("tip {i}")))
            .cell(name("cell"))
    };
    let marks = shapes.into_iter().enumerate().map(mark).collect();
    let panel = Panel {
        title: name("panel"),
        x: steps("x"),
        y: steps("y"),
        marks,
    };
    let series = vec![Series {
        name: name("series"),
        is_dashed: false,
        ink: None,
    }];
    Figure {
        title: name("title"),
        note: name("note"),
        panels: vec![panel.clone(), panel],
        series,
    }
}

pub fn parse_label(text: &str) -> f64 {
    let digits = |c: char| {
        "⁰¹²³⁴⁵⁶⁷⁸⁹"
            .chars()
            .position(|d| d == c)
            .map(|d| (b'0' + d as u8) as char)
    };
    let plain = text.replace('\u{2212}', "-");
    let (start, raised): (String, String) = (
        plain
            .chars()
            .filter(|c| digits(*c).is_none() && *c != '⁻')
            .collect(),
        plain
            .chars()
            .filter_map(|c| if c == '⁻' { Some('-') } else { digits(c) })
            .collect(),
    );
    let exponent: i32 = if raised.is_empty() {
        0
    } else {
        raised.parse().unwrap()
    };
    match start.split_once("·10") {
        Some((factor, _)) => format!("{factor}e{exponent}").parse().unwrap(),
        None if raised.is_empty() => start.parse().unwrap(),
        None => format!("1e{exponent}").parse().unwrap(),
    }
}

pub struct Drawn {
    document: Document<'static>,
}

impl Drawn {
    pub fn new(text: &str) -> Self {
        // The document borrows its text, so the test leaks it.
        let text: &'static str = Box::leak(text.to_owned().into_boxed_str());
        Self {
            document: Document::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}")),
        }
    }

    pub fn document(&self) -> &Document<'static> {
        &self.document
    }

    fn all(&self) -> impl Iterator<Item = Node<'_, 'static>> {
        self.document.descendants()
    }

    pub fn marks(&self) -> Vec<NodeId> {
        let is_mark = |node: &Node| {
            node.attribute("class")
                .is_some_and(|class| class.split(' ').any(|name| name == "mark"))
        };
        self.all().filter(is_mark).map(|node| node.id()).collect()
    }

    pub fn attribute(&self, id: NodeId, key: &str) -> Option<String> {
        self.document
            .get_node(id)?
            .attribute(key)
            .map(str::to_owned)
    }

    /// Left, top, right and bottom of each panel, from its axes.
    pub fn panels(&self) -> Vec<[f64; 4]> {
        let borders = self.all().filter(|node| {
            node.tag_name().name() == "g" && node.attribute("role") == Some("group")
        });
        let border = |panel: Node| {
            let axis = panel
                .children()
                .find(|node| node.attribute("class") == Some("fig-axis"))
                .unwrap();
            let n = numbers(axis.attribute("d").unwrap());
            [n[0], n[1], n[4], n[3]]
        };
        borders.map(border).collect()
    }

    pub fn numbers_of_first_mark(&self) -> Vec<f64> {
        let mark = self.document.get_node(self.marks()[0]).unwrap();
        mark.children()
            .find_map(|node| node.attribute("d"))
            .map(numbers)
            .unwrap()
    }

    /// Starts of the panels' marks whose paths have a class.
    pub fn starts(&self, class: &str) -> Vec<[f64; 2]> {
        self.vertices_of(class)
            .into_iter()
            .map(|path| path[0])
            .collect()
    }

    pub fn vertices(&self, class: &str) -> Vec<[f64; 2]> {
        self.vertices_of(class).into_iter().flatten().collect()
    }

    /// Points of paths with absolute commands; parts with relative commands are skipped.
    fn vertices_of(&self, class: &str) -> Vec<Vec<[f64; 2]>> {
        let is_own = |node: &Node| {
            let in_panel = node
                .parent()
                .and_then(|mark| mark.parent())
                .is_some_and(|panel| panel.has_attribute("role"));
            in_panel
                && node
                    .attribute("class")
                    .is_some_and(|found| found.split(' ').any(|name| name == class))
        };
        let points = |node: Node| {
            let path = node.attribute("d").unwrap();
            let end = path
                .find(|c: char| c.is_ascii_lowercase())
                .unwrap_or(path.len());
            numbers(&path[..end])
                .chunks_exact(2)
                .map(|point| [point[0], point[1]])
                .collect()
        };
        // The legend's groups are children of the document's root, which has a role, too.
        self.all()
            .filter(|node| {
                node.ancestors()
                    .nth(2)
                    .is_some_and(|g| g.tag_name().name() == "g")
            })
            .filter(is_own)
            .map(points)
            .collect()
    }

    /// Where a text begins.
    pub fn text_position(&self, text: &str) -> [f64; 2] {
        let node = self
            .all()
            .find(|node| node.tag_name().name() == "text" && node.text() == Some(text))
            .unwrap_or_else(|| panic!("no text {text:?}"));
        ["x", "y"].map(|key| node.attribute(key).unwrap().parse().unwrap())
    }

    /// Where the sample of a series in the legend begins.
    pub fn legend_sample(&self, series: usize) -> [f64; 2] {
        let series = series.to_string();
        let is_sample = |node: &Node| {
            node.attribute("data-series") == Some(&series) && !node.has_attribute("data-tip")
        };
        let sample = self.all().find(is_sample).unwrap();
        let path = sample.first_element_child().unwrap();
        let start = numbers(path.attribute("d").unwrap());
        [start[0], start[1]]
    }

    pub fn dots(&self) -> Vec<[f64; 2]> {
        self.starts("fig-d")
    }

    /// Labels below a panel with the middle of each, from left to right.
    pub fn labels_below(&self, bottom: f64) -> Vec<(String, f64)> {
        let number = |node: &Node, key: &str| {
            node.attribute(key)
                .and_then(|text| text.parse::<f64>().ok())
        };
        let is_label = |node: &Node| {
            let is_near = number(node, "y").is_some_and(|y| y > bottom && y < bottom + 22.0);
            node.attribute("class") == Some("fig-muted")
                && node.attribute("text-anchor") == Some("middle")
                && is_near
        };
        let found = self
            .all()
            .filter(|node| node.tag_name().name() == "text")
            .filter(is_label);
        found
            .map(|node| (node.text().unwrap().to_owned(), number(&node, "x").unwrap()))
            .collect()
    }
}

fn numbers(path: &str) -> Vec<f64> {
    let spaced: String = path
        .chars()
        .map(|c| {
            if c.is_ascii_alphabetic() || c == ',' {
                ' '
            } else {
                c
            }
        })
        .collect();
    spaced
        .split_whitespace()
        .filter_map(|number| number.parse().ok())
        .collect()
}
