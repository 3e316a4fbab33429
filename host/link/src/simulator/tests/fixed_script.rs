//! The digest of all codes of one script of drives, chords, combs and stops: equal on every processor.
//!
//! `cargo test` runs it natively, the gate's step `wasi` on 32 bits.

use crate::protocol::command::{Apply, DigestWindow};
use crate::protocol::frame::CRC;
use crate::simulator::loopback::Loopback;
use crate::{
    ChordRequest, CombRequest, DeviceTable, DriveRequest, HarmonicRequest, Outcome, Request, Sounding,
    ToneRequest,
};
use std::sync::Arc;

const RATE_HZ: u32 = 400_000;
/// The digest's window: from before the first tone until after the last ramp.
const WINDOW: DigestWindow = DigestWindow { from: 64_000, count: 1 << 18 };
/// The CRC-32 of the codes in the window, two bytes each, the lower one first. It never changes: a released
/// device must always send the same codes for the same commands.
const CODES: u32 = 0xa55b_cb30;

/// The device, and its codes since the window began.
struct Played {
    loopback: Loopback,
    codes: Vec<u16>,
}

impl Played {
    fn perform(&mut self, request: Request) -> u64 {
        let codes = &mut self.codes;
        self.loopback.perform(request, |block| codes.extend_from_slice(block)).unwrap()
    }

    fn until(&mut self, sample: u64) {
        let left = sample.checked_sub(self.loopback.samples()).expect("the script is behind its time");
        let codes = &mut self.codes;
        self.loopback.pass(left, |block| codes.extend_from_slice(block));
    }
}

/// 129 places over 0.1 m, 40 to 20 kHz, with a gain that rises and falls.
fn table() -> DeviceTable {
    let knots = (0..129).map(|i| {
        let along = f64::from(i) / 128.0;
        (40e3 - 20e3 * along, 0.4 + 2.0 * along * (1.0 - along))
    });
    DeviceTable::from_knots((0.1, 0.2), f64::from(RATE_HZ), knots, 1e-6).unwrap()
}

fn drive(at: u64, glide_s: f64, tones: &[(u8, f64, f64, f64)]) -> Request {
    let tone = |&(slot, boundary_m, level, phase_turns)| ToneRequest { slot, boundary_m, level, phase_turns };
    let tones = tones.iter().map(tone).collect();
    Request::Play(Sounding::Drive(DriveRequest { tones, master_db: -1.5, glide_s, apply: Apply::At(at) }))
}

#[test]
fn the_codes_of_a_fixed_script_are_the_same_on_every_processor() {
    let mut played = Played { loopback: Loopback::connect(RATE_HZ).unwrap(), codes: Vec::new() };
    played.perform(Request::Upload(Arc::new(table())));
    played.until(WINDOW.from - 6400);
    let digest = played.loopback.hand_over(Request::Digest(WINDOW));
    played.until(WINDOW.from);
    played.codes.clear();

    // Two tones from silence; then one glides, one fades out and a third one begins.
    let first = drive(70_400, 0.005, &[(0, 0.12, 0.5, 0.0), (7, 0.17, 0.3, 0.25)]);
    assert_eq!(played.perform(first), 70_400);
    played.until(90_112);
    let glide = drive(96_000, 0.02, &[(0, 0.1871, 0.45, 0.0), (3, 0.1434, 0.35, 0.7)]);
    assert_eq!(played.perform(glide), 96_000);
    // In the middle of a glide: it begins at the present place of the other one.
    played.until(100_096);
    let turned = drive(102_400, 0.05, &[(0, 0.11, 0.6, 0.0), (3, 0.15, 0.2, 0.0)]);
    assert_eq!(played.perform(turned), 102_400);
    played.until(128_000);
    played.perform(Request::Stop);

    played.until(150_016);
    let tone = |(harmonic, level, phase_turns)| HarmonicRequest { harmonic, level, phase_turns };
    let tones = [(220, 0.4, 0.0), (228, 0.4, 0.25), (236, 0.4, 0.0), (301, 0.1, 0.6)].map(tone).to_vec();
    let chord = ChordRequest { apply: Apply::At(160_000), ..ChordRequest::of(12, tones) };
    assert_eq!(played.perform(Request::Play(Sounding::Chord(chord))), 160_000);
    played.until(200_064);
    played.perform(Request::Stop);

    played.until(220_032);
    let tone = |(harmonic, level, phase_turns)| HarmonicRequest { harmonic, level, phase_turns };
    let tones = [(3, 0.1, 0.0), (128, 0.2, 0.25), (512, 0.2, 0.5), (1280, 0.4, 0.125)].map(tone).to_vec();
    let comb = CombRequest { apply: Apply::At(230_400), ..CombRequest::of(40, tones) };
    assert_eq!(played.perform(Request::Play(Sounding::Comb(comb))), 230_400);
    played.until(300_032);
    played.perform(Request::EmergencyStop);

    let end = WINDOW.from + u64::from(WINDOW.count);
    played.until(end + 25_600);
    let silence = *played.codes.last().unwrap();
    played.codes.truncate(WINDOW.count as usize);
    assert_eq!(*played.codes.last().unwrap(), silence, "the last ramp is over");

    let bytes: Vec<u8> = played.codes.iter().flat_map(|code| code.to_le_bytes()).collect();
    assert_eq!(format!("{:08x}", CRC.checksum(&bytes)), format!("{CODES:08x}"), "of the codes as they leave");
    let Some(Outcome::Digest(taken)) = played.loopback.view().outcome(digest) else { panic!("no digest") };
    assert_eq!(taken.crc, Some(CODES), "of the device's own digest");
}
