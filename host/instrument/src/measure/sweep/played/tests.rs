//! Content of a description, and refused descriptions.

use super::*;
use slipline_model::field::simulation::table_for;
use slipline_plate::preset;

const RATE_HZ: f64 = 40e3;

fn sweep() -> PlayedSweep {
    let plate = preset("membrane").unwrap();
    let (_, table) = table_for(&plate, RATE_HZ as u32).unwrap();
    PlayedSweep::new(&plate, &table, &Wanted::of(&plate), RATE_HZ, 0.8).unwrap()
}

#[test]
fn both_sweeps_stand_where_the_description_says_and_the_second_has_half_the_level() {
    let sweep = sweep();
    let codes = sweep.rendered().unwrap();
    assert_eq!(codes.len() as u64, sweep.end());
    let peak = |from: u64, to: u64| {
        codes[from as usize..to as usize].iter().map(|code| code.abs_diff(2048)).max().unwrap()
    };
    let (first, second) = (sweep.lead, sweep.lead + sweep.apart);
    let samples = sweep.chirp.samples;
    // Silent gains: the waiting tones and the pauses have no codes.
    assert_eq!((peak(0, first), peak(first + samples + 128, second)), (0, 0));
    assert_eq!(peak(second + samples + 128, sweep.end()), 0);
    let peaks = [peak(first, first + samples), peak(second, second + samples)];
    assert!(peaks[0] > 500 && peaks[0].abs_diff(2 * peaks[1]) <= 2, "{peaks:?}");
    assert!((sweep.apart - samples) as f64 / RATE_HZ > 1.0 + 1.25 * sweep.chirp.ring_s);
    // The second sweep is half of the first one, code by code.
    let both = sweep.codes().unwrap();
    let differ = both.first.iter().zip(&both.second).map(|(one, other)| (one - 2.0 * other).abs());
    assert!(differ.fold(0.0, f64::max) < 2.5 / 2048.0);
}

#[test]
fn a_level_of_full_scale_is_rendered_too() {
    let plate = preset("membrane").unwrap();
    let (_, table) = table_for(&plate, RATE_HZ as u32).unwrap();
    let wanted = Wanted { level: 1.0, ..Wanted::of(&plate) };
    let sweep = PlayedSweep::new(&plate, &table, &wanted, RATE_HZ, 0.8).unwrap();
    let peak = sweep.rendered().unwrap().into_iter().map(|code| code.abs_diff(2048)).max();
    assert!(peak > Some(1500), "{peak:?}");
}

#[test]
fn a_description_is_read_as_it_was_written_and_its_mistakes_name_their_field_and_range() {
    let sweep = sweep();
    let text = sweep.to_toml();
    assert_eq!(PlayedSweep::from_toml(&text), Ok(sweep));
    assert!(text.len() < file::PLAYED_BYTES_MAX / 4);
    let changed = |field: &str, value: &str| {
        let line = text.lines().find(|line| line.starts_with(field)).unwrap();
        PlayedSweep::from_toml(&text.replace(line, &format!("{field} = {value}"))).unwrap_err().to_string()
    };
    for (field, value, message) in [
        ("slipline_sweep", "2", "slipline_sweep = 2: must be 1"),
        ("sample_rate_hz", "1.0", "sample_rate_hz = 1 Hz: must be 8000 to 1000000 Hz"),
        ("sample_rate_hz", "nan", "sample_rate_hz = NaN Hz: must be 8000 to 1000000 Hz"),
        ("from_hz", "-1.0", "from = -1 Hz"),
        ("to_hz", "1e9", "to = 1e9 Hz"),
        ("points", "3", "points = 3: must be 8 to 1600"),
        ("level", "2.0", "level = 2: must be 0.001 to 1"),
        ("first_hz", "300.0", "first_hz = 300 Hz"),
        ("last_hz", "100.0", "last_hz = 100 Hz"),
        ("ring_s", "inf", "ring_s = inf s"),
        ("sweep_samples", "100000000", "sweep_samples / sample_rate_hz = 2500 s: must be 0.01 to 10 s"),
        ("lead_samples", "10000000", "lead_samples / sample_rate_hz = 250 s: must be 0 to 60 s"),
        ("pause_samples", "10000000", "pause_samples / sample_rate_hz = 250 s: must be 0 to 60 s"),
        ("apart_samples", "128", "apart_samples = 128: must be "),
        (
            "lead_samples",
            "20001",
            "lead_samples, apart_samples, and sweep_samples with pause_samples: must be multiples of 128",
        ),
        ("gain", "[0.5]", "gain has 1 numbers: must be 513"),
        ("gain", "[7.0]", "gain = 7: must be 0 to 1"),
        ("gain", "\"loud\"", "not a description of a sweep, as slipline sweep writes it: "),
    ] {
        let found = changed(field, value);
        assert!(found.starts_with(message), "{message}\n{found}");
    }
    assert!(PlayedSweep::from_toml("[plate]").is_err());
}

#[test]
fn a_sweep_that_no_device_plays_is_refused_by_its_time() {
    let plate = preset("membrane").unwrap();
    let (_, table) = table_for(&plate, RATE_HZ as u32).unwrap();
    let refused = |seconds: f64| {
        PlayedSweep::new(&plate, &table, &Wanted::of(&plate), RATE_HZ, seconds).unwrap_err().to_string()
    };
    assert!(refused(11.0).starts_with("time = 11 s: must be "), "{}", refused(11.0));
    assert!(refused(1e-3).ends_with(" to 10 s"), "{}", refused(1e-3));
    assert!(refused(f64::NAN).starts_with("time = no number"), "{}", refused(f64::NAN));
}
