//! The driven end of a bending plate with clamped edges, with all waves of the strip and polynomials across the
//! width.
//!
//! The waves of a strip between clamped edges have different shapes across the width ([`strip_waves`]), so the end's
//! conditions are stated for each polynomial p_i. An agent at x = 0 of a plate on x > 0 exerts on w = sum w_i p_i
//!
//! ```text
//! on w_i:    F =  D (W w''' - (2 - nu) B w'/W)      Kirchhoff's force
//! on w_i':   M = -D (W w'' - nu B w/W)              the moment
//! ```
//! The source acts on the projection on the width mode at its cut-off: its force on w_i is F P_i, and its deflection
//! is the sum of P_i w_i. The propagating wave enters by p(0) and p'(0), the other 2 N - 1 waves by their amplitudes.
//! With the drive this makes 2 N unknowns for 2 N conditions, linear in p(0) and p'(0). Some of the other waves may
//! propagate: a higher width mode travels to its own turning point and returns
//! ([`turning_wave`](super::turning_wave)). The others decay from the end, and the strip has the width of the end:
//! the change of the taper within the reach of that near field, less than W, is neglected.

use super::DrivenEnd;
use super::near_field::{Course, Decay, NearField, NearWave};
use super::one_mode::source_force;
use super::strip_waves::{ORDERS, Section, Wave, section};
use super::turning_wave::{ModeLaw, TurningWave};
use crate::definition::impedance::Impedance;
use crate::definition::plate::Plate;
use crate::definition::source::{EndSlope, LeadIn, Source};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

const ROWS: usize = 2 * ORDERS;
/// Largest |ds/dt| of an evanescent wave; away from where two waves meet it is 1 to 2.
const SLOPE_MOST: f64 = 2.0;

/// The strip at the driven end at one frequency.
struct Strip {
    section: &'static Section,
    omega: f64,
    half_width: f64,
    /// K^2 without loss, 1/m^2.
    lossless: f64,
    /// K^2 with loss, 1/m^2.
    axial: Complex64,
    /// 1 + j eta of the plate's own stiffness.
    compliance: Complex64,
    /// D without loss, N m. With shear and rotary inertia, the value that gives the correct power of the wave.
    rigidity: f64,
    poisson: f64,
}

/// Value, slope, force and moment for each polynomial.
struct End {
    value: DVector<Complex64>,
    turn: DVector<Complex64>,
    force: DVector<Complex64>,
    moment: DVector<Complex64>,
}

impl Strip {
    fn new(plate: &Plate, frequency_hz: f64) -> Self {
        let omega = TAU * frequency_hz;
        let model = &plate.spec().model;
        let lossless = plate.wavenumber_squared(frequency_hz);
        let vacuum = TAU * plate.vacuum_frequency_hz(frequency_hz);
        // a K^2 of the width mode contains the factor a.
        let rise = plate.axial_rise(frequency_hz) / plate.width_mode(1).slope;
        let surface_density = model.surface_density("a source").unwrap_or(f64::NAN);
        Self {
            section: section(),
            omega,
            // The turning width, so that the waves of the end equal those of the plate.
            half_width: plate.turning_half_width_m(0.0),
            lossless,
            axial: lossless * plate.lossy(frequency_hz),
            compliance: plate.lossy_compliance(frequency_hz),
            rigidity: surface_density * vacuum / (lossless * rise),
            poisson: model.bending().map_or(f64::NAN, |bending| bending.poisson_ratio),
        }
    }

    /// D for a wavenumber K^2 = `axial` with loss in vacuum: K^4 D is real.
    fn lossy_rigidity(&self, axial: Complex64) -> Complex64 {
        let ratio = self.lossless / axial;
        self.rigidity * ratio * ratio
    }

    /// D of the plate, with its own loss.
    fn own_rigidity(&self) -> Complex64 {
        self.lossy_rigidity(self.lossless * self.compliance)
    }

    /// The waves for K^2 = `axial`; `propagating` is k^2 of the first, 1/m^2.
    fn waves(&self, axial: Complex64, propagating: Complex64) -> Vec<Wave> {
        let square = self.half_width * self.half_width;
        self.section.waves(axial * square, self.half_width, propagating * square)
    }

    /// The conditions at x = 0 on w with the derivatives `w`[n] of order n, all with the shape `shape`: the force and
    /// the moment that an agent must exert.
    fn end(&self, rigidity: Complex64, shape: &DVector<Complex64>, w: [Complex64; 4]) -> End {
        let across = self.section.slope.map(Complex64::from) * shape / Complex64::from(self.half_width);
        let along = shape * Complex64::from(self.half_width);
        End {
            value: shape * w[0],
            turn: shape * w[1],
            force: (&along * w[3] - &across * (w[1] * (2.0 - self.poisson))) * rigidity,
            moment: -(&along * w[2] - &across * (w[0] * self.poisson)) * rigidity,
        }
    }

    /// The same for a wave.
    fn wave_end(&self, rigidity: Complex64, wave: &Wave) -> End {
        let rate = Complex64::I * wave.wavenumber;
        self.end(rigidity, &wave.shape, [Complex64::ONE, rate, rate * rate, rate * rate * rate])
    }

    /// P P^T x: the generalised forces of an agent that opposes the motion of the width mode with unit stiffness.
    fn on_mode(&self, value: &DVector<Complex64>) -> DVector<Complex64> {
        let share: Complex64 = value.iter().zip(&self.section.projection).map(|(w, p)| w * p).sum();
        self.section.projection.map(|p| share * p)
    }
}

/// One of the waves at the driven end that do not propagate.
struct Beside {
    /// Its value on the centre line.
    centre: Complex64,
    course: Course,
}

/// A wave that does not propagate, with its conditions at the end. `number` is that of its width mode if it
/// propagates and returns.
fn beside(strip: &Strip, plate: &Plate, wave: &Wave, number: Option<u32>) -> (Beside, End) {
    let rigidity = strip.own_rigidity();
    let square = wave.wavenumber * wave.wavenumber;
    let Some(number) = number else {
        // k^2 = s/W^2 with s linear in t = (W K)^2. Where two waves meet, their slopes are infinite, but only at that
        // point: the slope is limited for the plate beyond it.
        let slope = wave.slope / (wave.slope.norm() / SLOPE_MOST).max(1.0);
        let axial = -slope * strip.axial;
        let course = Course::DiesOut(Decay { axial, across: -square - axial });
        return (Beside { centre: wave.centre, course }, strip.wave_end(rigidity, wave));
    };
    let area = strip.half_width * strip.half_width;
    let law = ModeLaw::new(plate, number, area.recip(), strip.axial * area, [square * area, wave.slope]);
    let rate = TurningWave::slope_per_m(&law, plate);
    let end = strip.end(rigidity, &wave.shape, [Complex64::ONE, rate, -square, -square * rate]);
    (Beside { centre: wave.centre, course: Course::Turns(law) }, end)
}

/// The number of the width mode (3, 5, ..) of `near[index]` if that wave propagates: the wavenumbers of the even
/// modes fall in the order of their numbers.
fn number_of_running(near: &[Wave], index: usize) -> Option<u32> {
    let square = |wave: &Wave| (wave.wavenumber * wave.wavenumber).re;
    let own = square(&near[index]);
    let before = near.iter().filter(|wave| square(wave) > own).count();
    (own > 0.0).then_some(2 * before as u32 + 3)
}

/// The columns of the conditions: p(0), p'(0) and each of the other waves.
struct Columns {
    ends: Vec<End>,
    near: Vec<Beside>,
}

impl Columns {
    /// `narrowing_per_m` is W'/W at x = 0; 0 for the straight strip of the end's width, on which no wave returns.
    fn new(strip: &Strip, plate: &Plate, narrowing_per_m: f64, propagating: Complex64) -> Self {
        let mut waves = strip.waves(strip.axial, propagating);
        let rigidity = strip.own_rigidity();
        let near = waves.split_off(1);
        let shape = waves.first().map_or_else(|| DVector::zeros(ORDERS), |wave| &wave.shape / wave.centre);
        // Because p'' = -k^2 p.
        let by_value = [Complex64::ONE, Complex64::ZERO, -propagating, Complex64::ZERO];
        let by_slope = [Complex64::ZERO, Complex64::ONE, Complex64::ZERO, -propagating];
        let mut ends = vec![strip.end(rigidity, &shape, by_value), strip.end(rigidity, &shape, by_slope)];
        let number = |i: usize| if narrowing_per_m == 0.0 { None } else { number_of_running(&near, i) };
        let waves = near.iter().enumerate().map(|(i, wave)| beside(strip, plate, wave, number(i)));
        let (near, near_ends): (Vec<Beside>, Vec<End>) = waves.unzip();
        ends.extend(near_ends);
        Self { ends, near }
    }

    /// The end whose conditions are `first` = `drive` x drive and `second` = 0 for each polynomial.
    fn solve(
        &self,
        first: impl Fn(&End) -> DVector<Complex64>,
        second: impl Fn(&End) -> DVector<Complex64>,
        drive: &DVector<Complex64>,
    ) -> DrivenEnd {
        let column = |end: &End| {
            let (first, second) = (first(end), second(end));
            DVector::from_iterator(ROWS, first.iter().chain(second.iter()).copied())
        };
        let columns: Vec<DVector<Complex64>> = self.ends.iter().map(column).collect();
        let mut matrix = DMatrix::<Complex64>::zeros(ROWS, ROWS);
        for (index, column) in columns[2..].iter().enumerate() {
            matrix.set_column(index, column);
        }
        for (row, drive) in drive.iter().enumerate() {
            matrix[(row, ROWS - 1)] = -drive;
        }
        let mut right = DMatrix::<Complex64>::zeros(ROWS, 2);
        right.set_column(0, &-&columns[0]);
        right.set_column(1, &-&columns[1]);
        // Rows are scaled to one size: force and moment differ by a length.
        for row in 0..ROWS {
            let size = matrix.row(row).iter().map(|term| term.norm()).fold(f64::MIN_POSITIVE, f64::max);
            matrix.row_mut(row).scale_mut(size.recip());
            right.row_mut(row).scale_mut(size.recip());
        }
        let found = matrix.lu().solve(&right).unwrap_or_else(|| DMatrix::zeros(ROWS, 2));
        let waves = self.near.iter().enumerate().map(|(index, &Beside { centre, course })| NearWave {
            per_value: found[(index, 0)] * centre,
            per_slope: found[(index, 1)] * centre,
            course,
        });
        DrivenEnd {
            alpha: found[(ROWS - 1, 0)],
            beta: found[(ROWS - 1, 1)],
            drive: Complex64::ONE,
            near: NearField { waves: waves.collect() },
        }
    }
}

/// k^2 of the propagating wave with loss at x = 0.
fn propagating(plate: &Plate, frequency_hz: f64) -> Complex64 {
    plate.width_mode(1).lossy_wavenumber_squared(0.0, frequency_hz)
}

/// An end whose deflection is that of the width mode, 1 on the centre line, and whose slope is free or held.
pub(super) fn moved(plate: &Plate, frequency_hz: f64, narrowing_per_m: f64, slope: EndSlope) -> DrivenEnd {
    let strip = Strip::new(plate, frequency_hz);
    let columns = Columns::new(&strip, plate, narrowing_per_m, propagating(plate, frequency_hz));
    let drive = strip.section.mode.map(Complex64::from);
    columns.solve(
        |end| end.value.clone(),
        |end| match slope {
            EndSlope::Held => end.turn.clone(),
            EndSlope::Free => end.moment.clone(),
        },
        &drive,
    )
}

/// An end on which a source acts, with its lead-in behind it.
pub(super) fn sourced(plate: &Plate, frequency_hz: f64, narrowing_per_m: f64, source: &Source) -> DrivenEnd {
    let losses = source.lead_in.map(|lead_in| lead_in.loss_factor);
    Sourced::new(plate, frequency_hz, narrowing_per_m, losses.as_slice()).with(source)
}

/// The driven end without its source: everything that does not depend on the source.
pub(super) struct Sourced<'a> {
    plate: &'a Plate,
    strip: Strip,
    columns: Columns,
    /// Strips with the loss factors of the lead-ins.
    behind: Vec<LossyStrip>,
}

/// The strip of a lead-in.
struct LossyStrip {
    loss_factor: f64,
    rigidity: Complex64,
    waves: Vec<Wave>,
}

impl<'a> Sourced<'a> {
    /// `losses` are the loss factors of the lead-ins.
    pub(super) fn new(plate: &'a Plate, frequency_hz: f64, narrowing_per_m: f64, losses: &[f64]) -> Self {
        let strip = Strip::new(plate, frequency_hz);
        let propagating = propagating(plate, frequency_hz);
        let columns = Columns::new(&strip, plate, narrowing_per_m, propagating);
        let behind = losses.iter().map(|&loss_factor| LossyStrip::new(&strip, loss_factor, propagating));
        Self { plate, columns, behind: behind.collect(), strip }
    }

    /// The end with `source`, whose lead-in has one of the loss factors.
    pub(super) fn with(&self, source: &Source) -> DrivenEnd {
        let Self { plate, strip, columns, .. } = self;
        let behind = source.lead_in.and_then(|lead_in| {
            let lossy = self.behind.iter().find(|lossy| lossy.loss_factor == lead_in.loss_factor)?;
            Some(lossy.dynamic_stiffness(strip, &lead_in))
        });
        let load = source.impedance.dynamic_stiffness(strip.omega);
        let loaded = |end: &End| -> (DVector<Complex64>, DVector<Complex64>) {
            let mut force = &end.force + strip.on_mode(&end.value) * load;
            let mut moment = end.moment.clone();
            if let Some(behind) = &behind {
                let motion = DVector::from_iterator(ROWS, end.value.iter().chain(end.turn.iter()).copied());
                let reaction = behind * motion;
                force += reaction.rows(0, ORDERS);
                moment += reaction.rows(ORDERS, ORDERS);
            }
            (force, moment)
        };
        let drive = strip.section.projection.map(|share| source_force(plate, source) * share);
        columns.solve(
            |end| loaded(end).0,
            |end| match source.slope {
                Some(EndSlope::Held) => end.turn.clone(),
                Some(EndSlope::Free) | None => loaded(end).1,
            },
            &drive,
        )
    }
}

impl LossyStrip {
    fn new(strip: &Strip, loss_factor: f64, propagating: Complex64) -> Self {
        // D (1 - j eta) at the same K^4 D: K^2 varies as the inverse root.
        let axial = strip.lossless / Complex64::new(1.0, -loss_factor).sqrt();
        Self { loss_factor, rigidity: strip.lossy_rigidity(axial), waves: strip.waves(axial, propagating) }
    }

    /// The forces on (w_i, w_i') at the junction that move the strip behind it, per unit of w_i and of w_i'.
    ///
    /// With y = -x the strip is y = 0..l. Each wave leads away from one of the ends; at the far end the moment is
    /// zero and a damper takes the force on the width mode.
    fn dynamic_stiffness(&self, strip: &Strip, lead_in: &LeadIn) -> DMatrix<Complex64> {
        let Self { rigidity, waves, .. } = self;
        let damper = -Impedance::damper(lead_in.end_resistance_n_s_per_m).dynamic_stiffness(strip.omega);
        let mut conditions = DMatrix::<Complex64>::zeros(2 * ROWS, 2 * ROWS);
        let mut forces = DMatrix::<Complex64>::zeros(ROWS, 2 * ROWS);
        for (index, wave) in waves.iter().enumerate() {
            let through = (Complex64::I * wave.wavenumber * lead_in.length_m).exp();
            for (column, near, far, wavenumber) in [
                (2 * index, Complex64::ONE, through, wave.wavenumber),
                (2 * index + 1, through, Complex64::ONE, -wave.wavenumber),
            ] {
                let directed = Wave { wavenumber, shape: wave.shape.clone(), ..*wave };
                let end = strip.wave_end(*rigidity, &directed);
                // The agent at the far end is on the other side: -F is the damper's force j omega R w.
                let far_force = &end.force + strip.on_mode(&end.value) * damper;
                for row in 0..ORDERS {
                    conditions[(row, column)] = near * end.value[row];
                    conditions[(ORDERS + row, column)] = near * end.turn[row];
                    conditions[(ROWS + row, column)] = far * far_force[row];
                    conditions[(ROWS + ORDERS + row, column)] = far * end.moment[row];
                    forces[(row, column)] = near * end.force[row];
                    forces[(ORDERS + row, column)] = near * end.moment[row];
                }
            }
        }
        let mut right = DMatrix::<Complex64>::zeros(2 * ROWS, ROWS);
        right.fill_diagonal(Complex64::ONE);
        for row in 0..2 * ROWS {
            let size = conditions.row(row).iter().map(|term| term.norm()).fold(f64::MIN_POSITIVE, f64::max);
            conditions.row_mut(row).scale_mut(size.recip());
            right.row_mut(row).scale_mut(size.recip());
        }
        let amplitude = conditions.lu().solve(&right).unwrap_or_else(|| DMatrix::zeros(2 * ROWS, ROWS));
        let mut stiffness = forces * amplitude;
        // y = -x reverses the signs of w' and of the force on it.
        for row in 0..ROWS {
            for column in 0..ROWS {
                if (row < ORDERS) != (column < ORDERS) {
                    stiffness[(row, column)] = -stiffness[(row, column)];
                }
            }
        }
        stiffness
    }
}
