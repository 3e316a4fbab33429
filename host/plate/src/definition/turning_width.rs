//! The width that determines the turning point: along the arc that meets both edges at right angles, or straight
//! across.
//!
//! Between straight edges at an angle a wave has the exact shape f(r) cos(q theta/alpha): its fronts are arcs about the
//! point where the edges meet. An arc through the centre line at x has the half-length r alpha = W atan(W')/W', so the
//! wave turns where K times this length is q. Straight across, the width is W'^2/3 larger, and the turning point lies
//! W'^2/(3 d) too far from the driven end.
//!
//! Curved edges add one term of the same order, W''/W. It follows from the conformal map of the plate to a strip,
//! x + jz = F(xi + j eta), |eta| < 1, in which one mode obeys g_xixi + (K^2 <|F'|^2> - q^2) g = 0: to second order
//! in W', 2 c q^2 = 1/2 in (q/W)^2 (1 + W'^2 2/3 - 2 c W W''), which is k^2 + W''/(2 W) for every width mode. At a
//! curved supported edge of a plate in bending the moment condition changes as well (the Laplacian is (1 - nu) times
//! the edge's curvature times the normal slope, not zero): near the turning point this subtracts (1 - nu) W''/W from
//! k^2, and the sum is (2 nu - 1) W''/(2 W).

use crate::definition::giving_taper::GivingTaper;
use crate::definition::log_width::{LogTurningWidth, LogWidth, arc_to_width};
use crate::definition::model::Model;
use crate::definition::taper::WidthLaw;

/// The half-width of the plate that determines the turning point.
///
/// ```
/// use slipline_plate::{TurningWidth, preset};
///
/// let arc = preset("membrane").unwrap();
/// let plain = arc.with_turning_width(TurningWidth::Plain);
/// // The arc is shorter than the straight line across, so the same frequency turns earlier.
/// assert!(arc.turning_point_m(100.0) < plain.turning_point_m(100.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TurningWidth {
    /// W atan(W')/W', half the arc through the centre line that meets both edges at right angles, and the term of
    /// curved edges. Exact for straight edges; otherwise right to second order in W' at the turning point. Before the
    /// turning point k^2 is too large by the fraction (1/3 - 2/pi^2) W W'' = 0.13 W W''.
    #[default]
    Arc,
    /// W, straight across, as in the paper.
    Plain,
}

impl TurningWidth {
    /// Both, in the order in which messages list [`TurningWidth::word`].
    pub const ALL: [Self; 2] = [Self::Arc, Self::Plain];

    /// Its word in a plate file: `arc` or `plain`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Arc => "arc",
            Self::Plain => "plain",
        }
    }

    /// How the width is measured, for the end of a sentence.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Arc => "along the arc",
            Self::Plain => "straight across",
        }
    }

    /// b of the term b W''/(2 W) that curved edges add to k^2.
    pub(super) fn bend_weight(self, model: &Model) -> f64 {
        match (self, model) {
            (Self::Arc, Model::Membrane { .. } | Model::ShearHorizontal { .. }) => 1.0,
            (Self::Arc, Model::BendingSupported(bending)) => 2.0 * bending.poisson_ratio - 1.0,
            // Unknown in closed form: the arc alone removes two thirds of the distance to the two-dimensional solution.
            (Self::Arc, Model::BendingClamped(_)) | (Self::Plain, _) => 0.0,
        }
    }
}

/// The law of the turning half-width.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum TurningLaw {
    /// A law of the taper's kinds: straight across, along the arcs of a linear taper, or a curve through arcs.
    Width(WidthLaw),
    /// Along the arcs of an exponential taper: atan(d W)/d.
    ExponentialArc { log_width: f64, rate_per_m: f64 },
    /// Along the arcs between the edges of an exponential taper that give.
    GivingArc(GivingTaper),
}

/// Least number of intervals of the curve through the arcs of a sampled taper.
const ARC_INTERVALS: usize = 512;
/// Least fall of ln(arc) from point to point of a sampled taper: far below the resolution of any frequency.
const LEAST_FALL: f64 = 1e-12;

impl TurningLaw {
    pub(crate) fn new(width: &WidthLaw, length_m: f64, turning_width: TurningWidth) -> Self {
        match (turning_width, width) {
            (TurningWidth::Arc, &WidthLaw::Exponential { log_width, rate_per_m }) => {
                Self::ExponentialArc { log_width, rate_per_m }
            }
            (TurningWidth::Arc, &WidthLaw::Linear { half_width_m, fall }) => {
                let shorter = arc_to_width(fall);
                Self::Width(WidthLaw::Linear { half_width_m: half_width_m * shorter, fall: fall * shorter })
            }
            (TurningWidth::Arc, WidthLaw::Giving(taper)) if taper.arcs_fall() => Self::GivingArc(*taper),
            (TurningWidth::Arc, WidthLaw::Giving(_)) => {
                let curve = width.mapped(length_m, f64::INFINITY, |at| (at.value, at.slope));
                Self::new(&curve, length_m, turning_width)
            }
            (TurningWidth::Arc, WidthLaw::Curve { position, value, slope }) => {
                Self::Width(curve_of_arcs((position, value, slope), width, length_m))
            }
            (TurningWidth::Plain, width) => Self::Width(width.clone()),
        }
    }

    pub(crate) fn at(&self, x: f64) -> LogTurningWidth {
        match self {
            Self::GivingArc(taper) => taper.arc_at(x),
            Self::Width(law) => {
                let LogWidth { value, slope, .. } = law.at(x);
                LogTurningWidth { value, slope }
            }
            Self::ExponentialArc { log_width, rate_per_m } => {
                let steepness = rate_per_m * (log_width - rate_per_m * x).exp();
                let angle = steepness.atan();
                LogTurningWidth {
                    value: (angle / rate_per_m).ln(),
                    slope: -rate_per_m * steepness / ((1.0 + steepness * steepness) * angle),
                }
            }
        }
    }

    /// 1 over the turning half-width, 1/m, without the logarithm: a solver's grid evaluates it at thousands of places.
    pub(crate) fn reciprocal_at(&self, x: f64) -> f64 {
        match self {
            Self::Width(law) => (-law.at(x).value).exp(),
            Self::GivingArc(taper) => taper.reciprocal_arc_at(x),
            Self::ExponentialArc { log_width, rate_per_m } => {
                rate_per_m / (rate_per_m * (log_width - rate_per_m * x).exp()).atan()
            }
        }
    }

    /// The position where ln of the turning half-width has fallen to `target`, metres. The taper is continued on both
    /// sides; minus infinity if no width has an arc of that length.
    pub(crate) fn place_of(&self, target: f64) -> f64 {
        match self {
            Self::Width(law) => law.place_of(target),
            Self::GivingArc(taper) => taper.place_of_arc(target),
            Self::ExponentialArc { log_width, rate_per_m } => {
                let angle = rate_per_m * target.exp();
                if angle >= std::f64::consts::FRAC_PI_2 {
                    return f64::NEG_INFINITY;
                }
                (log_width - (angle.tan() / rate_per_m).ln()) / rate_per_m
            }
        }
    }
}

/// The arcs of a sampled taper or of a film as a monotone curve: at its points, and between points that are far apart.
///
/// Where the edges bend outward so sharply that the arc grows (a radius below two thirds of the half-width) no wave
/// turns: a wave that arrives there has already passed a shorter arc. There the curve keeps the shortest arc so far.
fn curve_of_arcs(
    (position, value, slope): (&[f64], &[f64], &[f64]),
    width: &WidthLaw,
    length_m: f64,
) -> WidthLaw {
    let longest = length_m / ARC_INTERVALS as f64;
    let mut arcs: Vec<[f64; 2]> = Vec::with_capacity(position.len() + ARC_INTERVALS);
    let mut shortest = f64::INFINITY;
    let mut add = |x: f64, value: f64, slope: f64| {
        let arc = value + arc_to_width(slope * value.exp()).ln();
        shortest = arc.min(shortest - LEAST_FALL);
        arcs.push([x, shortest]);
    };
    for (i, pair) in position.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        let parts = ((to - from) / longest).ceil().max(1.0);
        // At its own points the curve need not be searched; its slope is rounded as there.
        let step = to - from;
        add(from, value[i], step * slope[i] / step);
        for part in 1..parts as usize {
            let x = from + (to - from) * part as f64 / parts;
            let LogWidth { value, slope, .. } = width.at(x);
            add(x, value, slope);
        }
    }
    let last = position.len() - 1;
    add(position[last], value[last], slope[last]);
    WidthLaw::curve(arcs.iter().map(|arc| arc[0]).collect(), arcs.iter().map(|arc| arc[1]).collect())
}
