use super::*;
use crate::definition::actuator::Actuator;
use crate::definition::drive::DriveEnd;
use crate::definition::impedance::Impedance;
use crate::definition::model::{Bending, Model};
use crate::definition::presets::{preset, presets};
use crate::definition::response_curve::ResponseCurve;
use crate::definition::sample_rate::hold_droop;
use crate::definition::source::{EndSlope, LeadIn, Source};
use crate::definition::spec::PlateSpec;
use crate::frequency::equation::Equation;
use crate::frequency::respond::respond_touched;

/// Settles tones of the band on a line and compares amplitude and peak with the frequency domain.
fn settled_tones_agree(plate: &Plate, line: TimeDomainLine, rate: f64) {
    settled_tones_agree_touched(plate, None, line, rate);
}

/// As [`settled_tones_agree`], optionally with a finger.
fn settled_tones_agree_touched(plate: &Plate, finger: Option<&Finger>, mut line: TimeDomainLine, rate: f64) {
    let name = plate.name();
    let (low, high) = plate.band_hz();
    for frequency in [low * 1.05, (low * high).sqrt(), high] {
        line.rest();
        let settle = (line.settle_time_s() * rate) as usize;
        let measure = (rate * (20.0 / frequency)) as usize;
        let tone = |n: usize| (TAU * frequency * n as f64 / rate).cos() as f32;
        let codes: Vec<f32> = (0..settle).map(tone).collect();
        line.push(&codes);
        line.reset_envelope();
        let codes: Vec<f32> = (settle..settle + measure).map(tone).collect();
        line.push(&codes);
        let exact = respond_touched(plate, finger, frequency, 257, Equation::Corrected).expect("in band");
        let turn = std::f64::consts::PI * frequency / rate;
        let scale = plate.spec().full_scale_m * turn.sin() / turn;
        let top = exact.amplitude.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let worst = line
            .envelope()
            .maximum_m()
            .iter()
            .zip(&exact.amplitude)
            .map(|(found, f)| (f64::from(*found) / scale - f.norm()).abs() / top)
            .fold(0.0, f64::max);
        let found = line.envelope().peak(plate, frequency);
        assert!(worst < 5e-3, "{name} {frequency} Hz: {worst}");
        if let (Some(found), Some(exact_peak)) = (found, exact.peak) {
            let off = (found.position_m - exact_peak.position_m).abs();
            assert!(off < exact.edge_width_m / 50.0, "{name} {frequency} Hz: {off} m");
        }
        assert_eq!(found.is_some(), exact.peak.is_some(), "{name} {frequency} Hz");
    }
}

#[test]
fn a_settled_tone_of_codes_has_the_frequency_domain_amplitude_and_peak() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let line = TimeDomainLine::new(&plate, 400e3, 257).expect("a preset fits 400 kS/s");
        settled_tones_agree(&plate, line, 400e3);
    }
}

/// One period of `count` codes: a tone of `turns` periods, for one half of full scale, for the other of a tenth of it. Each
/// change takes a sixteenth of the period and is smooth, so that the codes have no part beyond the plate's band.
fn two_levels(count: usize, turns: usize) -> Vec<f64> {
    let risen = |share: f64| {
        let part = (16.0 * share).clamp(0.0, 1.0);
        part * part * (3.0 - 2.0 * part)
    };
    let code = |n: usize| {
        let share = n as f64 / count as f64;
        let level = 0.1 + 0.9 * (risen(share) - risen(share - 0.5));
        level * (TAU * (turns * n % count) as f64 / count as f64).cos()
    };
    (0..count).map(code).collect()
}

#[test]
fn a_change_of_amplitude_decays_as_a_fourier_synthesis_of_the_frequency_domain_says() {
    const POINTS: usize = 65;
    for name in ["al-bending", "al-bending-displacement", "paper-as-printed", "tungsten-membrane"] {
        let plate = preset(name).expect("a preset");
        let rate = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let mut line = TimeDomainLine::new(&plate, rate, POINTS).expect("a line");
        let per_field = (rate / line.step_rate_hz()).round() as usize;
        let fields = ((0.5 * line.settle_time_s() * rate) as usize).max(8000) / per_field;
        let count = fields * per_field;
        let turns = (0.83 * plate.band_hz().1 * count as f64 / rate) as usize;
        let codes = two_levels(count, turns);
        // The line's fields over the last of four periods, at `fields` times.
        let block = |number: usize| -> Vec<f32> {
            codes[number * per_field..(number + 1) * per_field].iter().map(|code| *code as f32).collect()
        };
        let mut found = vec![vec![Complex64::ZERO; POINTS]; fields];
        for _ in 0..4 {
            for (number, field) in found.iter_mut().enumerate() {
                line.push(&block(number));
                line.analytic_m(field);
            }
        }
        // What the codes are a sum of, and the field of each part.
        let hertz = |line: usize| line as f64 * rate / count as f64;
        let lines: Vec<usize> = (turns.saturating_sub(200).max(1)..turns + 200).collect();
        let frequencies: Vec<f64> = lines.iter().map(|&line| hertz(line)).collect();
        let mut parts = fit::response(&plate, None, POINTS, hertz(turns + 200))(&frequencies);
        for (part, &line) in parts.iter_mut().zip(&lines) {
            let turn = TAU * line as f64 / count as f64;
            let held = hold_droop(hertz(line), rate) * Complex64::cis(0.5 * turn);
            let sum: Complex64 =
                codes.iter().enumerate().map(|(n, code)| Complex64::cis(turn * n as f64) * *code).sum();
            let drive = 2.0 * sum / count as f64 * held * plate.spec().full_scale_m;
            part.iter_mut().for_each(|value| *value *= drive);
        }
        let late = line.latency_s();
        let wanted: Vec<Vec<Complex64>> = (0..fields)
            .map(|number| {
                let time_s = ((number + 1) * per_field) as f64 / rate - late;
                let turns: Vec<Complex64> =
                    frequencies.iter().map(|hz| Complex64::cis(-TAU * (hz * time_s).fract())).collect();
                let at = |place: usize| parts.iter().zip(&turns).map(|(part, turn)| part[place] * turn).sum();
                (0..POINTS).map(at).collect()
            })
            .collect();
        // One constant phase for all frequencies is left: that of the carrier.
        let pairs = || wanted.iter().flatten().zip(found.iter().flatten());
        let turn = pairs().map(|(wanted, found)| wanted.conj() * found).sum::<Complex64>();
        let turn = turn / turn.norm();
        let top = pairs().map(|(wanted, _)| wanted.norm()).fold(0.0, f64::max);
        let worst = pairs().map(|(wanted, found)| (wanted * turn - found).norm()).fold(0.0, f64::max);
        println!("{name}: {:.3} % of the largest amplitude", 100.0 * worst / top);
        assert!(worst < 3e-3 * top, "{name}: {worst} of {top}");
        let before = wanted[0].iter().map(|f| f.norm()).fold(0.0, f64::max);
        assert!(before < 0.5 * top, "{name}: the levels differ: {before} of {top}");
    }
}

/// Preset `name` with another driven end.
fn with_end(name: &str, drive_end: DriveEnd) -> Plate {
    Plate::new(PlateSpec { drive_end, ..preset(name).expect("a preset").spec().clone() })
        .expect("a valid plate")
}

#[test]
fn sources_slopes_and_lead_ins_ring_as_the_frequency_domain_says() {
    let lead_in = LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 60.0 };
    let bending = preset("al-bending").expect("a preset").spec().model.clone();
    let membrane = preset("membrane").expect("a preset").spec().model.clone();
    let ends = [
        ("al-bending", DriveEnd::DisplacementAndSlope { slope: EndSlope::Free }),
        ("al-bending", DriveEnd::DisplacementAndSlope { slope: EndSlope::Held }),
        ("al-bending", DriveEnd::Source(Source { lead_in: Some(lead_in), ..Source::soft(&bending, 28e3) })),
        (
            "al-bending",
            DriveEnd::Source(Source {
                impedance: Impedance { mass_kg: 2e-4, ..Impedance::damper(43.0) },
                slope: Some(EndSlope::Held),
                ..Source::soft(&bending, 28e3)
            }),
        ),
        (
            "membrane",
            DriveEnd::Source(Source {
                impedance: Impedance { resistance_n_s_per_m: 0.15, mass_kg: 1e-3, stiffness_n_per_m: 600.0 },
                ..Source::soft(&membrane, 140.0)
            }),
        ),
    ];
    for (name, end) in ends {
        let plate = with_end(name, end);
        let rate = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let line = TimeDomainLine::new(&plate, rate, 257).unwrap_or_else(|error| panic!("{end:?}: {error}"));
        settled_tones_agree(&plate, line, rate);
    }
}

#[test]
fn a_settled_tone_on_a_touched_line_has_the_amplitude_of_the_touched_plate() {
    let [membrane, bending] = ["membrane", "al-bending"].map(|name| preset(name).expect("a preset"));
    for (plate, finger) in
        [(&membrane, Finger::light(0.16)), (&membrane, Finger::firm(0.2)), (&bending, Finger::firm(0.24))]
    {
        let rate = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let line = TimeDomainLine::touched(plate, Some(&finger), rate, 257).expect("a line");
        settled_tones_agree_touched(plate, Some(&finger), line, rate);
    }
    let off = TimeDomainLine::touched(&membrane, Some(&Finger::light(2.0)), 4e3, 257).err().expect("refused");
    assert!(off.to_string().starts_with("finger place = "), "{off}");
}

#[test]
fn what_has_no_line_is_refused() {
    let plate = preset("al-bending").expect("a preset");
    // 20 dB up and down within 4 Hz.
    let zigzag = |i: u32| [2e4 + 2.0 * f64::from(i), if i.is_multiple_of(2) { 10.0 } else { -10.0 }, 0.0];
    let curve = ResponseCurve { points: (0..10_000).map(zigzag).collect() };
    let measured = PlateSpec { actuator: Some(Actuator::Measured(curve)), ..plate.spec().clone() };
    let measured = Plate::new(measured).expect("a valid plate");
    let refused = TimeDomainLine::new(&measured, 400e3, 65).err().expect("refused");
    assert!(matches!(&refused, LineError::Drive(error) if error.error > 0.5), "{refused}");
}

#[test]
fn a_field_that_grows_is_refused() {
    let plate = preset("al-bending").expect("a preset");
    let plan = plan(&plate, 400e3, 65).expect("a line");
    let growing = |frequencies: &[f64]| {
        let field = |f: &f64| vec![1e3 / (Complex64::new(1.8e5, 1e3) - TAU * f); 65];
        frequencies.iter().map(field).collect::<Vec<_>>()
    };
    let fit = fit::exact(growing, &plan, 65);
    let refused = TimeDomainLine::of_fit(&plate, plan, 65, &fit).err().expect("refused");
    assert!(matches!(refused, LineError::Unfit { error, .. } if error > 0.1), "{refused}");
}

#[test]
fn a_thick_plates_tones_have_the_frequency_domain_amplitude_and_peak() {
    let mut spec = preset("al-bending").expect("a preset").spec().clone();
    let bending = spec.model.bending().expect("bending").clone();
    spec.model = Model::BendingSupported(Bending { thick_plate: true, ..bending });
    let plate = Plate::new(spec).expect("a valid plate");
    let line = TimeDomainLine::new(&plate, 400e3, 257).expect("a line");
    settled_tones_agree(&plate, line, 400e3);
}
