//! Files of other programs, one for each fault that was found: each gives the calibration of its twin, or is refused by its
//! line and its columns.

use slipline_plate::calibrate::{
    File, FileError, Measurement, Parameter, Priors, SensorKind, band_hz, from_ratio,
};
use slipline_plate::text_table::chosen;
use slipline_plate::{Complex64, preset};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What a pair of files must become.
enum Wanted {
    /// The answer of the twin; the responses are its to this share.
    Twin(f64),
    /// A complete file of this program.
    Own,
    /// A refusal that begins so, and the columns that decide, if they can.
    Refused(&'static str, &'static str),
}

use Wanted::{Own, Refused, Twin};

const CASES: [(&str, Wanted); 22] = [
    ("base", Own),
    ("table_ok", Twin(1e-4)),
    ("u58_ok", Twin(1e-4)),
    ("d01_displacement", Twin(1e-4)),
    ("d02_frq_mag_radians", Twin(1e-4)),
    ("d02_hz_mag_deg", Twin(1e-4)),
    ("d03_frd", Twin(1e-3)),
    (
        "d03_freq_hz_level_db",
        Refused("line 1: the names are not those of 3 columns", "frequency=1,level=2,phase=3"),
    ),
    ("d04_units_row", Twin(1e-4)),
    // Frequencies of 13 to 37 Hz, which are below the plate's.
    ("d05_frequency_rad_per_s", Refused("the measurement has 0 points", "")),
    ("d05_phase_rad", Twin(1e-4)),
    ("d06_quoted_commas", Twin(0.02)),
    ("d07_excel", Own),
    ("d08_padded", Twin(1e-4)),
    ("d20_minus_inf", Twin(1e-3)),
    ("d21_descending", Twin(1e-3)),
    ("d22_cr", Twin(1e-3)),
    ("d22_minus_sign", Twin(1e-3)),
    ("d23_title", Twin(1e-3)),
    ("d24_winkel", Twin(1e-3)),
    ("d25_text_before", Twin(1e-4)),
    (
        "d31_two_levels",
        Refused(
            "line 1: 2 columns may be the level: *Magnitude (dB) Ref*, *Magnitude (dB) Resp*. Its columns: 1 *Frequency (Hz)*",
            "frequency=1,level=3:dB,phase=4",
        ),
    ),
];

const PLACES: [(&str, f64); 2] = [("near", 0.032), ("far", 0.176)];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases")
}

/// The measurement of a file, with these columns.
fn read(name: &str, place_m: f64, columns: &str) -> Result<Measurement, FileError> {
    let path = ["txt", "uff", "csv"].map(|ending| folder().join(format!("{name}.{ending}")));
    let path = path.iter().find(|path| path.exists()).expect(name);
    let columns = if columns.is_empty() { Vec::new() } else { chosen(columns).expect("columns") };
    match File::read(&std::fs::read(path).expect("a file"), &columns)? {
        File::Own(measurement) => Ok(measurement),
        File::Foreign(foreign) => {
            let plate = preset("membrane").expect("a preset");
            foreign.measurement(place_m, SensorKind::Displacement, 40.0, band_hz(&plate))
        }
    }
}

fn pair(name: &str, columns: &str) -> Result<[Measurement; 2], FileError> {
    let [near, far] = PLACES.map(|(which, place_m)| read(&format!("{name}_{which}"), place_m, columns));
    Ok([near?, far?])
}

fn wave_speed([near, far]: &[Measurement; 2]) -> f64 {
    let plate = preset("membrane").expect("a preset");
    let found = from_ratio(&plate, [near, far], &Priors::default()).expect("a calibration");
    let is_speed = |it: &&Parameter| it.name.contains("wave_speed");
    found.parameters.iter().find(is_speed).expect("a wave speed").value
}

/// Checks that the responses are those of the twin but for a factor.
fn check_points(name: &str, found: &Measurement, twin: &Measurement, share: f64) {
    let at = |hz: f64| -> Complex64 {
        let nearest = twin
            .points
            .iter()
            .min_by(|a, b| (a.frequency_hz - hz).abs().total_cmp(&(b.frequency_hz - hz).abs()));
        nearest.expect("a point").response
    };
    // Two of the 60 are above the plate's band.
    assert!((57..=58).contains(&found.points.len()), "{name}: {}", found.points.len());
    let factor = found.points[0].response.norm() / at(found.points[0].frequency_hz).norm();
    for point in &found.points {
        let wanted = factor * at(point.frequency_hz);
        assert!((point.response - wanted).norm() < 2.0 * share * wanted.norm(), "{name}: {point:?} {wanted}");
    }
}

#[test]
fn each_file_of_the_folder_gives_its_twins_answer_or_is_refused_in_words() {
    let twins = pair("table_ok", "").expect("the twin");
    let speed = wave_speed(&twins);
    assert!((speed - 11.87).abs() < 0.01, "{speed}");
    let mut walked = BTreeSet::new();
    for (name, wanted) in CASES {
        walked.extend(PLACES.map(|(which, _)| format!("{name}_{which}")));
        let measured = match wanted {
            Own => pair(name, "").unwrap_or_else(|error| panic!("{name}: {error}")),
            Twin(share) => {
                let measured = pair(name, "").unwrap_or_else(|error| panic!("{name}: {error}"));
                measured.iter().zip(&twins).for_each(|(found, twin)| check_points(name, found, twin, share));
                measured
            }
            Refused(words, columns) => {
                let error = pair(name, "").expect_err(name).to_string();
                assert!(error.starts_with(words), "{name}: {error}");
                if columns.is_empty() {
                    continue;
                }
                pair(name, columns).unwrap_or_else(|error| panic!("{name}: {error}"))
            }
        };
        assert!((wave_speed(&measured) - speed).abs() < 0.03, "{name}: {}", wave_speed(&measured));
    }
    let files = std::fs::read_dir(folder()).expect("the folder");
    let names = files
        .map(|file| file.expect("a file").path().file_stem().expect("a name").to_string_lossy().into_owned());
    assert_eq!(names.collect::<BTreeSet<_>>(), walked);
}

/// The cells are divided, and read as numbers, once for each separator and decimal sign: four times the rows take about four
/// times as long. A pass over the table for each row would take sixteen times as long.
#[test]
fn the_time_of_a_table_of_20_columns_grows_with_its_rows() {
    let names: Vec<String> = (4..=20).map(|number| format!("Coherence {number}")).collect();
    let table = |rows: usize| {
        let mut text = format!("Frequency (Hz),Level (dB),Phase (deg),{}\n", names.join(","));
        for row in 0..rows {
            let more: Vec<String> = (4..=20).map(|column| format!("0.{}", 100 * column + row)).collect();
            text += &format!("{}.25,-{}.5,{}.125,{}\n", 100 + row, row % 60, row % 180, more.join(","));
        }
        text
    };
    let time = |rows: usize| {
        let text = table(rows);
        let began = Instant::now();
        match File::read(text.as_bytes(), &[]) {
            Ok(File::Foreign(foreign)) => assert_eq!(foreign.points.len(), rows),
            other => panic!("{other:?}"),
        }
        began.elapsed()
    };
    // A busy machine can lengthen any of the times, but not each of many pairs alike.
    let pairs: Vec<_> = (0..20).map(|_| (time(400), time(1600))).collect();
    assert!(pairs.iter().any(|&(few, many)| many < 8 * few), "400 and 1600 rows: {pairs:?}");
}

/// Prints what becomes of each file of the folder `SLIPLINE_FILES`, or of the cases of the tree.
#[test]
#[ignore = "for files that are not in the tree: SLIPLINE_FILES=FOLDER"]
fn files_of_a_folder_are_read_or_refused_in_words() {
    let folder = std::env::var_os("SLIPLINE_FILES").unwrap_or_else(|| "tests/cases".into());
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|it| it.expect("a file").path()).collect();
    paths.sort();
    for path in paths {
        let bytes = std::fs::read(&path).expect("a file");
        let name = path.file_name().expect("a name").to_string_lossy();
        match File::read(&bytes, &[]) {
            Ok(File::Foreign(foreign)) => {
                println!("{name}\tread\t{}", foreign.read((0.0, f64::INFINITY)));
                for (hz, it) in foreign.points.iter().filter_map(|it| Some((it.frequency_hz, it.response?))) {
                    println!("\t{hz:e}\t{:e}\t{:e}", it.re, -it.im);
                }
            }
            Ok(File::Own(_)) => println!("{name}\town"),
            Err(error) => println!("{name}\trefused\t{error}"),
        }
    }
}
