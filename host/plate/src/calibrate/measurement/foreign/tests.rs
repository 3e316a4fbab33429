mod generated;
mod hostile;
mod siblings;

use super::*;
use crate::calibrate::fit::pairs::pairs;
use proptest::prelude::*;

fn foreign(text: &str) -> Foreign {
    match File::read(text.as_bytes(), &[]) {
        Ok(File::Foreign(foreign)) => foreign,
        other => panic!("{text}: {other:?}"),
    }
}

/// Its rows as pairs of frequency and response.
fn pairs_of(found: &Foreign) -> Vec<(f64, Complex64)> {
    found.points.iter().map(|point| (point.frequency_hz, point.response.expect("a number"))).collect()
}

fn refused(text: &str) -> String {
    File::read(text.as_bytes(), &[]).expect_err(text).to_string()
}

/// Checks that a text gives 100 Hz, -20 dB and 90 degrees, the row that all of these texts share, and a row of 200.5
/// Hz.
fn check(text: &str, has_phase: bool) {
    let found = foreign(text);
    assert_eq!(found.points.len(), 2, "{text}");
    let [first, second] = [0, 1].map(|at| found.points[at]);
    assert_eq!((first.frequency_hz, second.frequency_hz), (100.0, 200.5), "{text}");
    let wanted = if has_phase { Complex64::new(0.0, -0.1) } else { Complex64::new(0.1, 0.0) };
    assert!((first.response.expect("a number") - wanted).norm() < 1e-12, "{text}: {found:?}");
}

#[test]
fn tables_of_every_separator_are_read() {
    for text in [
        "* Measurement data measured by REW V5.19\n* Format: 256k Log Swept Sine\n*\n* Freq(Hz) SPL(dB) Phase(degrees)\n100.0 -20.0 90.0\n200.5 -3 0\n",
        "* Freq(Hz), SPL(dB), Phase(degrees)\n100.000, -20.000, 90.0000\n200.5, -3, 0\n",
        "* Freq(Hz);SPL(dB);Phase(degrees)\n100,0;-20,0;90,0\n200,5;-3;0\n",
        "Frequency\tLevel\tPhase\r\n100\t-20\t90\r\n200.5\t-3\t0\r\n",
        "100 -20 90\n200.5 3 0\n",
        "100,0 -20,0 90,0\n200,5 3,0 0\n",
        "# by hand\nphase_degrees,frequency_khz,level_db\n90,0.1,-20\n1,0.2005,3\n\n",
        "\u{feff}\"Frequency [Hz]\",\"Magnitude\",\"Phase\"\n\"100\",0.1,90\n200.5,1e0,0\n",
        "freq,re,im\n100,0,0.1\n200.5,1,0\n",
        "Imaginary;Real;Frequency (Hz)\n0,1;0;100\n0;1;200,5\n",
        "f\tReal (m/N)\tImag (m/N)\n100\t0\t0.1\n200.5\t1\t0\n",
    ] {
        check(text, true);
    }
    for text in [
        "SPL measurements acquired by REW V3.08\nSource: D:\\test.txt\n100.0, -20\n200.5, 65.01\n",
        "frequency_hz,magnitude\n100,0.1\n200.5,3\n",
        "Freq(Hz) SPL(dB)\n100 -20\n200.5 60\n# the end\n",
    ] {
        check(text, false);
    }
}

#[test]
fn a_text_in_utf_16_is_read_as_that_in_utf_8() {
    let text = "Frequency\tLevel\tPhase\r\n100\t-20\t90\r\n200.5\t-3\t0\r\n";
    for (mark, bytes_of) in
        [([0xff, 0xfe], u16::to_le_bytes as fn(u16) -> [u8; 2]), ([0xfe, 0xff], u16::to_be_bytes)]
    {
        let bytes: Vec<u8> = mark.into_iter().chain(text.encode_utf16().flat_map(bytes_of)).collect();
        let Ok(File::Foreign(found)) = File::read(&bytes, &[]) else { panic!("a table") };
        assert_eq!(found, foreign(text));
        // An odd byte at the end, and half of a pair.
        assert!(File::read(&[&bytes[..], &[0x41]].concat(), &[]).is_ok());
        assert!(File::read(&[&mark[..], &[0xd8, 0xd8]].concat(), &[]).is_err());
    }
}

#[test]
fn a_universal_file_and_a_csv_of_one_measurement_have_the_same_frequencies() {
    let at = |place_m: f64| {
        let points = (0..40).map(|i| MeasuredPoint {
            frequency_hz: 17_123.456_789 * 1.013_f64.powi(i),
            response: Complex64::new(1.0, 0.5),
            noise: 1e-3,
            headroom_db: None,
        });
        Measurement::at(place_m, SensorKind::Displacement, points.collect())
    };
    let band = (1.0, 1e6);
    let rounded = foreign(&at(0.03).to_uff58()).measurement(0.03, SensorKind::Displacement, 40.0, band);
    let exact = Measurement::from_csv(&at(0.2).to_csv()).expect("the own form");
    let common = pairs([&rounded.expect("a measurement"), &exact], Range::new(1.0, 1e6, "Hz"));
    assert_eq!(common.len(), 40);
}

#[test]
fn a_text_without_a_table_is_refused_by_its_line() {
    for (text, message) in [
        ("", "no line has a frequency and a level"),
        ("a\nb\n", "no line has a frequency and a level"),
        (
            "100 20\n200 30\n",
            "line 1: no line names the columns, and nothing shows whether the second is in dB",
        ),
        (
            "100 20 3 4\n200 30 5 6\n",
            "line 1: no line names the 4 columns. Its columns: 1 (100 ..), 2 (20 ..)",
        ),
        ("freq,db\n100,20\n200,loud\n", "line 3: column 2: \"loud\" is no number"),
        ("freq,db\n100,20\n200\n", "line 3: 1 cell, between or below the rows of numbers"),
        ("freq,db\n100,20\nthe end\n", "line 3: column 1: \"the end\" is no number"),
        ("freq,db\n100,20\nand\n200,30\n300,20\n", "line 3: column 1: \"and\" is no number"),
        ("freq,db\n100,9999\n", "line 2: column 2 *db* = 9999: must be -400 to 400 dB"),
        ("freq,magnitude (lin)\n100,-0.5\n", "line 2: column 2 *magnitude (lin)* = -0.5: must be 0 to 1e30"),
        ("freq,magnitude\n100,-0.5\n", "line 1: nothing shows whether *magnitude* is in dB"),
        ("freq,magnitude\n100,40\n101,42\n", "line 1: nothing shows whether *magnitude* is in dB"),
        (
            "freq,db,phase\n100,20,1\n101,20,-3\n",
            "line 1: nothing shows whether *phase* is in degrees or in radians",
        ),
        (
            "freq (Hz),level (dBA)\n100,20\n",
            "line 1: *level (dBA)* has the unit dBA, which is not known of the level",
        ),
        ("# place_m = x\n", "line 1: place_m = x: must be a number"),
        // A head that is not understood, whether it names a frequency or not.
        ("freq,x,y\n100,1,2\n", "line 1: no column is named as a level in dB, a magnitude, or both"),
        ("a;b;c\n100;1;2\n", "line 1: no column is named as the frequency. Its columns: 1 *a*, 2 *b*, 3 *c*"),
        ("freq;level\n100;1;2\n", "line 1: the names are not those of 3 columns"),
        ("freq,re,im\n100,1,x\n", "line 2: column 3 *im* = x: must be a number"),
        ("freq;db\n100,5;20.5\n", "line 2: both a decimal point and a decimal comma are in use"),
        ("freq,db\n100,\"20\n101,20\n102,20\n", "no line has a frequency and a level"),
        ("freq,db\n100,20\n# a,\"b\n101,20\n102,20\n", "line 3: a quotation mark is not closed"),
    ] {
        let found = refused(text);
        assert!(found.starts_with(message), "{text:?}: {found}");
    }
}

/// A frequency response of two points, evenly spaced, complex in single precision, with adjacent fields.
const UFF: &str = "    -1
    15
         1         0         0        11  0.00000E+00  0.00000E+00  0.00000E+00
    -1
    -1
    58
Test
NONE
01-Jan-26 00:00:00
NONE
NONE
    4         0    0         0       NONE         1   3       NONE         1   3
         5         3         1  1.00000E+02  5.00000E-01  0.00000E+00
        18    0    0    0            Frequency                   Hz
        12    0    0    0         Acceleration                 NONE
        13    0    0    0                Force                 NONE
         0    0    0    0                 NONE                 NONE
  0.00000E+00  1.00000D-01  2.00000E-01-3.00000E-01  4.00000E+00-5.00000E+00
    -1
";

#[test]
fn a_universal_file_is_read_with_its_kind_of_sensor() {
    let found = foreign(UFF);
    assert_eq!(found.sensor, Some(SensorKind::Acceleration));
    let wanted = [(100.0, 0.0, -0.1), (100.5, 0.2, 0.3), (101.0, 4.0, 5.0)];
    assert_eq!(pairs_of(&found), wanted.map(|(hz, re, im)| (hz, Complex64::new(re, im))));
    let real = UFF.replace("         5         3         1", "         2         3         0");
    let magnitudes = [(0.0, 0.1), (0.2, 0.3), (4.0, 5.0)];
    let negative = refused(&real);
    assert!(
        negative.starts_with("line 18: dataset 58: the magnitude = -0.3: must be 0 or above: save complex"),
        "{negative}"
    );
    let real = real.replace("-3.0", " 3.0").replace("-5.0", " 5.0");
    assert_eq!(pairs_of(&foreign(&real)), magnitudes.map(|(hz, it)| (hz, Complex64::new(it, 0.0))));
    let levels = UFF
        .replace("         5         3", "         2         6")
        .replace("Acceleration                 NONE", "Acceleration                   dB");
    let found = foreign(&levels);
    let decibels = [0.0, 0.1, 0.2, -0.3, 4.0, -5.0].map(|db: f64| 10_f64.powf(db / 20.0));
    assert!(pairs_of(&found).iter().zip(decibels).all(|(it, wanted)| (it.1.re - wanted).abs() < 1e-12));
    assert!(found.read((1.0, 1e3)).to_string().ends_with("in dB"), "{}", found.read((1.0, 1e3)));
    for (from, to, message) in [
        (
            "    58\n",
            "    58b\n",
            "line 6: dataset 58b: the order of the bytes = nothing: must be a whole number",
        ),
        ("    58\n", "    55\n", "the universal file holds no dataset 58"),
        (
            "    4         0",
            "    1         0",
            "line 12: dataset 58: the function's type = 1 (a time response): must be 0, 4, 5 or 12",
        ),
        (
            "         5         3",
            "         7         3",
            "line 13: dataset 58: the data's form = 7: must be 2, 4, 5 or 6",
        ),
        (
            "         5         3",
            "         5         4",
            "line 13: dataset 58: the dataset of 4 points has 6 numbers: must be 2 for each point",
        ),
        ("        18 ", "        17 ", "line 14: dataset 58: the abscissa's type = 17: must be 18"),
        (
            "        18    0    0    0            Frequency                   Hz",
            "         0    0    0    0                 Time                    s",
            "line 14: dataset 58: the abscissa's unit = s: must be of a frequency, such as Hz",
        ),
        (
            "Frequency                   Hz",
            "Frequency               orders",
            "line 14: dataset 58: the abscissa's unit = orders: must be of a frequency",
        ),
        (
            "4.00000E+00",
            "4.0000xE+00",
            "line 18: dataset 58: the value = 4.0000xE+00: must be a finite number",
        ),
        (
            "4.00000E+00",
            "4.00000E+33",
            "line 18: dataset 58: the value = 4e33: must be -1e30 to 1e30: is the order of the bytes right?",
        ),
        (
            "        12    0",
            "      what    0",
            "line 15: dataset 58: the ordinate's type = what: must be a whole number",
        ),
    ] {
        assert!(UFF.contains(from));
        let found = refused(&UFF.replace(from, to));
        assert!(found.starts_with(message), "{to}: {found}");
    }
    let cut: Vec<&str> = UFF.lines().take(13).collect();
    assert!(refused(&cut.join("\n")).starts_with("line 14: dataset 58: the dataset's head is cut off"));
    assert_eq!(refused(&UFF.repeat(2)), FileError::ManyFunctions.to_string());
}

fn measurement() -> Measurement {
    let points = (0..12).map(|i| MeasuredPoint {
        frequency_hz: 100.0 + 0.125 * f64::from(i),
        response: Complex64::from_polar(10_f64.powi(i - 6), 0.5 * f64::from(i) - 3.0),
        noise: 1e-3,
        headroom_db: None,
    });
    let unit_per_response = Some(2.0);
    Measurement { unit_per_response, ..Measurement::at(0.03, SensorKind::Velocity, points.collect()) }
}

#[test]
fn what_is_exported_is_read_back_in_the_sensors_unit() {
    let measured = measurement();
    for (text, sensor, share) in
        [(measured.to_uff58(), Some(SensorKind::Velocity), 1e-12), (measured.to_frd(), None, 1e-12)]
    {
        let found = foreign(&text);
        assert_eq!((found.sensor, found.points.len()), (sensor, 12), "{text}");
        for (point, (frequency_hz, response)) in measured.points.iter().zip(pairs_of(&found)) {
            assert!((frequency_hz - point.frequency_hz).abs() < 1e-9, "{text}");
            let wanted = 2.0 * point.response;
            assert!((response - wanted).norm() < share * wanted.norm(), "{response} {wanted}: {text}");
        }
    }
    let Ok(File::Own(own)) = File::read(measured.to_csv().as_bytes(), &[]) else { panic!("the own form") };
    assert_eq!(own, measured);
}

#[test]
fn a_foreign_measurement_is_thinned_within_the_band_and_has_the_stated_noise() {
    let response = Some(Complex64::new(0.0, 2.0));
    let points = (0..5000).map(|i| ForeignPoint { line: 1, frequency_hz: f64::from(i), response }).collect();
    let found = Foreign { sensor: None, points, columns: Vec::new(), is_table: true };
    let of = |band_hz: (f64, f64), snr_db: f64| found.measurement(0.03, SensorKind::Strain, snr_db, band_hz);
    let measured = of((100.0, 1099.0), 20.0).expect("a measurement");
    assert_eq!((measured.points.len(), measured.points[1].frequency_hz), (334, 103.0));
    assert!((measured.points[0].noise - 0.2).abs() < 1e-12 && measured.sensor == SensorKind::Strain);
    assert_eq!(of((100.0, 120.0), 20.0).expect("a measurement").points.len(), 21);
    let few = of((100.0, 106.0), 20.0).expect_err("few").to_string();
    assert!(few.starts_with("the measurement has 7 points"), "{few}");
    let noise = of((100.0, 120.0), f64::NAN).expect_err("NaN").to_string();
    assert!(noise.starts_with("snr = NaN dB: must be 0 to 140 dB"), "{noise}");
}

proptest! {
    #[test]
    fn no_bytes_make_a_reader_panic(
        file in 0..5_usize, at in prop::collection::vec((0.0..1.0_f64, any::<u8>(), 0..3_u8), 1..8),
    ) {
        let table = "* Freq(Hz), SPL(dB), Phase(degrees)\n100, -20, 90\n200.5, -3, 0\n".to_owned();
        let files = [UFF.to_owned(), table, measurement().to_uff58(), measurement().to_frd(), measurement().to_csv()];
        let mut bytes = files[file].clone().into_bytes();
        for (share, byte, action) in at {
            let at = (share * bytes.len() as f64) as usize;
            match action {
                0 if at < bytes.len() => bytes[at] = byte,
                1 => bytes.truncate(at),
                _ => bytes.insert(at, byte),
            }
        }
        if let Ok(File::Foreign(foreign)) = File::read(&bytes, &[]) {
            let _ = foreign.measurement(0.03, SensorKind::Velocity, 40.0, (1.0, 1e4));
        }
    }
}
