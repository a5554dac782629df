//! Words of causes, verdicts and parts: the only place where a judgement becomes text.

use super::cause::{
    Cause, CutSlip, GainSlip, Mips, ScaleFlag, ShForm, ShSlip, ShWindow, Turn, TurnAxis, Unknown,
    WidthSlip,
};
use super::clause::{Clause, joined, with_first};
use super::directions::TexelGrid;
use super::doubt::Doubt;
use super::doubt_words::{chain_clauses, doubt_clauses};
use super::faces::{FaceSlip, FaceTurn, MovedFace};
use super::fit::{Gain, KnownFactor};
use super::lobe::Lobe;
use super::mip_chain::MipSource;
use super::negative::NegativeTexels;
use super::sampled_lobe::SAMPLES;
use super::table_words;
use super::texel_words::{
    channels, conversion_words, copy_words, encoding_clause, source_clause, three_digits,
};
use super::verdict::{Part, PartVerdict, Quality, Verdict};
use crate::base::glsl::constants::{PREFILTER_WEIGHT_COSINE, PREFILTER_WEIGHT_NONE};
use crate::instrument::precompute::prefilter::Weight;
use std::fmt;

/// Names of a cube's faces, in its order.
const FACES: [&str; 6] = ["+x", "-x", "+y", "-y", "+z", "-z"];

impl Cause {
    /// Returns the word for the cause in JSON.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Unknown(_) => "unknown",
            Self::Doubt(Doubt::Axes(_)) => "axes",
            Self::Doubt(Doubt::TurnedFaces { .. }) => "faces",
            Self::Doubt(_) => "map",
            Self::Chain(_) => "levels",
            Self::Negative(_) => "negative",
            Self::Black | Self::BlackFaces(_) => "black",
            Self::Faces(FaceSlip::Axes(_)) => "axes",
            Self::Faces(_) => "faces",
            Self::Noise => "noise",
            Self::SlightlyOff => "small",
            Self::Width(_) => "width",
            Self::Gain(_) => "gain",
            Self::Cut(_) => "cut",
            Self::Source(_) => "source",
            Self::Channels(_) | Self::Copy(_) => "channels",
            Self::Encoding(_) => "encoding",
            Self::Colors(_) => "colors",
            Self::Turn(_) => "turn",
            Self::Weight(_) | Self::NoCosine => "weight",
            Self::Model(_) => "model",
            Self::Lobe(_) | Self::BlursAddUp => "lobe",
            Self::Mips(_) | Self::CoarseMips { .. } => "mips",
            Self::FacesAlone => "faces",
            Self::Flat => "flat",
            Self::Grid(_) => "shift",
            Self::Sh(ShSlip::Form(_)) => "order",
            Self::Sh(ShSlip::Axes(_)) => "axes",
            Self::Sh(ShSlip::NoCosine | ShSlip::CosineTwice) => "cosine",
            Self::Sh(ShSlip::Window(_)) => "window",
            Self::Table(slip) => table_words::kind(*slip),
        }
    }

    pub fn clauses(&self) -> Vec<Clause> {
        let clause = match self {
            Self::Unknown(unknown) => return unknown_clauses(*unknown),
            Self::Doubt(doubt) => return doubt_clauses(doubt),
            Self::Chain(slip) => return chain_clauses(slip),
            Self::BlackFaces(faces) => {
                let black = |face: &usize| Clause::new(format!("face {} is black", FACES[*face]));
                return faces.iter().map(black).collect();
            }
            Self::Faces(slip) => return face_clauses(slip),
            Self::Grid(grid) => return grid_clauses(*grid),
            Self::Sh(slip) => return sh_clauses(*slip),
            Self::Table(slip) => return table_words::clauses(*slip),
            Self::Negative(texels) => Clause::new(texels.to_string()),
            Self::Black => Clause::new("every texel is black"),
            Self::Noise => Clause::detailed("noise from texel to texel", "too few samples"),
            Self::SlightlyOff => Clause::new("slightly off"),
            Self::Width(slip) => width_clause(*slip),
            Self::Gain(slip) => gain_clause(*slip),
            Self::Cut(slip) => cut_clause(*slip),
            Self::Source(slip) => source_clause(*slip),
            Self::Channels(order) => {
                Clause::new(format!("channels in the order {}", channels(*order)))
            }
            Self::Copy(copy) => Clause::new(copy_words(*copy)),
            Self::Encoding(encoding) => encoding_clause(*encoding),
            Self::Colors(conversion) => Clause::new(conversion_words(*conversion)),
            Self::Turn(turn) => turn_clause(*turn),
            Self::Weight(weight) => weight_clause(weight),
            Self::NoCosine => Clause::new("not weighted by the cosine"),
            Self::Model(name) => Clause::detailed("of another model", format!("--brdf {name}")),
            Self::Lobe(lobe) => lobe_clause(*lobe),
            Self::BlursAddUp => Clause::detailed(
                "filtered from the level before it by its whole width",
                "blurs add up",
            ),
            Self::Mips(mips) => mips_clause(*mips),
            Self::CoarseMips { levels, source } => coarse_mips_clause(*levels, *source),
            Self::FacesAlone => {
                Clause::detailed("each face is filtered by itself", "lobes end at its edges")
            }
            Self::Flat => Clause::new("every texel has the same value"),
        };
        vec![clause]
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&joined(&self.clauses()))
    }
}

impl Cause {
    /// Whether both are printed alike: rounding hides small differences of the parameters.
    pub fn is_printed_as(&self, other: &Self) -> bool {
        self.kind() == other.kind() && self.clauses() == other.clauses()
    }
}

/// Writes causes as one sentence.
pub fn sentence(causes: &[Cause]) -> String {
    let clauses: Vec<Clause> = causes.iter().flat_map(Cause::clauses).collect();
    joined(&clauses)
}

impl Verdict {
    pub fn clauses(&self) -> Vec<Clause> {
        match self {
            Self::Good(quality) => vec![quality_clause(*quality)],
            Self::Wrong(causes) | Self::Unexplained(causes) => {
                causes.iter().flat_map(Cause::clauses).collect()
            }
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&joined(&self.clauses()))
    }
}

impl Verdict {
    /// Whether both are printed alike.
    pub fn is_printed_as(&self, other: &Self) -> bool {
        self.clauses() == other.clauses()
    }
}

fn quality_clause(quality: Quality) -> Clause {
    match quality {
        Quality::Map => Clause::new("good"),
        Quality::CoarseMap { between } => Clause::new(format!(
            "good at its texels, {:.1} % rms between them",
            100.0 * between.sqrt()
        )),
        Quality::Table => Clause::detailed("good", "below 1/255, a step of 8 bits"),
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Level(level) => write!(f, "level {level}"),
            Self::Levels(first, last) => write!(f, "levels {first} to {last}"),
            Self::Irradiance => f.write_str("irradiance"),
            Self::Sh => f.write_str("SH"),
            Self::Table => f.write_str("DFG table"),
            Self::Map(map) => map.fmt(f),
            Self::Widths => f.write_str("widths"),
        }
    }
}

impl PartVerdict {
    pub fn clauses(&self) -> Vec<Clause> {
        let if_fixed = if self.is_if_fixed { "if fixed, " } else { "" };
        let part = format!("{if_fixed}{}", self.part);
        with_first(self.verdict.clauses(), |clause| clause.under(part))
    }
}

impl fmt::Display for PartVerdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&joined(&self.clauses()))
    }
}

fn unknown_clauses(unknown: Unknown) -> Vec<Clause> {
    match unknown {
        Unknown::NoSlip => vec![Clause::new("no known slip explains it")],
        Unknown::Doubt => vec![Clause::new("its axes or its light do not fit")],
        Unknown::Mean { bias_rel } => vec![Clause::new(mean_words(bias_rel))],
        Unknown::OtherTable => vec![Clause::detailed(
            "no convention fits",
            "not a DFG table of this model, or encoded",
        )],
        Unknown::Table { max_error } => vec![
            Clause::new("no other convention fits better"),
            Clause::new(format!(
                "the largest error is {:.1} steps of 8 bits",
                255.0 * max_error
            )),
        ],
    }
}

impl fmt::Display for NegativeTexels {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [face, column, row] = self.texel;
        write!(
            f,
            "{} of {} texels are negative ({:.1} %), the lowest {:.2e} at face {face}, texel \
             {column},{row}",
            self.count,
            self.total,
            100.0 * self.count as f64 / self.total as f64,
            self.lowest
        )
    }
}

fn mean_words(bias_rel: f64) -> String {
    format!("its mean is off by {:+.0} %", 100.0 * bias_rel)
}

impl fmt::Display for FaceTurn {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::None => "unchanged",
            Self::Clockwise => "turned by 90° clockwise",
            Self::Half => "turned by 180°",
            Self::CounterClockwise => "turned by 90° counter-clockwise",
            Self::FlippedLeftRight => "flipped left to right",
            Self::FlippedTopBottom => "flipped top to bottom",
            Self::Transposed => "transposed",
            Self::AntiTransposed => "transposed across the other diagonal",
        })
    }
}

fn face_clauses(slip: &FaceSlip) -> Vec<Clause> {
    match slip {
        FaceSlip::Axes(axes) => vec![Clause::detailed("other axes", format!("--axes={axes}"))],
        FaceSlip::Every(turn) => {
            vec![Clause::new(format!("every face is {turn}"))]
        }
        FaceSlip::Swapped([a, b]) => vec![Clause::new(format!(
            "faces {} and {} are swapped",
            FACES[*a], FACES[*b]
        ))],
        FaceSlip::Reordered(faces) => vec![
            Clause::new(format!(
                "faces in the order {}",
                faces.map(|face| FACES[face]).join(" ")
            )),
            Clause::new(format!("expected {}", FACES.join(" "))),
        ],
        FaceSlip::Moved(moved) => moved.iter().map(|moved| moved_clause(*moved)).collect(),
    }
}

fn moved_clause(MovedFace { face, held }: MovedFace) -> Clause {
    let name = FACES[face];
    let held_name = FACES[held.face];
    let turn = held.turn;
    Clause::new(if held.face == face {
        format!("face {name} is {turn}")
    } else if held.turn == FaceTurn::None {
        format!("face {name} holds {held_name}")
    } else {
        format!("face {name} holds {held_name}, {turn}")
    })
}

fn width_clause(slip: WidthSlip) -> Clause {
    let widths = format!("(alpha {:.3} for {:.3})", slip.found_alpha, slip.alpha);
    Clause::new(match slip.shift {
        Some(shift) if shift > 0.0 => format!("{shift:.1} levels too blurred {widths}"),
        Some(shift) => format!("{:.1} levels too sharp {widths}", -shift),
        None if slip.found_alpha > slip.alpha => format!("too blurred {widths}"),
        None => format!("too sharp {widths}"),
    })
}

impl fmt::Display for Gain {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Self::Known(factor) => {
                let name = match factor {
                    KnownFactor::Pi => "pi",
                    KnownFactor::OverPi => "1/pi",
                    KnownFactor::FourPi => "4 pi",
                    KnownFactor::OverFourPi => "1/4pi",
                    KnownFactor::TwoPi => "2 pi",
                    KnownFactor::Two => "2",
                    KnownFactor::Half => "1/2",
                };
                write!(f, "times {name}")
            }
            Self::Power(power) => write!(f, "times {power}"),
            Self::Other(gain) if gain > 2.0 => {
                write!(f, "{:.0} % too bright", 100.0 * (gain - 1.0))
            }
            Self::Other(gain) if gain > 1.0 => {
                write!(f, "{:.1} % too bright", 100.0 * (gain - 1.0))
            }
            Self::Other(gain) => write!(f, "{:.1} % too dark", 100.0 * (1.0 - gain)),
        }
    }
}

fn gain_clause(slip: GainSlip) -> Clause {
    match slip {
        GainSlip::Sh(gain) => Clause::new(gain.to_string()),
        GainSlip::Level { gain, scale } => {
            let flag = match scale.flag {
                ScaleFlag::Radiance => "--scale",
                ScaleFlag::Irradiance => "--irradiance-scale",
            };
            let right = three_digits(scale.value / gain.value());
            Clause::detailed(gain.to_string(), format!("{flag} {right}"))
        }
        GainSlip::MeanWeight => Clause::detailed(
            "times the mean weight",
            "divide by the sum of the weights, not by their number",
        ),
        GainSlip::Channels(gains) => Clause::new(format!(
            "red, green and blue times {:.2}, {:.2} and {:.2}",
            gains.x, gains.y, gains.z
        )),
    }
}

fn cut_clause(slip: CutSlip) -> Clause {
    let text = format!("cut at {}", three_digits(slip.limit));
    match slip.bias_rel {
        Some(bias_rel) => Clause::detailed(text, mean_words(bias_rel)),
        None => Clause::new(text),
    }
}

fn turn_clause(Turn { axis, degrees }: Turn) -> Clause {
    let text = |axis: &str| format!("turned by {degrees:.0}° about {axis}");
    match axis {
        TurnAxis::X => Clause::new(text("x")),
        TurnAxis::Y => {
            Clause::detailed(text("y"), format!("lat-long offset {:.3}", degrees / 360.0))
        }
        TurnAxis::Z => Clause::new(text("z")),
    }
}

fn weight_clause(weight: &Weight) -> Clause {
    let text = match weight.code {
        PREFILTER_WEIGHT_NONE => "not weighted by n·l",
        PREFILTER_WEIGHT_COSINE => "weighted by n·l",
        _ => "weighted by G1 of l",
    };
    Clause::detailed(text, format!("--weight {}", weight.name))
}

fn lobe_clause(lobe: Lobe) -> Clause {
    match lobe {
        Lobe::HalfAsLight => Clause::detailed("half vectors taken as l", "reflect v about them"),
        Lobe::CosineTwice => Clause::new("weighted by n·l once too often"),
        Lobe::Gtr1 => Clause::new("lobe of GTR with gamma 1, as of coats"),
        Lobe::Sheen => Clause::new("lobe of sheen (Charlie)"),
        Lobe::PhongOfHalf => {
            Clause::new("Phong's lobe about r, of the exponent for h, 2/alpha² - 2")
        }
        Lobe::PhongQuarter => {
            Clause::new("Phong's lobe about r, of a quarter of the exponent for h")
        }
        Lobe::IrradianceWithoutSine => Clause::new("summed over θ and φ without sin θ"),
        Lobe::IrradianceCosineTwice => Clause::new("weighted by the cosine once too often"),
    }
}

fn mips_clause(mips: Mips) -> Clause {
    match mips {
        Mips::OfLevelBefore => Clause::detailed("the mean of the level before it", "plain mips"),
        Mips::OfEnvironment => Clause::detailed("plain mips", "not prefiltered"),
        Mips::OneLookup => Clause::new("one lookup a texel, not the mean over it"),
        Mips::OneLookupRounded => Clause::detailed(
            "one lookup a texel, of the pixel that is rounded to",
            "half a pixel off; floor the index",
        ),
    }
}

fn coarse_mips_clause(levels: f64, source: MipSource) -> Clause {
    let of_map = match source {
        MipSource::Cube => "",
        MipSource::LatLong => " of the lat-long map",
    };
    Clause::detailed(
        format!("samples read mips{of_map} {levels:.1} levels too blurred"),
        format!("if there are {SAMPLES}"),
    )
}

fn grid_clauses(grid: TexelGrid) -> Vec<Clause> {
    let found = match grid {
        TexelGrid::Centres => "texels at their centres, (i + 0.5)/n",
        TexelGrid::Corners => "texels at their corners, i/n",
        TexelGrid::FarCorners => "texels at their corners, (i + 1)/n",
        TexelGrid::NearFarCorners => "texels at their corners, columns at i/n, rows at (j + 1)/n",
        TexelGrid::FarNearCorners => "texels at their corners, columns at (i + 1)/n, rows at j/n",
        TexelGrid::EdgeToEdge => "texels at i/(n - 1), from edge to edge",
    };
    [found, "expected centres, (i + 0.5)/n"]
        .map(Clause::new)
        .to_vec()
}

fn sh_clauses(slip: ShSlip) -> Vec<Clause> {
    let clause = match slip {
        ShSlip::Form(form) => return form_clauses(form),
        ShSlip::Axes(axes) => {
            Clause::detailed(format!("axes {axes} fit"), format!("--axes={axes}"))
        }
        ShSlip::NoCosine => Clause::detailed("radiance", "not convolved with the cosine"),
        ShSlip::CosineTwice => Clause::new("convolved with the cosine once too often"),
        ShSlip::Window(ShWindow::NoDegree2) => Clause::new("degree 2 is missing"),
        ShSlip::Window(ShWindow::Falling([one, two])) => Clause::detailed(
            "windowed against ringing",
            format!("degree 1 times {one:.2}, degree 2 times {two:.2}"),
        ),
        ShSlip::Window(ShWindow::Other([one, two])) => {
            Clause::new(format!("degrees 1 and 2 times {one:.2} and {two:.2}"))
        }
    };
    vec![clause]
}

fn form_clauses(form: ShForm) -> Vec<Clause> {
    let texts: &[&str] = match form {
        ShForm::CondonShortley => &["odd m have the other sign, as by Condon and Shortley"],
        ShForm::Unscaled => &["not pre-scaled by the factors of the basis"],
        ShForm::Planar => &["numbers of one channel after the other", "expected triples"],
        ShForm::Descending => &["each degree is in the order m = l to -l"],
        ShForm::Xyz => &["degree 1 is in the order x, y, z", "expected y, z, x"],
        ShForm::Xzy => &["degree 1 is in the order x, z, y", "expected y, z, x"],
    };
    texts.iter().map(|text| Clause::new(*text)).collect()
}
