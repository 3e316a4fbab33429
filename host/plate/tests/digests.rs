//! Files that leave out every optional field keep their fields, tables and time domain to the last stable digit.

use slipline_plate::{DriveTable, Equation, Plate, TimeDomainLine, presets, respond};
use std::fmt::Write as _;

/// FNV-1a over numbers of nine digits, four of those in single precision: the functions of other systems differ in the last ones.
struct Digest(u64);

impl Digest {
    fn add(&mut self, text: &str) {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn fields(&mut self, plate: &Plate) {
        let (start_m, end_m) = plate.span_m();
        for place_m in [start_m, 0.5 * (start_m + end_m), end_m] {
            let frequency_hz = plate.frequency_for_boundary_hz(place_m);
            let field = respond(plate, frequency_hz, 65, Equation::Corrected).expect("enters").amplitude;
            let largest = field.iter().map(|f| f.norm()).fold(0.0, f64::max);
            self.add(&format!("{frequency_hz:.8e} {largest:.8e}"));
            // Rounded as a part of the largest: a node's own digits are not determined.
            field
                .iter()
                .for_each(|f| self.add(&format!("{:.7} {:.7}", f.re / largest + 2.0, f.im / largest + 2.0)));
        }
    }

    fn table(&mut self, plate: &Plate) {
        let table = DriveTable::build(plate, 400e3, 17).expect("a table");
        for knot in table.knots() {
            self.add(&format!("{:.7e} {:.7e} {}", knot.frequency_hz, knot.gain, knot.peak_present));
        }
    }

    fn time(&mut self, plate: &Plate) {
        let rate_hz = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let mut line = TimeDomainLine::new(plate, rate_hz, 33).expect("a line");
        line.push(&(0..600).map(|n| (0.7 * f64::from(n)).cos() as f32).collect::<Vec<f32>>());
        let mut field = vec![0.0_f32; 33];
        line.field_m(&mut field);
        let largest = field.iter().fold(0.0_f32, |most, it| most.max(it.abs())).max(f32::MIN_POSITIVE);
        field.iter().for_each(|it| self.add(&format!("{:.4}", it / largest + 2.0)));
    }
}

/// The digests are those of commit 440c3565, before `gap_m`, `[frame]` and what follows them. A change of them is a change of every
/// preset's numbers: `SLIPLINE_BLESS=1` writes them again.
#[test]
fn files_without_the_optional_fields_keep_their_fields_tables_and_time_domain() {
    let mut found = String::new();
    for entry in presets() {
        let plate = entry.plate().expect("a preset");
        let mut digest = Digest(0xcbf2_9ce4_8422_2325);
        digest.fields(&plate);
        digest.table(&plate);
        digest.time(&plate);
        writeln!(found, "{} {:016x}", entry.name, digest.0).expect("written");
    }
    let stored = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/digests/presets.txt");
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::write(stored, &found).expect("written");
    }
    assert_eq!(found, std::fs::read_to_string(stored).expect("the digests"));
}
