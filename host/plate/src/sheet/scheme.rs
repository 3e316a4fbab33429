//! The finite-difference scheme: the weights of the update, and the condition at the driven end.

use super::air_wave::AirWave;
use super::contact::{Contact, Load, TouchedCells};
use super::embedded_boundary::EmbeddedBoundary;
use super::grid::{EnvelopeScope, SheetGrid};
use super::kernel::Weights;
use super::source::{DriveCondition, SourceTerm};
use super::tiling::{Cells, Column, ColumnPoint, Plan, plan_of};

/// 2^-23: numbers below 2 that are multiples of it are exact in `f32`.
const GRAIN: f64 = 1.0 / (1 << 23) as f64;

/// The quantities from which the weights of the update are computed.
pub(super) struct Scheme<'a> {
    pub(super) edge: &'a EmbeddedBoundary,
    pub(super) wave: &'a AirWave,
    pub(super) step_s: f64,
    /// r of the damping term r v_t, 1/s.
    pub(super) damping: f64,
    pub(super) mirrored: bool,
    pub(super) grid: &'a SheetGrid,
    /// The finger on the sheet, if there is one.
    pub(super) contact: Option<&'a Contact>,
}

impl Scheme<'_> {
    /// The update: (v+ - 2 v + v-)/dt^2 + r (v+ - v-)/(2 dt) = c^2 (second differences of v + a v), solved for v+. In air a
    /// changes along the plate, and every cell has a weight of its own.
    pub(super) fn plan(&self, condition: DriveCondition) -> (Plan, SourceTerm) {
        let edge = self.edge;
        let speed = self.wave.speed_m_per_s;
        let along = (speed * self.step_s / edge.dx).powi(2);
        let across = (speed * self.step_s / edge.dz).powi(2);
        // The air's part: it counts in the own weight alone, 0 without air.
        let lift = |station: usize| (speed * self.step_s).powi(2) * self.wave.lift_per_m2(station);
        let loss = 0.5 * self.damping * self.step_s;
        let divisor = 1.0 + loss;
        // Where the field is constant, an update must keep it to the last bit: what the rounding of the four weights
        // leaves of it is a restoring force that the sheet has not, and in a step of omega dt it counts 1/(omega dt)^2
        // times. On whole multiples of GRAIN the own weight, 1 + past - 2 along - 2 across, is not rounded.
        let rounded = |weight: f64| (weight / divisor / GRAIN).round() * GRAIN;
        let weight = (rounded(1.0 - loss), rounded(along), rounded(across));
        let own_of = |links_along: f64, links_across: f64, lift: f64| {
            (1.0 + weight.0 - weight.1 * links_along - weight.2 * links_across + lift / divisor) as f32
        };
        let weights = Weights {
            own: own_of(2.0, 2.0, 0.0),
            past: weight.0 as f32,
            along: weight.1 as f32,
            across: weight.2 as f32,
        };
        let side = edge.rows() - 1;
        let rows: Vec<usize> = if self.mirrored {
            (0..=side).collect()
        } else {
            (0..2 * side + 1).map(|row| row.abs_diff(side)).collect()
        };
        // Weights of the links from a point to its two neighbours in z. On the centre line both are outward.
        let across_links = |station: usize, row: usize| {
            let outward = edge.across_link(station, row);
            if row == 0 { 2.0 * outward } else { 1.0 + outward }
        };
        let own = |station: usize, row: usize| {
            own_of(1.0 + edge.along_link(station, row), across_links(station, row), lift(station))
        };
        let own_by_row: Vec<Vec<f32>> = rows
            .iter()
            .map(|&row| (1..=edge.reach[row]).map(|station| own(station, row)).collect())
            .collect();

        // The driven column is half a cell wide: v_tt = c^2 (2/dx ((v1 - v0)/dx - v_x(0)) + v_zz).
        let (resisted, term) = match condition {
            DriveCondition::Displacement => (0.0, SourceTerm::Value),
            DriveCondition::Force { slope_per_m } => {
                (0.0, SourceTerm::Scaled(2.0 * along * edge.dx * slope_per_m / divisor))
            }
            DriveCondition::Resistance { rho_s_per_m } => {
                let b = along * edge.dx * rho_s_per_m / self.step_s;
                (b, SourceTerm::Change(2.0 * b / (divisor + b)))
            }
        };
        let moves = if condition == DriveCondition::Displacement { 0.0 } else { 1.0 };
        let load = |station: usize, row: usize| match self.contact {
            Some(contact) => contact.load(edge, station, row, self.step_s, self.wave),
            None => Load::default(),
        };
        let point = |number: usize, row: usize| {
            let links = 2.0 * along * edge.along_link(0, row) + across * across_links(0, row);
            let load = load(0, row);
            let inertia = divisor + resisted + load.mass + load.loss;
            // A source moves the end less under a finger; a held displacement stays.
            let pushed = if moves > 0.0 { (divisor + resisted) / inertia } else { 1.0 };
            let from_centre = if self.mirrored { number as f64 } else { number as f64 - side as f64 };
            ColumnPoint {
                own: (moves * (2.0 + 2.0 * load.mass - links + lift(0)) / inertia) as f32,
                past: (moves * (1.0 + load.mass - loss - load.loss - resisted) / inertia) as f32,
                inward: (moves * 2.0 * along / inertia) as f32,
                across: (moves * across / inertia) as f32,
                profile: (pushed * self.grid.drive.at(from_centre / self.grid.across as f64)) as f32,
            }
        };
        let column =
            Column { points: rows.iter().enumerate().map(|(number, &row)| point(number, row)).collect() };
        let recorded = match self.grid.envelope {
            EnvelopeScope::Everywhere => 0..rows.len(),
            EnvelopeScope::CentreLine if self.mirrored => 0..1,
            EnvelopeScope::CentreLine => side..side + 1,
        };
        let reach: Vec<usize> = rows.iter().map(|&row| edge.reach[row]).collect();
        let plain = |row: usize| if self.wave.is_lifted() { 0 } else { edge.plain(row) };
        let plain: Vec<usize> = rows.iter().map(|&row| plain(row)).collect();
        let cells = Cells { reach: &reach, plain: &plain, own: &own_by_row, mirrored: self.mirrored };
        let mut plan = plan_of(cells, weights, Some(column), recorded);
        plan.touched = self
            .contact
            .map(|_| TouchedCells::new(&reach, loss, |number, cell| load(cell + 1, rows[number])));
        (plan, term)
    }
}
