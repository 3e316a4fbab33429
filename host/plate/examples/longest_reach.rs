//! Search for the membrane whose felt edge can be put on the largest share of its length with every light green: how the
//! first preset plate of the app was found.
//!
//! `cargo run --release -p slipline-plate --example longest_reach`
//!
//! It tries two laws of the half-width for a membrane of one weight, tension and length. The exponential one has an
//! edge that grows narrower along the plate. The other, 1/W^2 = 1/W0^2 + 2 c x, has W'/W^3 = -c and so the same edge
//! width everywhere: (2 K^2 d)^(-1/3) with K = (pi/2)/W and d = -W'/W is (4.93 c)^(-1/3).

use slipline_plate::Model;
use slipline_plate::check::{Checker, Colour, Conditions};
use slipline_plate::feeling::{Feeling, FeltEdge, FeltTone};
use slipline_plate::{DriveEnd, DriveTable, Equation, Plate, PlateSpec, Taper, preset, respond};
use std::error::Error;

const LENGTH_M: f64 = 0.32;
const WAVE_SPEED: f64 = 8.0;
/// Polyester of 36 um with tungsten shot of 3 mm (0.256 g each) in rows of 3 mm.
const SURFACE_DENSITY: f64 = 28.4;
const FULL_SCALE_M: f64 = 1.6e-5;
/// Half-widths at the driven and at the narrow end that are tried, mm.
const WIDE_MM: [f64; 5] = [11.0, 12.0, 13.0, 14.0, 16.0];
const NARROW_MM: [f64; 5] = [4.2, 4.4, 4.5, 4.6, 4.8];
/// Boundaries that are judged on each plate.
const PLACES: usize = 33;
/// Points of the even law: a cubic through them follows it to 1e-5.
const POINTS: usize = 17;

#[derive(Debug, Clone, Copy)]
enum Law {
    Exponential,
    EvenEdge,
}

impl Law {
    fn taper(self, wide_m: f64, narrow_m: f64) -> Taper {
        match self {
            Self::Exponential => {
                Taper::Exponential { half_width_m: wide_m, rate_per_m: (wide_m / narrow_m).ln() / LENGTH_M }
            }
            Self::EvenEdge => {
                let inverse = |width_m: f64| width_m.powi(-2);
                let at =
                    |share: f64| (inverse(wide_m) + share * (inverse(narrow_m) - inverse(wide_m))).powf(-0.5);
                // Whole micrometres, as they are drawn.
                let point = |i: usize| {
                    let share = i as f64 / (POINTS - 1) as f64;
                    [LENGTH_M * share, (at(share) * 1e6).round() * 1e-6]
                };
                Taper::Sampled { points: (0..POINTS).map(point).collect() }
            }
        }
    }
}

/// A plate of this law, with a drive that is matched in the middle of its band.
fn plate(law: Law, wide_m: f64, narrow_m: f64, span_m: (f64, f64)) -> Result<Plate, Box<dyn Error>> {
    let model = Model::Membrane {
        wave_speed_m_per_s: WAVE_SPEED,
        tension_n_per_m: Some(SURFACE_DENSITY * WAVE_SPEED.powi(2)),
        film: None,
    };
    let spec = PlateSpec {
        name: "candidate".to_owned(),
        taper: law.taper(wide_m, narrow_m),
        length_m: LENGTH_M,
        model,
        drive_end: DriveEnd::Displacement,
        loss_factor: 0.005,
        loss_tolerance: Some(0.3),
        full_scale_m: FULL_SCALE_M,
        span_start_m: span_m.0,
        span_end_m: span_m.1,
        ..preset("membrane").ok_or("no such preset")?.spec().clone()
    };
    let (low_hz, high_hz) = Plate::new(spec.clone())?.band_hz();
    let at_frequency_hz = (low_hz * high_hz).sqrt().round();
    Ok(Plate::new(PlateSpec { drive_end: DriveEnd::Resistance { ratio: 1.0, at_frequency_hz }, ..spec })?)
}

/// The longest run of boundaries with every light green, metres; `None` if there is none. `names` counts what fails.
fn green_run(plate: &Plate, names: &mut Vec<&'static str>) -> Result<Option<(f64, f64)>, Box<dyn Error>> {
    let checker = Checker::new(plate, Conditions::default())?;
    let (start_m, end_m) = plate.span_m();
    let mut run: Option<(f64, f64)> = None;
    let mut best: Option<(f64, f64)> = None;
    for i in 0..PLACES {
        let x_m = start_m + (end_m - start_m) * i as f64 / (PLACES - 1) as f64;
        let report = checker.at(x_m)?;
        if report.worst() > Colour::Green {
            names.extend(report.lights.iter().filter(|light| light.colour > Colour::Green).map(|l| l.name));
            run = None;
            continue;
        }
        run = Some((run.map_or(x_m, |run| run.0), x_m));
        let length = |run: Option<(f64, f64)>| run.map_or(-1.0, |(from_m, to_m)| to_m - from_m);
        if length(run) > length(best) {
            best = run;
        }
    }
    Ok(best)
}

/// Where a tone of level 1 with this turning point is felt to, metres.
fn felt_edge_m(plate: &Plate, table: &DriveTable, turns_m: f64) -> Option<f64> {
    let frequency_hz = plate.frequency_for_boundary_hz(turns_m);
    let response = respond(plate, frequency_hz, 801, Equation::Corrected).ok()?;
    let scale = table.peak_at_full_scale_m() / response.peak?.amplitude;
    let squares: Vec<f64> = response.amplitude.iter().map(|at| 0.5 * (at.norm() * scale).powi(2)).collect();
    let strength = Feeling::default().strength(plate, &[FeltTone { frequency_hz, squares: &squares }]);
    match Feeling::edge(plate, &strength) {
        FeltEdge::At(place_m) => Some(place_m),
        FeltEdge::PlateEnd | FeltEdge::Nowhere => None,
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut best = 0.0;
    for law in [Law::EvenEdge, Law::Exponential] {
        for wide_mm in WIDE_MM {
            for narrow_mm in NARROW_MM {
                let (wide_m, narrow_m) = (1e-3 * wide_mm, 1e-3 * narrow_mm);
                let mut failed = Vec::new();
                let whole = plate(law, wide_m, narrow_m, (0.02, 0.95 * LENGTH_M))?;
                // The level of the table is that of the span, so the lights are judged again over the green one.
                let first = green_run(&whole, &mut failed)?;
                failed.sort_unstable();
                failed.dedup();
                let Some(run) = first.filter(|run| run.1 > run.0) else {
                    println!("{law:?} {wide_mm} to {narrow_mm} mm: none, {failed:?}");
                    continue;
                };
                let plate = plate(law, wide_m, narrow_m, run)?;
                let mut again = Vec::new();
                let Some((from_m, to_m)) = green_run(&plate, &mut again)? else { continue };
                let table = DriveTable::build(&plate, 400e3, 129)?;
                let felt = [from_m, to_m].map(|turns_m| felt_edge_m(&plate, &table, turns_m));
                let [Some(near_m), Some(far_m)] = felt else {
                    println!("{law:?} {wide_mm} to {narrow_mm} mm: felt to the plate's end");
                    continue;
                };
                let reach = (far_m - near_m) / LENGTH_M;
                let mark = if reach > best { " <" } else { "" };
                best = reach.max(best);
                println!(
                    "{law:?} {wide_mm} to {narrow_mm} mm: turns at {:.0} to {:.0} mm, felt to {:.0} to {:.0} mm, {:.0} % of the length{mark}; \
                     then {failed:?}",
                    from_m * 1e3,
                    to_m * 1e3,
                    near_m * 1e3,
                    far_m * 1e3,
                    100.0 * reach,
                );
            }
        }
    }
    Ok(())
}
