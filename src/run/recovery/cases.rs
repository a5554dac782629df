//! Which cells of a plan are photos, and which are images of candidates.

use crate::experiment::axis::{
    ALBEDO, ALPHA, AXES, AxisId, ENVIRONMENT_ORIENTATION, F0, METALLIC, Part, Point,
};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::run::results::Results;
use indexmap::IndexMap;
use std::collections::BTreeMap;

/// Images of one surface by one method: a cell by the orientation of the light.
pub type Images<'p> = BTreeMap<u32, &'p Cell>;

/// The values that a fit recovers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Perceptual roughness.
    pub roughness: f64,
    pub f0: f64,
}

/// A surface in one light, and everything rendered of it.
#[derive(Debug, Default)]
pub struct Case<'p> {
    pub truths: Vec<Truth<'p>>,
    pub candidates: Vec<Candidate<'p>>,
}

#[derive(Debug)]
pub struct Truth<'p> {
    pub surface: Surface,
    pub photos: Images<'p>,
}

impl<'p> Truth<'p> {
    pub fn first_cell(&self) -> &'p Cell {
        self.photos.values().next().expect("at least one photo")
    }
}

/// A method with its parameters, and its images.
#[derive(Debug)]
pub struct Candidate<'p> {
    surfaces: Vec<(Surface, Images<'p>)>,
}

/// The images of a candidate at one width, at its least and its largest F0.
pub type Width<'c, 'p> = (f64, [(f64, &'c Images<'p>); 2]);

impl<'p> Candidate<'p> {
    pub fn first_cell(&self) -> &'p Cell {
        let (_, images) = &self.surfaces[0];
        images.values().next().expect("at least one image")
    }

    /// The widths with images under all orientations at two values of F0, by roughness.
    pub fn widths(&self, orientations: &[u32]) -> Vec<Width<'_, 'p>> {
        let is_whole = |images: &Images| orientations.iter().all(|one| images.contains_key(one));
        let mut whole: Vec<&(Surface, Images)> = self
            .surfaces
            .iter()
            .filter(|(_, images)| is_whole(images))
            .collect();
        whole.sort_by(|(a, _), (b, _)| {
            let by_roughness = a.roughness.total_cmp(&b.roughness);
            by_roughness.then(a.f0.total_cmp(&b.f0))
        });
        let at_widths = whole.chunk_by(|(a, _), (b, _)| a.roughness == b.roughness);
        at_widths
            .filter_map(|surfaces| {
                let ((a, images_a), (b, images_b)) = (surfaces.first()?, surfaces.last()?);
                let ends = [(a.f0, images_a), (b.f0, images_b)];
                (b.f0 > a.f0).then_some((a.roughness, ends))
            })
            .collect()
    }
}

/// The cases of the finished cells.
pub fn cases<'p>(plan: &'p Plan, results: &Results) -> Vec<Case<'p>> {
    of_cells(plan.cells.iter().filter(|cell| results.is_done(cell)))
}

/// The cases of a plan whose cells are all done.
pub fn planned(plan: &Plan) -> Vec<Case<'_>> {
    of_cells(plan.cells.iter())
}

/// The images of a method by the values that a fit recovers.
type Surfaces<'p> = IndexMap<[Value; 2], (Surface, Images<'p>)>;

fn of_cells<'p>(cells: impl Iterator<Item = &'p Cell>) -> Vec<Case<'p>> {
    let mut cases: IndexMap<Vec<Value>, IndexMap<Vec<Value>, Surfaces>> = IndexMap::new();
    for cell in cells {
        let Some(surface) = surface(&cell.point) else {
            continue;
        };
        let reflectance = reflectance(&cell.point);
        let key = [&cell.point[ALPHA], &cell.point[reflectance]].map(Value::clone);
        let (_, images) = cases
            .entry(fixed(&cell.point, |part| part == Part::Case))
            .or_default()
            .entry(fixed(&cell.point, |part| part != Part::Display))
            .or_default()
            .entry(key)
            .or_insert_with(|| (surface, Images::new()));
        // The first tone curve is enough: images are linear.
        images.entry(orientation(&cell.point)).or_insert(cell);
    }
    cases.into_values().map(case).collect()
}

/// The photos and the candidates among the images of a case, by method and parameters.
fn case(methods: IndexMap<Vec<Value>, Surfaces>) -> Case {
    let mut case = Case::default();
    for surfaces in methods.into_values() {
        let are_photos = surfaces.values().any(|(_, images)| {
            let mut cells = images.values();
            cells.any(|cell| cell.point.method().is_reference())
        });
        if are_photos {
            let truths = surfaces.into_values();
            case.truths
                .extend(truths.map(|(surface, photos)| Truth { surface, photos }));
        } else {
            case.candidates.push(Candidate {
                surfaces: surfaces.into_values().collect(),
            });
        }
    }
    case
}

/// The axis of the reflectance at normal incidence: a metal's is its albedo.
pub fn reflectance(point: &Point) -> AxisId {
    if point[METALLIC] == Value::Number(1.0) {
        ALBEDO
    } else {
        F0
    }
}

/// `None` if a value is not set, or not grey.
fn surface(point: &Point) -> Option<Surface> {
    Some(Surface {
        roughness: point[ALPHA].size()?.sqrt(),
        f0: point[reflectance(point)].size()?,
    })
}

fn orientation(point: &Point) -> u32 {
    match point[ENVIRONMENT_ORIENTATION] {
        Value::Count(index) => index,
        _ => 0,
    }
}

/// The values of axes of some parts, without those that a fit recovers or pools.
fn fixed(point: &Point, is_counted: impl Fn(Part) -> bool) -> Vec<Value> {
    let free = [ALPHA, reflectance(point), ENVIRONMENT_ORIENTATION];
    AXES.ids()
        .filter(|axis| is_counted(AXES[*axis].part) && !free.contains(axis))
        .map(|axis| point[axis].clone())
        .collect()
}
