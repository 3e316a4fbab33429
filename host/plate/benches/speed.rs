//! Speed of the plate simulators, in ratios: threads against one, grids against each other, simulated against real
//! time. `benches/peers/compare.py` runs the same problems on NumPy, numba, Devito and scipy and prints one table.
//!
//! `cargo bench -p slipline-plate --bench speed` prints it; with `-- --lines` as tab-separated lines:
//! problem, engine, value, unit, check (a number that depends on the result, to compare with the others').

use slipline_plate::EnvelopeScope;
use slipline_plate::FdtdGrid;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::check::{Checker, Conditions};
use slipline_plate::texture::{Palette, TONES_MAX, Target, Texture};
use slipline_plate::{
    DriveTable, Equation, Model, Plate, Progress, SensedPlate, Sheet, SheetGrid, TimeDomainLine, preset,
    presets, respond_batch,
};
use std::f32::consts::PI;
use std::time::{Duration, Instant};

/// Grids of the FDTD problem (cells x rows inside fixed edges) and steps per run.
const GRIDS: [(usize, usize, usize); 3] = [(128, 32, 960), (512, 128, 384), (2048, 512, 32)];
/// (c dt/h)^2 of the FDTD problem.
const COURANT_SQUARED: f32 = 0.25;
/// Time for which each problem is repeated; the fastest run counts. A run lasts a few milliseconds, so even on a busy
/// machine some runs are not interrupted.
const REPEAT: Duration = Duration::from_millis(1200);

struct Report {
    lines: bool,
    repeat: Duration,
}

impl Report {
    fn row(&self, problem: &str, engine: &str, value: f64, unit: &str, check: f64, note: &str) {
        if self.lines {
            println!("{problem}\t{engine}\t{value}\t{unit}\t{check}");
        } else {
            println!("{problem:<28} {engine:<20} {value:>9.1} {unit:<9} {note}");
        }
    }

    /// Duration of the fastest run, which is the one least disturbed by other programs.
    fn fastest(&self, mut run: impl FnMut()) -> Duration {
        let begin = Instant::now();
        let mut fastest = Duration::MAX;
        while fastest == Duration::MAX || begin.elapsed() < self.repeat {
            let start = Instant::now();
            run();
            fastest = fastest.min(start.elapsed());
        }
        fastest
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    // Without `--bench` (as `cargo test --benches` calls it) one run shows that everything works.
    let repeat = if has("--bench") { REPEAT } else { Duration::ZERO };
    let report = Report { lines: has("--lines"), repeat };
    lattice(&report);
    frequency_domain(&report);
    lights(&report);
    textures(&report);
    drawn_textures(&report);
    time_lines(&report);
    sensed(&report);
    sheets(&report);
}

/// 2-D FDTD, 5-point, f32.
fn lattice(report: &Report) {
    for (cells, rows, steps) in GRIDS {
        let mut one = 0.0;
        for threads in [1, 2] {
            let make = || {
                let mut lattice = FdtdGrid::rectangle(cells, rows, COURANT_SQUARED, threads);
                lattice.release(|cell, row| {
                    let part = |i: usize, count: usize| (PI * (i + 1) as f32 / (count + 1) as f32).sin();
                    part(cell, cells) * part(row, rows)
                });
                lattice
            };
            let still = vec![0.0; steps];
            let mut lattice = make();
            lattice.advance(&still);
            let check = f64::from(lattice.row(rows / 2).nth(1 + cells / 2).unwrap_or(0.0));
            let time = report.fastest(|| lattice.advance(&still));
            let speed = (cells * rows * steps) as f64 / time.as_secs_f64() / 1e6;
            let note = if threads == 1 { String::new() } else { format!("{:.2} x one thread", speed / one) };
            one = speed;
            let problem = format!("fdtd {cells}x{rows}");
            report.row(&problem, &format!("slipline {threads}"), speed, "Mcell/s", check, &note);
        }
    }
}

/// 2000 points x 64 frequencies of the displacement-driven aluminium plate, between supported and clamped edges.
fn frequency_domain(report: &Report) {
    let Some(plate) = preset("al-bending-displacement") else { return };
    many_frequencies(report, "frequency 2000x64", &plate);
    let mut spec = plate.spec().clone();
    let Some(bending) = spec.model.bending().cloned() else { return };
    spec.model = Model::BendingClamped(bending);
    spec.span_end_m = 0.25;
    if let Ok(clamped) = Plate::new(spec) {
        many_frequencies(report, "clamped frequency 2000x64", &clamped);
    }
}

fn many_frequencies(report: &Report, problem: &str, plate: &Plate) {
    let frequencies: Vec<f64> = (0..64).map(|i| 20_000.0 + 20_000.0 * f64::from(i) / 63.0).collect();
    let mut check = 0.0;
    let time = report.fastest(|| {
        if let Ok(rows) = respond_batch(plate, &frequencies, 2000, Equation::Corrected) {
            check = rows[40].iter().map(|f| f.norm()).fold(0.0, f64::max);
        }
    });
    let milliseconds = time.as_secs_f64() * 1e3;
    report.row(problem, "slipline 1", milliseconds, "ms", check, "");
}

/// All lights of each preset over its span, computed from the plate: the time a user waits.
fn lights(report: &Report) {
    for preset in presets() {
        let Some(plate) = preset.plate() else { continue };
        let mut check = 0.0;
        let time = report.fastest(|| {
            let span = Checker::new(&plate, Conditions::default())
                .and_then(|checker| checker.over_span(&mut Progress::unwatched()));
            check = span.map_or(f64::NAN, |span| span.lights.iter().filter_map(|light| light.value).sum());
        });
        report.row(
            &format!("lights {}", preset.name),
            "slipline 1",
            time.as_secs_f64() * 1e3,
            "ms",
            check,
            "",
        );
    }
}

/// A solid area of 16 tones on each preset, from its table on: 200 candidates at 201 places, pruned and refined.
fn textures(report: &Report) {
    for preset in presets() {
        let Some(plate) = preset.plate() else { continue };
        let Ok(table) = DriveTable::build(&plate, 400e3, 257) else { continue };
        let palette = Palette::new(&plate, &table);
        let Ok(target) = Target::solid(&palette, plate.span_m().1) else { continue };
        let mut check = 0.0;
        let time = report.fastest(|| {
            let texture = Texture::fit(&palette, &target, TONES_MAX);
            check = texture.map_or(f64::NAN, |texture| texture.figures.rms_error);
        });
        let milliseconds = time.as_secs_f64() * 1e3;
        report.row(&format!("texture {}", preset.name), "slipline 1", milliseconds, "ms", check, "");
    }
}

/// A profile that is drawn by hand, with eight tones: all that a stroke waits for, from the table on.
fn drawn_textures(report: &Report) {
    for preset in presets() {
        let Some(plate) = preset.plate() else { continue };
        let Ok(table) = DriveTable::build(&plate, 400e3, 257) else { continue };
        let profile = [0.05, 0.3, 0.5, 0.8].map(|share| share * plate.length_m());
        let profile: Vec<(f64, f64)> = profile.into_iter().zip([1.0, 0.7, 0.9, 0.1]).collect();
        let mut check = 0.0;
        let time = report.fastest(|| {
            let palette = Palette::new(&plate, &table);
            let made = Target::profile(&palette, &profile).and_then(|target| {
                let texture = Texture::fit(&palette, &target, 8)?;
                texture.worst(&palette, &target)
            });
            check = made.map_or(f64::NAN, |worst| worst.rms_error);
        });
        let milliseconds = time.as_secs_f64() * 1e3;
        report.row(&format!("drawn {}", preset.name), "slipline 1", milliseconds, "ms", check, "");
    }
}

/// Modal lines of the ultrasonic plate at 400 kS/s: how many times faster than the plate itself.
fn time_lines(report: &Report) {
    let Some(plate) = preset("al-bending") else { return };
    let rate = 400_000.0;
    let codes: Vec<f32> = (0..8_000).map(|n| 0.5 * (2.0 * PI * 0.075 * n as f32).sin()).collect();
    for points in [128, 512] {
        let Ok(mut line) = TimeDomainLine::new(&plate, rate, points) else { continue };
        let time = report.fastest(|| line.push(&codes));
        let check = f64::from(line.envelope().maximum_m().iter().copied().fold(0.0, f32::max));
        let factor = codes.len() as f64 / rate / time.as_secs_f64();
        report.row(&format!("time line {points}"), "slipline 1", factor, "x real", check, "");
    }
    // Time to build a line, which is repeated each time a finger on the plate moves.
    for preset in presets() {
        let Some(plate) = preset.plate() else { continue };
        let time = report.fastest(|| drop(TimeDomainLine::new(&plate, rate, 257)));
        let problem = format!("build line {}", preset.name);
        report.row(&problem, "slipline 1", time.as_secs_f64() * 1e3, "ms", 0.0, "");
    }
}

/// Simulation of a device's inputs, one sensor and the drive point: its speed, and the time to prepare it.
fn sensed(report: &Report) {
    let rate = 400_000.0;
    let codes: Vec<f64> = (0..8_000).map(|n| f64::from(0.5 * (2.0 * PI * 0.075 * n as f32).sin())).collect();
    for preset in presets() {
        let Some(plate) = preset.plate() else { continue };
        let Ok(sensed) = SensedPlate::new(&plate, None, rate) else { continue };
        let place_m = 0.1 * plate.length_m();
        let make = || sensed.sensor(SensorKind::Displacement, place_m, 0.0);
        let (Ok(sensor), Ok(drive_point)) = (make(), sensed.with_drive_point(|_, velocity| velocity)) else {
            continue;
        };
        let (mut resonators, mut signals) = (sensed.at_rest(), [codes.clone(), codes.clone()]);
        let time = report.fastest(|| {
            let [sensor_signal, current] = &mut signals;
            resonators.run(&codes, [&sensor, &drive_point], [sensor_signal, current]);
        });
        let factor = codes.len() as f64 / rate / time.as_secs_f64();
        let check = signals[0].iter().copied().fold(0.0, f64::max);
        report.row(&format!("sensed {}", preset.name), "slipline 1", factor, "x real", check, "");
        let time = report.fastest(|| drop(SensedPlate::new(&plate, None, rate)));
        let problem = format!("prepare sensed {}", preset.name);
        report.row(&problem, "slipline 1", time.as_secs_f64() * 1e3, "ms", 0.0, "");
        let time = report.fastest(|| drop(make()));
        let problem = format!("put sensor {}", preset.name);
        report.row(&problem, "slipline 1", time.as_secs_f64() * 1e3, "ms", 0.0, "");
    }
}

/// The same grid, with the envelope recorded at every cell.
fn everywhere(grid: SheetGrid) -> SheetGrid {
    SheetGrid { envelope: EnvelopeScope::Everywhere, ..grid }
}

/// Tapered sheets in two dimensions, driven by codes: cells per second and times real time.
fn sheets(report: &Report) {
    for name in ["membrane", "paper-rubber"] {
        let Some(plate) = preset(name) else { continue };
        let rate = 400_000.0;
        for (kind, grid) in [
            ("coarse", SheetGrid::coarse(&plate)),
            ("coarse, envelope", everywhere(SheetGrid::coarse(&plate))),
            ("fine, envelope", everywhere(SheetGrid::new(512, 80))),
            ("fine", SheetGrid::new(512, 80)),
            ("finest", SheetGrid::new(2048, 320)),
        ] {
            let Ok(mut sheet) = Sheet::new(&plate, rate, grid) else { continue };
            let seconds = (1e7 / sheet.updates_per_second()).clamp(0.001, 0.1);
            let (low, high) = plate.band_hz();
            let step = 2.0 * PI * ((low * high).sqrt() / rate) as f32;
            let codes: Vec<f32> = (0..(seconds * rate) as usize).map(|n| (step * n as f32).sin()).collect();
            let time = report.fastest(|| sheet.push(&codes));
            let check = f64::from(sheet.envelope().maximum_m.iter().copied().fold(0.0, f32::max));
            let factor = codes.len() as f64 / rate / time.as_secs_f64();
            let note = format!(
                "{} x {} cells, {:.0} Mcell/s",
                grid.along,
                grid.across,
                factor * sheet.updates_per_second() / 1e6
            );
            report.row(&format!("sheet {name} {kind}"), "slipline 1", factor, "x real", check, &note);
        }
    }
}
