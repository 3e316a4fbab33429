//! Tables that look like others: each was, or could be, read to other numbers without a word.

use super::siblings::{check, comma, linear, read, rows};
use std::f64::consts::{PI, TAU};

fn semicolons(hz: f64, db: f64, degrees: f64) -> String {
    format!("{hz};{db};{degrees}\n")
}

#[test]
fn units_stand_above_the_names_too() {
    let many_turns = |hz: f64, db: f64, d: f64| format!("{hz};{db};{:.9}\n", d.to_radians() - 12.0 * PI);
    let angular = |hz: f64, db: f64, d: f64| format!("{:.9};{db};{d}\n", TAU * hz);
    let thousands = |hz: f64, db: f64, d: f64| format!("{:.9};{db};{d}\n", hz / 1e3);
    for (head, rows) in [
        ("Hz;dB;rad\nFrequency;Level;Phase\n", rows(many_turns)),
        ("[rad/s];[dB];[deg]\nFrequency;Level;Phase\n", rows(angular)),
        ("# kHz;dB;deg\n# Frequency;Level;Phase\n", rows(thousands)),
        ("Run 3\nHz;dB;deg\nFrequency;Level;Phase\n", rows(semicolons)),
    ] {
        check(head, (head.to_owned() + &rows).as_bytes(), 1.0);
    }
}

#[test]
fn names_of_other_forms_are_read() {
    let thousands = |hz: f64, db: f64, d: f64| format!("{:.9};{db};{:.9}\n", hz / 1e3, d.to_radians());
    let speed = |hz: f64, db: f64, d: f64| format!("{hz};{:.9e};{d}\n", linear(db));
    let index = |hz: f64, db: f64, d: f64| format!("28.11.2025 12:00:01;{hz};{db};{d}\n");
    for (head, rows, size) in [
        ("f/Hz;Pegel/dB;φ/°\n", comma(semicolons), 1.0),
        ("freq_khz;mag_db;phase_rad\n", rows(thousands), 1.0),
        ("FrequencyHz;MagnitudeDb;PhaseDeg\n", rows(semicolons), 1.0),
        ("Frequency (Hz);vel_mm_per_s;Phase (deg)\n", rows(speed), 1e-3),
        ("Frequency (Hz);Sound pressure (µPa);Phase (deg)\n", rows(speed), 1e-6),
        ("Timestamp;Frequency (Hz);Level (dB);Phase (deg)\n", rows(index), 1.0),
        ("Frequency (Hz);Level (dB);Phase (deg);;;\n", rows(semicolons).replace('\n', ";;;\n"), 1.0),
        ("Messung 2; Sensor 1\nFrequenz in Hz;Pegel in dB;Phase in Grad\n", comma(semicolons), 1.0),
    ] {
        check(head, (head.to_owned() + &rows).as_bytes(), size);
    }
}

/// Checks that a text is refused with these words.
fn refused(text: &str, words: &str) {
    let error = read(text.as_bytes()).expect_err(text);
    assert!(error.contains(words), "{text}: {error}");
}

#[test]
fn numbers_without_a_unit_that_could_be_in_two_are_refused() {
    let turning = |hz: f64, db: f64, _: f64| format!("{hz};{db};{:.3}\n", -(hz - 80.0) / 5.0 - 8.0);
    refused(
        &("Frequency;Level;Phase\n".to_owned() + &rows(turning)),
        "nothing shows whether *Phase* is in degrees or in radians",
    );
    let above = |by: f64| rows(|hz, db, d| format!("{hz};{};{d}\n", db + by));
    let small = rows(|hz, db, d| format!("{hz};{:.9};{d}\n", linear(db)));
    for (name, rows) in [
        ("Magnitude", above(25.0)),
        ("Amplitude", above(90.0)),
        ("Acceleration", above(60.0)),
        ("Velocity", above(0.0)),
        ("Level", small),
    ] {
        let text = format!("Frequency (Hz);{name};Phase (deg)\n{rows}");
        refused(&text, &format!("nothing shows whether *{name}* is in dB"));
    }
}

#[test]
fn units_in_a_sentence_above_the_names_are_not_passed_over() {
    let angular = |hz: f64, db: f64, d: f64| format!("{:.9};{db};{d}\n", TAU * hz);
    for units in
        ["# Units: rad/s, dB, deg", "[rad/s] [dB]", "rad/s;dB", "# rad/s S DB R 50", "Frequencies: rad/s"]
    {
        let text = format!("{units}\nFrequency;Level;Phase\n{}", rows(angular));
        refused(&text, "line 1: the names are not those of 3 columns");
    }
}

#[test]
fn columns_beside_their_names_are_refused() {
    let mut at = 0;
    let counted: Vec<String> = rows(|hz, db, d| format!("{hz};{db};{d}\n"))
        .lines()
        .map(|line| {
            at += 1;
            format!("{at};{line}\n")
        })
        .collect();
    refused(
        &("Frequency;Level;Phase;\n".to_owned() + &counted.concat()),
        "line 1: the names are not those of 4 columns",
    );
    let leading = rows(|hz, db, d| format!(";{hz};{db};{d}\n"));
    for head in ["Frequency (Hz);Level (dB);Phase (deg)\n", "Frequency (Hz);Level (dB);Phase (deg);\n"] {
        refused(&(head.to_owned() + &leading), "line 1: the names are not those of 4 columns");
    }
    let without_phase: String =
        counted.iter().map(|line| line.rsplit_once(';').expect("cells").0.to_owned() + "\n").collect();
    refused(&without_phase, "the first may count the rows, and the second be the frequency");
}

#[test]
fn a_row_with_a_cell_fewer_is_refused_by_its_line() {
    let text =
        rows(|hz, db, d| if hz == 103.0 { format!("{hz}        {d}\n") } else { format!("{hz} {db} {d}\n") });
    let text = "Frequency(Hz) Level(dB) Coherence\n".to_owned() + &text;
    refused(&text, "line 4: 2 cells, but most rows have 3");
    refused(&text.replace("        ", " ").replace(' ', "\t"), "line 4: 2 cells, but most rows have 3");
    // A note stands behind few rows.
    let noted =
        rows(
            |hz, db, d| {
                if hz == 103.0 { format!("{hz};{db};{d};by hand\n") } else { format!("{hz};{db};{d}\n") }
            },
        );
    check("a note", ("Hz;dB;deg;Note\n".to_owned() + &noted).as_bytes(), 1.0);
}

#[test]
fn a_number_too_large_for_any_is_refused() {
    let text = "Hz;dB;deg\n".to_owned() + &rows(semicolons);
    refused(&text.replace("114.5", &"1".repeat(400)), "line 5: column 1");
    refused(&text.replace("-2.5", "-2.5e999"), "line 5: column 2");
}

#[test]
fn units_with_blanks_in_brackets_are_whole() {
    for head in [
        "Frequency (Hz);Level (dB re 20 µPa);Phase (deg)\n",
        "Frequency [Hz];Level [dB rel. 1 V];Phase [deg]\n",
    ] {
        check(head, (head.to_owned() + &rows(semicolons)).as_bytes(), 1.0);
    }
}

#[test]
fn a_mark_of_groups_that_could_be_a_decimal_sign_is_refused() {
    let grouped = |mark: char| {
        rows(|hz, db, d| {
            let hz = 10.0 * hz.floor();
            let hz = if hz < 1000.0 { format!("{hz}") } else { format!("1{mark}{:03}", hz - 1000.0) };
            format!("\"{hz}\";{db:.0};{d:.0}\n")
        })
    };
    let head = "Frequency (Hz);Level (dB);Phase (deg)\n";
    for mark in [',', '.'] {
        refused(&(head.to_owned() + &grouped(mark)), "could be 1030, or have three decimals");
    }
    // Other numbers show which sign is the decimal one.
    let sure = head.to_owned() + &grouped('.') + "1.990;-30,5;1\n";
    assert_eq!(read(sure.as_bytes()).expect("a table").points[2].frequency_hz, 1030.0);
}

#[test]
fn a_number_that_multiplies_or_divides_is_refused() {
    for head in [
        "Frequency/100 Hz;Level (dB);Phase (deg)",
        "2*Frequency (Hz);Level (dB);Phase (deg)",
        "Frequency (Hz) x 10;Level (dB);Phase (deg)",
        "Frequency (x100 Hz);Level (dB);Phase (deg)",
        "Frequency [10^2 Hz];Level (dB);Phase (deg)",
        "Frequency (Hz);Level*10 (dB);Phase (deg)",
        "Frequency (Hz);Level (0.1 dB);Phase (deg)",
        "Frequency (Hz);Level (dB);Phase/2 (deg)",
        "Frequency (Hz);|H|^2 magnitude (V);Phase (deg)",
        "Frequency (Hz);Level (dB);phase_rad/s",
    ] {
        refused(&format!("{head}\n{}", rows(semicolons)), "line 1: ");
    }
}
