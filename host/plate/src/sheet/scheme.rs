//! The finite-difference scheme: the weights of the update, and the condition at the driven end.

use super::embedded_boundary::EmbeddedBoundary;
use super::grid::{EnvelopeScope, SheetGrid};
use super::kernel::Weights;
use super::source::{DriveCondition, SourceTerm};
use super::tiling::{Cells, Column, Plan, plan_of};

/// The quantities from which the weights of the update are computed.
pub(super) struct Scheme<'a> {
    pub(super) edge: &'a EmbeddedBoundary,
    pub(super) speed: f64,
    pub(super) step_s: f64,
    /// r of the damping term r v_t, 1/s.
    pub(super) damping: f64,
    pub(super) mirrored: bool,
    pub(super) grid: &'a SheetGrid,
}

impl Scheme<'_> {
    /// The update: (v+ - 2 v + v-)/dt^2 + r (v+ - v-)/(2 dt) = c^2 (second differences of v), solved for v+.
    pub(super) fn plan(&self, condition: DriveCondition) -> (Plan, SourceTerm) {
        let edge = self.edge;
        let along = (self.speed * self.step_s / edge.dx).powi(2);
        let across = (self.speed * self.step_s / edge.dz).powi(2);
        let loss = 0.5 * self.damping * self.step_s;
        let divisor = 1.0 + loss;
        let weights = Weights {
            own: ((2.0 - 2.0 * along - 2.0 * across) / divisor) as f32,
            past: ((1.0 - loss) / divisor) as f32,
            along: (along / divisor) as f32,
            across: (across / divisor) as f32,
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
            let held = along * (1.0 + edge.along_link(station, row)) + across * across_links(station, row);
            ((2.0 - held) / divisor) as f32
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
        let moves = if condition == DriveCondition::Displacement { 0.0 } else { 1.0 / (divisor + resisted) };
        let column_own = |row: usize| {
            let links = 2.0 * along * edge.along_link(0, row) + across * across_links(0, row);
            (moves * (2.0 - links)) as f32
        };
        let column = Column {
            own: rows.iter().map(|&row| column_own(row)).collect(),
            past: (moves * (1.0 - loss - resisted)) as f32,
            inward: (moves * 2.0 * along) as f32,
            across: (moves * across) as f32,
            profile: (0..rows.len())
                .map(|row| {
                    let from_centre = if self.mirrored { row as f64 } else { row as f64 - side as f64 };
                    self.grid.drive.at(from_centre / self.grid.across as f64) as f32
                })
                .collect(),
        };
        let recorded = match self.grid.envelope {
            EnvelopeScope::Everywhere => 0..rows.len(),
            EnvelopeScope::CentreLine if self.mirrored => 0..1,
            EnvelopeScope::CentreLine => side..side + 1,
        };
        let reach: Vec<usize> = rows.iter().map(|&row| edge.reach[row]).collect();
        let plain: Vec<usize> = rows.iter().map(|&row| edge.plain(row)).collect();
        let cells = Cells { reach: &reach, plain: &plain, own: &own_by_row, mirrored: self.mirrored };
        (plan_of(cells, weights, Some(column), recorded), term)
    }
}
