//! Two more files of each kind that was misread once: read to the same ten rows, or refused in words.

use crate::calibrate::{File, Foreign};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Frequency, decibels and degrees.
pub(super) const ROWS: [(f64, f64, f64); 10] = [
    (81.5, -20.5, 90.0),
    (92.25, -14.0, 60.5),
    (103.0, -8.25, 30.0),
    (114.5, -2.5, -12.0),
    (125.0, 3.0, -45.5),
    (136.75, 6.5, -90.0),
    (147.0, 2.0, -135.25),
    (158.5, -5.5, -170.0),
    (169.0, -11.0, 175.5),
    (180.25, -16.5, 160.0),
];

/// The rows as lines, each by `line` of frequency, decibels and degrees.
pub(super) fn rows(line: impl Fn(f64, f64, f64) -> String) -> String {
    ROWS.map(|(hz, db, degrees)| line(hz, db, degrees)).concat()
}

/// The rows with a decimal comma.
pub(super) fn comma(line: impl Fn(f64, f64, f64) -> String) -> String {
    rows(line).replace('.', ",")
}

pub(super) fn linear(db: f64) -> f64 {
    10_f64.powf(db / 20.0)
}

pub(super) fn read(bytes: &[u8]) -> Result<Foreign, String> {
    match File::read(bytes, &[]) {
        Ok(File::Foreign(foreign)) => Ok(foreign),
        Ok(File::Own(_)) => Err("own".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

/// Checks that a file holds the rows, in rising order or falling, `size` times as large.
pub(super) fn check(kind: &str, bytes: &[u8], size: f64) {
    let shown = String::from_utf8_lossy(bytes);
    let found = read(bytes).unwrap_or_else(|error| panic!("{kind}: {error}\n{shown}"));
    let mut points: Vec<(f64, Complex64)> = found
        .points
        .iter()
        .filter_map(|point| Some((point.frequency_hz, point.response?)))
        .filter(|it| it.0 > 0.0)
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(points.len(), ROWS.len(), "{kind}: {shown}");
    for ((hz, response), (wanted_hz, db, degrees)) in points.into_iter().zip(ROWS) {
        let wanted = Complex64::from_polar(size * linear(db), -degrees.to_radians());
        assert!(
            (hz - wanted_hz).abs() < 1e-6 * hz && (response - wanted).norm() < 1e-6 * wanted.norm(),
            "{kind}: {hz} {response} {wanted}: {shown}"
        );
    }
}

#[test]
fn two_more_files_of_each_kind_are_read_to_the_same_rows() {
    let own = |hz: f64, db: f64, degrees: f64| format!("{hz},{db},{degrees}\n");
    let tabs = |hz: f64, db: f64, degrees: f64| format!("{hz}\t{db}\t{degrees}\n");
    let blanks = |hz: f64, db: f64, degrees: f64| format!("{hz} {db} {degrees}\n");
    let semicolons = |hz: f64, db: f64, degrees: f64| format!("{hz};{db};{degrees}\n");
    let lin = |hz: f64, db: f64, degrees: f64| format!("{hz},{:.9e},{degrees}\n", linear(db));
    for (kind, text, size) in [
        // d01: a quantity whose name holds "spl" or "db".
        ("d01", "f (Hz),Displacement amplitude (mm),Phase (deg)\n".to_owned() + &rows(lin), 1e-3),
        ("d01", "Frequency (Hz),Vitesse [mm/s],Phase [°]\n".to_owned() + &rows(lin), 1e-3),
        ("d01", "f in Hz,Acceleration [m·s⁻²],Phase [°]\n".to_owned() + &rows(lin), 1.0),
        ("d01", "// by hand\n// Hz,Mobility [(mm/s)/N],deg\n".to_owned() + &rows(lin), 1e-3),
        // d02: names without units, units as names.
        ("d02", "hz,abs,degrees\n".to_owned() + &rows(lin), 1.0),
        (
            "d02",
            "Freq,Betrag,Phase_rad\n".to_owned()
                + &rows(|hz, db, d| format!("{hz},{:.9e},{:.9}\n", linear(db), d.to_radians())),
            1.0,
        ),
        // d03: blanks within names.
        (
            "d03",
            "* Frequency (Hz)  Sound pressure level (dB)  Phase angle (deg)\n".to_owned() + &rows(blanks),
            1.0,
        ),
        ("d03", "Freq [Hz] Mag [dB] Phase [deg]\n".to_owned() + &rows(blanks), 1.0),
        // d04: a row of units.
        ("d04", "Frequency;Level;Phase\nHz;dB;°\n\n".to_owned() + &rows(semicolons), 1.0),
        (
            "d04",
            "# Frequency\tVib Velocity\tPhase\n# [ Hz ]\t[ mm/s ]\t[ rad ]\n".to_owned()
                + &rows(|hz, db, d| format!("{hz}\t{:.9e}\t{:.9}\n", linear(db), d.to_radians())),
            1e-3,
        ),
        (
            "d04",
            "Frequency;Level;Phase;Noise\nHz;dB;deg;\n".to_owned()
                + &rows(|hz, db, d| format!("{hz};{db};{d};3\n")),
            1.0,
        ),
        // d05: other units of frequency and phase.
        (
            "d05",
            "Frequency (kHz),Level (dB),Phase (mrad)\n".to_owned()
                + &rows(|hz, db, d| format!("{:.9},{db},{:.6}\n", hz / 1e3, d * PI / 0.18)),
            1.0,
        ),
        (
            "d05",
            "Angular frequency (rad/s),Magnitude (dB),Phase (radians)\n".to_owned()
                + &rows(|hz, db, d| format!("{:.9},{db},{:.9}\n", 2.0 * PI * hz, d.to_radians())),
            1.0,
        ),
        (
            "d05",
            "ω (rad/s),Magnitude (dB),Phase (deg)\n".to_owned()
                + &rows(|hz, db, d| format!("{:.9},{db},{d}\n", 2.0 * PI * hz)),
            1.0,
        ),
        // d06: quoted decimal commas.
        (
            "d06",
            "\"Freq (Hz)\",\"Pegel (dB)\",\"Phase (deg)\",\"Coherence\"\n".to_owned()
                + &comma(|hz, db, d| format!("\"{hz}\";\"{db}\";\"{d}\";\"0.5\"\n"))
                    .replace("\";\"", "\",\""),
            1.0,
        ),
        (
            "d06",
            "Freq (Hz);Pegel (dB);Phase (deg)\r\n".to_owned()
                + &comma(|hz, db, d| format!("\"{hz}\";{db};\"{d}\"\r\n")),
            1.0,
        ),
        // d20: rows that cannot matter.
        ("d20", "Frequency (Hz),Level (dB),Phase (deg)\n0,,\n".to_owned() + &rows(own), 1.0),
        (
            "d20",
            "Frequency (Hz);Level (dB);Phase (deg)\n-1;-∞;0\n0;#NUM!;NaN\n".to_owned() + &rows(semicolons),
            1.0,
        ),
        ("d20", "Frequency (Hz),Level (dB),Phase (deg)\n0,-1.#INF00,#¡DIV/0!\n".to_owned() + &rows(own), 1.0),
        // d21: falling frequencies.
        (
            "d21",
            "Hz,dB,deg\n".to_owned()
                + &rows(own).lines().rev().map(|line| format!("{line}\n")).collect::<String>(),
            1.0,
        ),
        ("d21", rows(blanks).lines().rev().map(|line| format!("{line}\r\n")).collect::<String>(), 1.0),
        // d22: ends of lines, signs of minus.
        ("d22", ("* made by hand\nHz;dB;deg\n".to_owned() + &rows(semicolons)).replace('\n', "\r"), 1.0),
        ("d22", "Hz\tdB\tdeg\n".to_owned() + &rows(tabs).replace('-', "–"), 1.0),
        // d23: titles.
        (
            "d23",
            "\"Level, phase, and frequency of run 3\"\n\n3 sweeps, 20 averages\nFrequency,Level,Phase (deg)\n"
                .to_owned() + &rows(own),
            1.0,
        ),
        (
            "d23",
            "Run;28.11.2025;12\nOperator;Ann;\nf/Hz;L/dB;Phase/°\n".replace("L/dB", "Level / dB")
                + &comma(semicolons),
            1.0,
        ),
        // d24: names in other languages.
        ("d24", "Fréquence (Hz);Niveau (dB);Phase (°)\n".to_owned() + &comma(semicolons), 1.0),
        ("d24", "Frecuencia [Hz]\tMagnitud [dB]\tFase [grados]\n".to_owned() + &rows(tabs), 1.0),
        ("d24", "Частота (Гц);Уровень (дБ);Фаза (град)\n".to_owned() + &comma(semicolons), 1.0),
        ("d24", "Частота, Гц;Уровень, дБ;Фаза, град\n".to_owned() + &comma(semicolons), 1.0),
        ("d24", "Frequenz in Hz;Pegel in dB;Phase in Grad\n".to_owned() + &comma(semicolons), 1.0),
        ("d24", "FREKANS (Hz);GENLİK (dB);FAZ (derece)\n".to_owned() + &comma(semicolons), 1.0),
        // An accent that is a mark of its own, and brackets as wide as the letters.
        ("d24", "Fre\u{301}quence (Hz);Niveau (dB);Phase (degrés)\n".to_owned() + &comma(semicolons), 1.0),
        ("d24", "频率（Hz）;幅值（dB）;相位（度）\n".to_owned() + &rows(semicolons), 1.0),
    ] {
        check(kind, text.as_bytes(), size);
    }
    let german = "Frequenz [Hz];Pegel [dB];Winkel [°]\n".to_owned() + &comma(semicolons);
    let narrow: Vec<u8> = german.chars().map(|letter| letter as u8).collect();
    check("d24 in code page 1252", &narrow, 1.0);
    check(
        "d04 in UTF-16 without a mark",
        &german.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
        1.0,
    );
}

#[test]
fn unclear_columns_are_refused_by_name() {
    let four = |hz: f64, db: f64, degrees: f64| format!("{hz},{db},0.0,{degrees}\n");
    for (head, words) in [
        // d31: two levels.
        (
            "Frequency (Hz),Level A (dB),Level B (dB),Phase (deg)\n",
            "line 1: 2 columns may be the level: *Level A (dB)*, *Level B (dB)*. Its columns: 1 *Frequency (Hz)*, 2 *Level A (dB)*",
        ),
        ("Hz,Magnitude (dB),Magnitude (lin),deg\n", "line 1: 2 columns may be the level"),
        // Units that are not known, or of something else.
        (
            "Frequency (Hz),Level (dBm),Foo,Phase (deg)\n",
            "line 1: *Level (dBm)* has the unit dBm, which is not known of the level",
        ),
        (
            "Frequency (mhz),Level (dB),Foo,Phase (deg)\n",
            "line 1: *Frequency (mhz)* has the unit mhz, which is not known of the frequency",
        ),
        (
            "Frequency (Hz),Velocity (mm),Foo,Phase (deg)\n",
            "line 1: *Velocity (mm)* has the unit mm, which is not known of the level",
        ),
        (
            "Frequency,Level,Phase,Noise\nHz,foo,deg,dB\n",
            "line 1: *Level* has the unit foo, which is not known of the level",
        ),
        ("Frequency,Magnitude,Foo,Phase\nHz,dB\n", "line 2: the names are not those of 4 columns"),
        // Names that are not known.
        (
            "Frequency (Hz),Foo (dB),Bar,Phase (deg)\n",
            "line 1: by its unit *Foo (dB)* may be the level; its name is not known",
        ),
        (
            "Frequency (Hz),Level (dB),Bar,Foo (deg)\n",
            "line 1: by its unit *Foo (deg)* may be the phase; its name is not known",
        ),
        (
            "Frequency (Hz),Reference level (dB),Foo,Phase (deg)\n",
            "line 1: not all words of *Reference level (dB)* are known",
        ),
        ("Frequency (Hz),Level (dB),Phase (deg)\n", "line 1: the names are not those of 4 columns"),
        // Words that turn numbers into others.
        (
            "Frequency (Hz),Level (dB),Foo,Phase lag (deg)\n",
            "line 1: by its words *Phase lag (deg)* is not the phase itself",
        ),
        (
            "Log frequency (Hz),Level (dB),Foo,Phase (deg)\n",
            "line 1: by its words *Log frequency (Hz)* is not the frequency itself",
        ),
        (
            "Frequency (Hz),1/Magnitude (V),Foo,Phase (deg)\n",
            "line 1: by its words *1/Magnitude (V)* is not the level itself",
        ),
        (
            "Angular frequency,Level (dB),Foo,Phase (deg)\n",
            "line 1: not all words of *Angular frequency* are known",
        ),
    ] {
        let error = read((head.to_owned() + &rows(four)).as_bytes()).expect_err(head);
        assert!(error.starts_with(words), "{head}: {error}");
    }
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    for bytes in [&b"Hz\0\0dB"[..], b"PK\x03\x04\x14\0\0\0", b"RIFF\x24\0\0\0WAVE"] {
        let error = read(bytes).expect_err("no text");
        assert_eq!(error, "the file is no text: save the table as CSV");
    }
}

#[test]
fn frequencies_that_repeat_or_are_out_of_order_are_refused_by_their_line() {
    let refused = |text: &str| {
        let found = read(text.as_bytes()).expect(text);
        found
            .measurement(0.1, crate::calibrate::SensorKind::Velocity, 40.0, (50.0, 300.0))
            .expect_err(text)
            .to_string()
    };
    let own = |hz: f64, db: f64, degrees: f64| format!("{hz},{db},{degrees}\n");
    let good = "Hz,dB,deg\n".to_owned() + &rows(own);
    for (from, to, words) in [
        ("92.25,", "81.5,", "line 3: the frequency 81.5 Hz has two rows"),
        ("158.5,", "100.5,", "line 9: the frequency 100.5 Hz follows 147 Hz: sort the rows by frequency"),
        ("125,3,", "125,-inf,", "line 6: no finite number for the response"),
    ] {
        let found = refused(&good.replace(from, to));
        assert!(found.starts_with(words), "{to}: {found}");
    }
    // Out of the band they do not matter.
    let text = good.replace("Hz,dB,deg\n", "Hz,dB,deg\n0,-inf,0\n0,-inf,0\n5,-inf,0\n3,,\n")
        + "900,-60,0\n900,-60,0\n";
    let found = read(text.as_bytes()).expect("a table");
    let read = found.read((50.0, 300.0));
    assert_eq!((read.rows, read.rows_in_band), (16, 10));
    assert!(
        read.to_string().ends_with(
            "*Hz* as frequency, *dB* as level, *deg* as phase; 6 rows outside the plate's band left out"
        ),
        "{read}"
    );
    assert!(found.measurement(0.1, crate::calibrate::SensorKind::Velocity, 40.0, (50.0, 300.0)).is_ok());
}

#[test]
fn the_columns_of_the_user_decide_and_are_reported() {
    use crate::text_table::chosen;
    let text =
        "a;b;c;d\n".to_owned() + &rows(|hz, db, degrees| format!("{:.9};1;{db};{degrees}\n", hz / 1e3));
    let read = |columns: &str| match File::read(text.as_bytes(), &chosen(columns).expect(columns)) {
        Ok(File::Foreign(foreign)) => Ok(foreign),
        other => Err(format!("{other:?}")),
    };
    let found = read("frequency=1:kHz,level=3:dB,phase=4:deg").expect("a table");
    assert!((found.points[0].frequency_hz - 81.5).abs() < 1e-6);
    let words = found.read((50.0, 300.0)).to_string();
    assert!(
        words.contains("*a* as frequency in kHz, *c* as level in dB, *d* as phase in deg; *b* left out"),
        "{words}"
    );
    for wrong in
        ["frequency=1", "frequency=1,level=9", "frequency=1,level=2,real=3,imaginary=4", "level=2,phase=3"]
    {
        assert!(read(wrong).is_err(), "{wrong}");
    }
    let own =
        File::read(b"# place_m = 0.03\n", &chosen("frequency=1").expect("columns")).expect_err("our own");
    assert_eq!(own.to_string(), "the file's format states its columns: only those of a table can be chosen");
    for (wrong, words) in [
        ("frequenz=1", "a measurement has no column \"frequenz\", did you mean frequency?"),
        ("frequency=0", "frequency = 0: must be the number of a column, from 1"),
        ("frequency", "frequency = : must be the number of a column"),
        ("frequency=1:dB", "the unit of frequency = dB: must be one of this quantity"),
        ("frequency=1,level=1", "column 1 or level is there twice"),
    ] {
        let found = chosen(wrong).expect_err(wrong);
        assert!(found.starts_with(words), "{wrong}: {found}");
    }
}
