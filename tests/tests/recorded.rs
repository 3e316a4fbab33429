//! A secret plate, calibrated from recordings of the sweep: the device plays, and a separate recorder with its own clock
//! records the rig's sensor.

use clap::Parser as _;
use slipline::cli::Cli;
use slipline_instrument::measure::{HeardError, PlayedSweep, Playing, Wanted};
use slipline_instrument::measured_file::{ForeignError, Opened, RecordingMetadata, recorded};
use slipline_instrument::rig::{RigOptions, secret};
use slipline_link::protocol::command::Apply;
use slipline_link::{Request, Sounding};
use slipline_plate::calibrate::{Priors, SensorKind, departure, from_one_sensor};
use slipline_plate::{Plate, preset};
use slipline_tests::bench::{MeasuringBench, RATE_HZ};
use slipline_tests::recorder::{SoundRecorder, Tape};
use std::path::PathBuf;

/// A phone: 48 kHz, 16 bits, 150 ppm fast, a hum at -50 dB and noise at -70 dB of its full scale.
const PHONE: SoundRecorder =
    SoundRecorder { rate_hz: 48_000, clock: 150e-6, gain: 0.8, noise: 3e-4, hum: 3e-3 };

fn playing(bench: &MeasuringBench, seconds: f64) -> Playing {
    let sweep = PlayedSweep::new(&bench.nominal, &bench.table, &bench.wanted, RATE_HZ, seconds).unwrap();
    Playing::new(sweep, bench.table.clone()).unwrap()
}

/// What the phone records of the sensor at a place, and the sweep's description.
fn recording(bench: &mut MeasuringBench, tape: &Tape, place_m: f64) -> (Vec<u8>, String) {
    bench.hand.put_sensor(place_m).unwrap();
    tape.rewind();
    // The person starts the recorder at any time.
    bench.loopback.pass(31_000, |_| ());
    let playing = playing(bench, 1.0);
    let sweep = bench.run(playing, |_, _, _, _| ()).unwrap();
    (tape.recorded(RATE_HZ, &PHONE), sweep.to_toml())
}

/// A file for this test.
fn file(name: &str, content: impl AsRef<[u8]>) -> String {
    let path =
        PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("recorded-{}-{name}", std::process::id()));
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The command line calibrates the preset `membrane` by two recordings.
fn calibrated([near, far]: [&(Vec<u8>, String); 2]) -> Plate {
    let (a, b) = (file("a.wav", &near.0), file("b.wav", &far.0));
    let (played, fitted) = (file("sweep.toml", &far.1), file("fitted.toml", ""));
    let words = format!(
        "slipline calibrate --plate membrane --data {a} --data {b} --played {played} --sensor 32mm --sensor 176mm \
         --kind displacement --channel 2 --out {fitted} --force"
    );
    let cli = Cli::try_parse_from(words.split(' ')).unwrap();
    if let Err(failure) = cli.command.unwrap().run(true) {
        panic!("{failure:?}");
    }
    Plate::from_toml(&std::fs::read_to_string(fitted).unwrap()).unwrap()
}

#[test]
fn recordings_by_a_phone_calibrate_an_unknown_plate() {
    let nominal = preset("membrane").unwrap();
    let truth = secret(&nominal, 1).unwrap();
    let tape = Tape::default();
    let points = Wanted::of(&nominal).points;
    let mut bench =
        MeasuringBench::tapped(&nominal, &truth, &RigOptions::default(), points, |inputs| tape.on(inputs));
    let [near, far] = bench.places_m().map(|place_m| recording(&mut bench, &tape, place_m));
    // Both were played alike, and the table of the plate is back.
    assert_eq!(near.1, far.1);
    assert_eq!(bench.loopback.view().table.confirmed.as_deref(), Some(&*bench.table));
    let before = departure(&nominal, &truth, RATE_HZ).unwrap();
    let after = departure(&calibrated([&near, &far]), &truth, RATE_HZ).unwrap();
    println!("{before:?} -> {after:?}");
    // As the device's own measurement is held to, in `measuring.rs`.
    assert!(after.boundary_m < 1e-3 && after.level_db < 2.0, "{after:?}");
    assert!(after.boundary_m < 0.5 * before.boundary_m && after.level_db < 0.5 * before.level_db);

    let Ok(Opened::Recording(wav)) = Opened::read(near.0, &[]) else { panic!("a recording") };
    let sweep = PlayedSweep::from_toml(&near.1).unwrap();
    let stated =
        RecordingMetadata { place_m: bench.places_m()[0], kind: Some(SensorKind::Displacement), channel: 2 };
    let (measurement, notes) = recorded(&nominal, &wav, &sweep, &stated).unwrap();
    println!("{notes:?}");
    let (ppm, _) = notes[0].split_once("clock is ").unwrap().1.split_once(" ppm fast").unwrap();
    assert!((ppm.parse::<f64>().unwrap() - 1e6 * PHONE.clock).abs() < 0.5, "{notes:?}");
    // The phases are of use, too: one sensor's fit takes the lag that is left.
    let found = from_one_sensor(&nominal, &measurement, &Priors::default()).unwrap();
    let alone = departure(&found.plate, &truth, RATE_HZ).unwrap();
    println!("alone {alone:?}, chi2/n {}", found.chi2_per_n);
    assert!(alone.boundary_m < 0.5 * before.boundary_m, "{alone:?}");
    // The other channel has noise alone.
    let noise = recorded(&nominal, &wav, &sweep, &RecordingMetadata { channel: 1, ..stated }).unwrap_err();
    assert_eq!(noise, ForeignError::Heard(HeardError::NotFound));
}

#[test]
fn a_slow_host_and_a_cancelled_sweep_leave_the_device_as_it_was() {
    let nominal = preset("al-bending").unwrap();
    let mut bench = MeasuringBench::new(&nominal, &nominal, &RigOptions::default(), 24);
    let mut drives = 0;
    let sweep = playing(&bench, 0.2);
    let played = bench
        .run(sweep, |loopback, _, _, asked| {
            if matches!(asked, Some(Request::Play(Sounding::Drive(drive))) if matches!(drive.apply, Apply::At(_))) {
                drives += 1;
                // A second late, once, before the second sweep's tone glides.
                loopback.pass(if drives == 4 { 400_000 } else { 0 }, |_| ());
            }
        })
        .unwrap();
    // Four of the first try, and four of the second.
    assert_eq!(drives, 8);
    // The host gets more time.
    assert!(played.apart_s() > 2.0, "{}", played.apart_s());
    bench.ends_early(|bench| playing(bench, 0.2), |step, _| step == 4_000);
}
