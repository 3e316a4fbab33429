//! Random tables and universal files as programs and spreadsheets may write them: read to the truth or refused, never read
//! to something else. The seed is fixed; `SLIPLINE_TABLES=100000 cargo test .. generated` tries more.

use crate::calibrate::{File, Foreign};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Numbers of splitmix64: the same on every processor.
pub(super) struct Random(pub(super) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

/// What a column may be called, its unit in the file, and SI units per that unit (0: decibels).
type Called = (&'static [&'static str], &'static [(&'static str, f64)]);

const FREQUENCY: Called = (
    &[
        "Frequency",
        "Freq",
        "f",
        "FREQ.",
        "Frequenz",
        "Fréquence",
        "Frecuencia",
        "Frequenza",
        "frq",
        "Freq of trace 1",
    ],
    &[("Hz", 1.0), ("HZ", 1.0), ("kHz", 1e3), ("rad/s", 1.0 / TAU)],
);
const LEVEL: Called = (
    &["Level", "SPL", "Pegel", "Niveau", "Magnitude", "Mag", "Gain", "H1"],
    &[("dB", 0.0), ("dB SPL", 0.0), ("dBFS", 0.0)],
);
const MAGNITUDE: Called = (
    &["Magnitude", "Amplitude", "Betrag", "Mag.", "abs"],
    &[("V", 1.0), ("mV", 1e-3), ("lin", 1.0), ("Pa", 1.0)],
);
const DISPLACEMENT: Called = (
    &["Displacement", "Auslenkung", "displacement magnitude"],
    &[("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("um/N", 1e-6)],
);
const VELOCITY: Called =
    (&["Velocity", "Vib Velocity", "Geschwindigkeit"], &[("m/s", 1.0), ("mm/s", 1e-3), ("(m/s)/N", 1.0)]);
const ACCELERATION: Called =
    (&["Acceleration", "Accel", "Beschleunigung"], &[("m/s²", 1.0), ("m/s^2", 1.0), ("g", 9.806_65)]);
const PHASE: Called = (
    &["Phase", "Phase angle", "Winkel", "Fase", "arg(H)", "Displacement phase"],
    &[("deg", PI / 180.0), ("°", PI / 180.0), ("Degrees", PI / 180.0), ("rad", 1.0)],
);
const REAL: Called =
    (&["Real", "Re", "Realteil", "Real part", "Re(H)"], &[("m/N", 1.0), ("V", 1.0), ("mm", 1e-3)]);
const IMAGINARY: Called =
    (&["Imag", "Im", "Imaginärteil", "Imaginary part", "Im(H)"], &[("m/N", 1.0), ("V", 1.0), ("mm", 1e-3)]);
/// Columns that are none of the response: some known, some of no known name, some that could be the response.
const OTHERS: &[&str] = &[
    "Coherence",
    "Noise (dB)",
    "Index",
    "No.",
    "Time (s)",
    "Kohärenz",
    "Foo",
    "Temperature (°C)",
    "SNR (dB)",
    "THD [%]",
    "Ch. 2",
    "Std level (dB)",
    "Group delay (ms)",
    "Level error (dB)",
    "Magnitude (dB) Ref",
    "Phase 2 (deg)",
    "Reference level (dB)",
    "Input (dB)",
    "Displacement coherence",
    "Frequency error (Hz)",
    "Quality",
    "",
];

/// A column: its name, unit and values as they are written, in SI.
struct Written {
    name: String,
    unit: String,
    values: Vec<f64>,
    /// SI units per unit; 0 for decibels.
    size: f64,
}

fn written(random: &mut Random, called: Called, at: usize, si: &[f64]) -> Written {
    let (names, units) = called;
    // The parts of a response have the same unit.
    let (unit, size) = units[at % units.len()];
    let values =
        si.iter().map(|value| if size == 0.0 { 20.0 * value.log10() } else { value / size }).collect();
    Written { name: random.of(names).to_owned(), unit: unit.to_owned(), values, size }
}

/// A number as a program writes it, and its value.
fn number(value: f64, style: (usize, usize), comma: bool, marks: (char, char)) -> (String, f64) {
    let (form, digits) = style;
    let text = match form {
        0 => format!("{value:.digits$}"),
        1 => format!("{value:.digits$e}"),
        _ => format!("{value:.digits$e}").to_uppercase().replace("E", "E+").replace("E+-", "E-"),
    };
    let exact: f64 = text.parse().expect("a number");
    let (group, minus) = marks;
    let (whole, rest) = text.split_at(text.find(['.', 'e', 'E']).unwrap_or(text.len()));
    let sign = whole.starts_with('-');
    let whole = whole.trim_start_matches('-');
    let mut grouped = String::new();
    for (at, digit) in whole.chars().enumerate() {
        if group != ' ' && at > 0 && (whole.len() - at) % 3 == 0 {
            grouped.push(group);
        }
        grouped.push(digit);
    }
    let rest = if comma { rest.replace('.', ",") } else { rest.to_owned() };
    let minus = if sign { minus.to_string() } else { String::new() };
    (format!("{minus}{grouped}{}", rest.replace('-', &marks.1.to_string())), exact)
}

/// A table's bytes, and the frequencies and responses that it holds.
fn table(random: &mut Random) -> (Vec<u8>, Vec<(f64, Complex64)>) {
    let count = 3 + random.below(20);
    let mut frequencies: Vec<f64> = Vec::new();
    let mut hz = random.within(20.0, 3000.0);
    for _ in 0..count {
        hz += random.within(1.0, 900.0);
        frequencies.push(hz);
    }
    if random.one_in(6) {
        frequencies.reverse();
    }
    let magnitudes: Vec<f64> = (0..count).map(|_| 10_f64.powf(random.within(-3.0, 1.5))).collect();
    let phases: Vec<f64> = (0..count).map(|_| random.within(-3.1, 3.1)).collect();
    let form = random.below(6);
    let has_phase = random.below(4) > 0;
    let [of_frequency, at, of_phase] = [0; 3].map(|_: usize| random.below(12));
    let mut columns = vec![written(random, FREQUENCY, of_frequency, &frequencies)];
    let has_complex = form == 5;
    if has_complex {
        let part = |of: fn(f64) -> f64| -> Vec<f64> {
            magnitudes.iter().zip(&phases).map(|(m, p)| m * of(*p)).collect()
        };
        columns.push(written(random, REAL, at, &part(f64::cos)));
        columns.push(written(random, IMAGINARY, at, &part(f64::sin)));
    } else {
        let called = [LEVEL, MAGNITUDE, DISPLACEMENT, VELOCITY, ACCELERATION][form];
        columns.push(written(random, called, at, &magnitudes));
        if has_phase {
            columns.push(written(random, PHASE, of_phase, &phases));
        }
    }
    let of_response = columns.len();
    for _ in 0..random.below(3) {
        let values = (0..count).map(|_| random.within(0.0, 40.0)).collect();
        // Where there is no other phase, a second one is the phase.
        let name = match random.of(OTHERS) {
            "Phase 2 (deg)" if !has_phase => "Phase coherence",
            name => name,
        };
        columns.push(Written { name: name.to_owned(), unit: String::new(), values, size: 1.0 });
    }
    // How its numbers are written.
    let comma = random.one_in(3);
    let delimiter = random.of(&["\t", ";", ",", " ", "|", ", ", "; ", "  "]);
    if delimiter.starts_with(' ') {
        // Between blanks there is no empty name.
        columns.iter_mut().filter(|it| it.name.is_empty()).for_each(|it| it.name = "Foo".to_owned());
    }
    let group = if random.one_in(6) {
        random.of(&['\u{a0}', '\'', '\u{202f}', if comma { '.' } else { ',' }])
    } else {
        ' '
    };
    let marks = (group, if random.one_in(6) { '−' } else { '-' });
    let style = (random.below(3), 2 + random.below(8));
    let is_quoted = random.one_in(5) || delimiter.contains(',') && (comma || group == ',');
    let quote = |text: &str| if is_quoted { format!("\"{text}\"") } else { text.to_owned() };
    let mut exact: Vec<Vec<f64>> = vec![Vec::new(); count];
    let mut order: Vec<usize> = (0..columns.len()).collect();
    if random.one_in(3) {
        order.reverse();
    }
    let end = random.of(&["\n", "\r\n", "\r"]);
    let trailing = if random.one_in(6) && !delimiter.starts_with(' ') {
        delimiter.repeat(1 + random.below(2))
    } else {
        String::new()
    };
    let mut rows = String::new();
    for (row, exact) in exact.iter_mut().enumerate() {
        let cells: Vec<(String, f64)> =
            columns.iter().map(|column| number(column.values[row], style, comma, marks)).collect();
        *exact = cells.iter().map(|cell| cell.1).collect();
        let line: Vec<String> = order.iter().map(|&at| quote(&cells[at].0)).collect();
        rows += &(line.join(delimiter) + &trailing + end);
        if random.one_in(30) {
            rows += &format!("# comment{end}");
        }
    }
    let text = head(random, &columns, &order, (delimiter, &trailing, end), &quote, of_response) + &rows;
    let truth = exact.iter().map(|row| {
        let si = |at: usize| {
            let size = columns[at].size;
            if size == 0.0 { 10_f64.powf(row[at] / 20.0) } else { row[at] * size }
        };
        let response = match (has_complex, of_response) {
            (true, _) => Complex64::new(si(1), -si(2)),
            (false, 3) => Complex64::from_polar(si(1), -si(2)),
            _ => Complex64::new(si(1), 0.0),
        };
        (si(0), response)
    });
    (encoded(random, &text), truth.collect())
}

/// What stands above the rows.
fn head(
    random: &mut Random,
    columns: &[Written],
    order: &[usize],
    (delimiter, trailing, end): (&str, &str, &str),
    quote: &dyn Fn(&str) -> String,
    of_response: usize,
) -> String {
    let titles = [
        "Measurement of frequency response, 28 Nov 2025",
        "Messung 3",
        "\"Test, run 2\"",
        "* Source: microphone, 48 kHz",
        "# f_max = 3000",
        "Points: 59",
        "Date;28.11.2025",
        "% drawn by hand",
        "* no smoothing applied",
        "Start, 20, Hz",
        "* 1/48 octave smoothing",
    ];
    let mut text = String::new();
    for _ in 0..random.below(3) {
        text += &format!("{}{trailing}{end}", random.of(&titles));
    }
    let style = random.below(7);
    let mark = random.of(&["", "", "", "* ", "# ", "#"]);
    let named = |column: &Written| match (style, &*column.unit) {
        (_, "") => column.name.clone(),
        (0, unit) => format!("{} ({unit})", column.name),
        (1, unit) => format!("{} [{unit}]", column.name),
        (2, unit) => format!("{}({unit})", column.name),
        (3, unit) if unit.chars().all(char::is_alphabetic) => {
            format!("{}_{}", column.name.to_lowercase(), unit.to_lowercase())
        }
        (3, unit) => format!("{} [ {unit} ]", column.name),
        (4 | 6, _) => column.name.clone(),
        // Units alone.
        (_, unit) if of_response == columns.len() => unit.to_owned(),
        (_, unit) => format!("{} {unit}", column.name),
    };
    let line = |of: &dyn Fn(&Written) -> String| {
        let cells: Vec<String> = order.iter().map(|&at| quote(&of(&columns[at]))).collect();
        format!("{mark}{}{trailing}{end}", cells.join(delimiter))
    };
    let units = line(&|column: &Written| match &*column.unit {
        "" if style == 6 => String::new(),
        "" => "-".to_owned(),
        unit => format!("[ {unit} ]"),
    });
    // Some programs write the units above the names.
    let of_units = if matches!(style, 4 | 6) { &*units } else { "" };
    let named = line(&named);
    text += &if style == 6 { of_units.to_owned() + &named } else { named + of_units };
    if random.one_in(8) {
        text += &format!("{}{end}", random.of(&["", "* as measured", "---", "# end of head"]));
    }
    text
}

fn encoded(random: &mut Random, text: &str) -> Vec<u8> {
    let wide = |order: fn(u16) -> [u8; 2], mark: [u8; 2]| -> Vec<u8> {
        mark.into_iter().chain(text.encode_utf16().flat_map(order)).collect()
    };
    let is_narrow =
        text.chars().all(|letter| u32::from(letter) < 0x80 || (0xa0..0x100).contains(&u32::from(letter)));
    match random.below(6) {
        0 => wide(u16::to_le_bytes, [0xff, 0xfe]),
        1 => wide(u16::to_be_bytes, [0xfe, 0xff]),
        2 => [b"\xef\xbb\xbf", text.as_bytes()].concat(),
        3 if is_narrow => text.chars().map(|letter| letter as u8).collect(),
        _ => text.as_bytes().to_vec(),
    }
}

/// Whether what was read is the truth.
fn is_true(found: &Foreign, truth: &[(f64, Complex64)]) -> bool {
    found.points.len() == truth.len()
        && found.points.iter().zip(truth).all(|(point, (hz, response))| {
            let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
            let wrong = |it: Complex64| (it - response).norm() > 1e-9 * response.norm();
            is_near(point.frequency_hz, *hz) && !point.response.is_none_or(wrong)
        })
}

fn many(default: u64) -> u64 {
    std::env::var("SLIPLINE_TABLES").ok().and_then(|count| count.parse().ok()).unwrap_or(default)
}

#[test]
fn random_tables_are_read_to_the_truth_or_refused() {
    let mut read = 0;
    let count = many(2_000);
    for seed in 0..count {
        let (bytes, truth) = table(&mut Random(seed));
        match File::read(&bytes, &[]) {
            Ok(File::Foreign(found)) => {
                assert!(
                    is_true(&found, &truth),
                    "seed {seed}: {}\n{found:?}\n{truth:?}",
                    String::from_utf8_lossy(&bytes)
                );
                read += 1;
            }
            Ok(File::Own(_)) => panic!("seed {seed}: not our own"),
            Err(error) => {
                if std::env::var_os("SLIPLINE_SHOW").is_some() {
                    println!(
                        "seed {seed}: {error}\n{}",
                        String::from_utf8_lossy(&bytes).lines().take(6).collect::<Vec<_>>().join("\n")
                    );
                }
            }
        }
    }
    println!("{read} of {count} tables are read");
    assert!(10 * read > 6 * count, "{read} of {count} tables are read");
}

/// A universal file's bytes, and its frequencies and responses; `None` where it must be refused.
fn universal(random: &mut Random) -> (Vec<u8>, Option<Vec<(f64, Complex64)>>) {
    let count = 1 + random.below(40);
    let (is_complex, is_double, is_even) = (random.one_in(2), random.one_in(2), random.one_in(2));
    let (label, hertz) =
        random.of(&[("Hz", 1.0), ("kHz", 1e3), ("rad/s", 1.0 / TAU), ("NONE", 1.0), ("", 1.0)]);
    let is_level = random.one_in(6);
    let start = (random.within(1.0, 100.0) * 100.0).round() / 100.0;
    let step = (random.within(0.1, 9.0) * 100.0).round() / 100.0;
    let fortran = |value: f64, width: usize, digits: usize, style: usize| {
        let text = format!("{value:.digits$e}");
        let (mantissa, exponent) = text.split_once('e').expect("an exponent");
        let exponent: i32 = exponent.parse().expect("an exponent");
        let (sign, letter) = (if exponent < 0 { '-' } else { '+' }, ["E", "D", "e"][style]);
        let text = format!("{mantissa}{letter}{sign}{:02}", exponent.abs());
        (format!("{text:>width$}"), format!("{value:.digits$e}").parse::<f64>().expect("a number"))
    };
    let style = random.below(3);
    let (width, digits) = if is_double { (20, 12) } else { (13, 5) };
    let mut fields: Vec<String> = Vec::new();
    let (mut truth, mut is_negative) = (Vec::new(), false);
    for i in 0..count {
        let mut hz = start + step * i as f64;
        if !is_even {
            let field = fortran(hz, 13, 5, style);
            fields.push(field.0);
            hz = field.1;
        }
        let mut ordinate = |random: &mut Random, low: f64| {
            let power = if is_level { 1 } else { random.below(9) as i32 - 4 };
            let field = fortran(random.within(low, 9.0) * 10_f64.powi(power), width, digits, style);
            fields.push(field.0);
            field.1
        };
        // What is negative is no magnitude, unless it is in decibels.
        let low = if is_complex || is_level || random.one_in(200) { -9.0 } else { 0.0 };
        let re = ordinate(random, low);
        is_negative |= !is_complex && !is_level && re < 0.0;
        let response = match (is_complex, is_level) {
            (true, _) => Complex64::new(re, -ordinate(random, -9.0)),
            (false, true) => Complex64::new(10_f64.powf(re / 20.0), 0.0),
            (false, false) => Complex64::new(re, 0.0),
        };
        truth.push((hertz * hz, response));
    }
    let per_line = match (is_double, is_even, is_complex) {
        (false, ..) => 6,
        (true, true, _) | (true, false, false) => 4,
        (true, false, true) => 3,
    };
    let mut lost = is_negative;
    if random.one_in(10) {
        fields.pop();
        lost = true;
    } else if random.one_in(3) {
        let zero = fortran(0.0, width, digits, style).0;
        while !fields.len().is_multiple_of(per_line) {
            fields.push(zero.clone());
        }
    }
    let end = random.of(&["\n", "\r\n", "\r"]);
    let pad = |line: &str| if style == 1 { format!("{line:<80}{end}") } else { format!("{line}{end}") };
    let mut text = String::new();
    if random.one_in(4) {
        text += &format!("Exported by a program, 28 Nov 2025{end}{end}");
    }
    if random.one_in(3) {
        text += &["    -1", "   151", "model", "NONE", "    -1"].map(pad).concat();
    }
    text += &["    -1", "    58", "Sensor 3 µ", "NONE", "28-Nov-25 10:00:00", "NONE", "-1 of 2"]
        .map(pad)
        .concat();
    text += &pad("    4         0    0         0 NONE               1   3 NONE               1   3");
    let form = [[2, 4], [5, 6]][usize::from(is_complex)][usize::from(is_double)];
    let (first, increment) = if is_even { (start, step) } else { (0.0, 0.0) };
    let zero = fortran(0.0, 13, 5, 0).0;
    let axis = format!("{}{}", fortran(first, 13, 5, 0).0, fortran(increment, 13, 5, 0).0);
    text += &pad(&format!("{form:>10}{count:>10}{:>10}{axis}{zero}", u8::from(is_even)));
    text += &pad(&format!("        18    0    0    0 Frequency            {label:<20}"));
    let unit = if is_level { "dB" } else { "m/s^2" };
    text += &pad(&format!("        12    0    0    0 Acceleration         {unit:<20}"));
    text += &pad("        13    0    0    0 Excitation           N                   ");
    text += &pad("         0    0    0    0 NONE                 NONE                ");
    for line in fields.chunks(per_line) {
        text += &pad(&line.concat());
    }
    text += &pad("    -1");
    (text.into_bytes(), (!lost).then_some(truth))
}

#[test]
fn random_universal_files_are_read_to_the_truth_or_refused() {
    for seed in 0..many(2_000) {
        let (bytes, truth) = universal(&mut Random(seed));
        let text = String::from_utf8_lossy(&bytes);
        match (File::read(&bytes, &[]), truth) {
            (Ok(File::Foreign(found)), Some(truth)) => {
                assert!(is_true(&found, &truth), "seed {seed}: {text}\n{found:?}\n{truth:?}");
            }
            (Err(_), None) => {}
            (found, _) => panic!("seed {seed}: {text}\n{found:?}"),
        }
    }
}
