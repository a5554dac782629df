//! A minimum of a function of one variable, by Brent's method [Brent73, chapter 5].
//!
//! The next place is the vertex of the parabola through the three best ones, if it is inside the
//! interval and the steps shrink; otherwise the golden section of the longer part. A smooth minimum
//! takes a third of the values of the golden section alone, a kink at most as many.

/// The smaller part of an interval that is cut by the golden section.
const GOLDEN_PART: f64 = 0.381_966_011_250_105;

#[derive(Clone, Copy)]
struct Sample {
    x: f64,
    value: f64,
}

/// Narrows an interval until a minimum of a function that falls and then rises there is within
/// `tolerance` of the best place, and returns this place, which is inside the interval.
pub fn minimum(f: impl Fn(f64) -> f64, [lo, hi]: [f64; 2], tolerance: f64) -> f64 {
    let sample = |x: f64| Sample { x, value: f(x) };
    // At the end the best place is at most two of the least steps from both ends.
    let least_step = 0.5 * tolerance;
    let (mut lo, mut hi) = (lo, hi);
    let mut best = sample(lo + GOLDEN_PART * (hi - lo));
    let (mut second, mut third) = (best, best);
    let [mut step, mut step_before] = [0.0_f64; 2];
    while (best.x - lo).max(hi - best.x) > tolerance {
        let middle = 0.5 * (lo + hi);
        let vertex = vertex_step([best, second, third])
            .filter(|to| to.abs() < 0.5 * step_before.abs() && (lo..hi).contains(&(best.x + to)));
        step_before = step;
        if let Some(to_vertex) = vertex {
            let is_near_end = (best.x + to_vertex - lo).min(hi - best.x - to_vertex) < tolerance;
            step = if is_near_end {
                least_step.copysign(middle - best.x)
            } else {
                to_vertex
            };
        } else {
            step_before = if best.x < middle { hi } else { lo } - best.x;
            step = GOLDEN_PART * step_before;
        }
        let next = sample(best.x + step.abs().max(least_step).copysign(step));
        let is_left = next.x < best.x;
        if next.value <= best.value {
            *if is_left { &mut hi } else { &mut lo } = best.x;
            (best, second, third) = (next, best, second);
        } else {
            *if is_left { &mut lo } else { &mut hi } = next.x;
            if next.value <= second.value || second.x == best.x {
                (second, third) = (next, second);
            } else {
                third = next;
            }
        }
    }
    best.x
}

/// The step from the best place to the vertex of the parabola through three places; `None` if they
/// are on a line, or two of them are the same.
fn vertex_step([best, second, third]: [Sample; 3]) -> Option<f64> {
    let [a, b] = [second, third].map(|other| other.x - best.x);
    let [rise_a, rise_b] = [second, third].map(|other| other.value - best.value);
    let curvature = 2.0 * (a * rise_b - b * rise_a);
    let step = (a * a * rise_b - b * b * rise_a) / curvature;
    (curvature != 0.0 && a != b && step.is_finite()).then_some(step)
}
