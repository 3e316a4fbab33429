//! Stops and drives that come again and again in step with the actuator's resonance: how far they move it, as `firmware/SAFETY.md` says.

use crate::profile::{flash_with, plain};
use slipline_link::simulator::Options;
use slipline_protocol::command::{Drive, TravelLimit};
use slipline_protocol::profile::{ActuatorProfile, CoilHeat};
use slipline_protocol::refusal::Field;
use slipline_protocol::units::Phase;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::mass_on_a_spring::travel;
use slipline_tests::rig::{BLOCK, RATE_HZ, Rig, Table, drive};
use slipline_tests::source_tree::root;

/// What ends each drive.
#[derive(Clone, Copy, Debug)]
enum End {
    /// `Stop`.
    Stop,
    /// `EmergencyStop`; then the device is armed again.
    Emergency,
    /// A drive without tones, with the shortest glide that is accepted.
    Fade,
}

/// The worst sequence that a search over frequency, phases and times has found for an actuator and a way to end a drive, and the
/// travel that the page states for it.
#[derive(Debug)]
struct Worst {
    resonance_hz: f64,
    quality: f64,
    end: End,
    /// The tone's frequency over the resonance's.
    ratio: f64,
    /// Blocks from the begin of a drive to its end, and to the begin of the next one.
    blocks: (u64, u64),
    /// The tone's phase, and how far it goes on from drive to drive, in turns.
    phase: (f64, f64),
    stated: f64,
}

impl Worst {
    /// Full scale would hold the actuator at its peak travel.
    fn limit(&self) -> TravelLimit {
        TravelLimit {
            resonance_uhz: (self.resonance_hz * 1e6) as u64,
            quality_per_mille: (self.quality * 1e3) as u32,
            static_ppm: 1_000_000,
        }
    }

    /// The shortest glide: two periods.
    fn shortest(&self) -> u32 {
        (2.0 * f64::from(RATE_HZ) / self.resonance_hz) as u32
    }

    /// The loudest level of the tone that is accepted.
    fn level(&self) -> f64 {
        let spring = 1.0 - self.ratio * self.ratio;
        let steady = spring.hypot(self.ratio / self.quality).recip();
        (1.0 / (1.0015 * steady)).min(1.0)
    }

    /// A device with the actuator's profile, armed. The table's frequency is the same everywhere, but for a thousandth.
    fn rig(&self) -> Rig {
        let heat = CoilHeat { full_sine_per_mille: 10, ..plain().heat };
        let profile = ActuatorProfile { travel: Some(self.limit()), heat, ..plain() };
        let mut rig = Rig::greeted_with(Options { flash: flash_with(profile), ..Options::default() });
        let hz = self.resonance_hz * self.ratio;
        rig.upload(&Table::line(2, hz, hz * 1.001, |_| 1.0));
        rig.arm();
        rig
    }

    /// The drive of this number.
    fn drive(&self, turn: u32, level: f64) -> Drive {
        let turns = (self.phase.0 + f64::from(turn) * self.phase.1).rem_euclid(1.0);
        let mut asked = drive(&[(0, 0.0, level)], self.shortest());
        asked.tones[0].phase = Phase((turns * 65_536.0) as u16);
        asked
    }

    /// Plays it until it adds no more; the largest travel of a mass on a spring.
    fn play(&self) -> f64 {
        let mut rig = self.rig();
        let louder = Command::Drive(self.drive(0, (self.level() * 1.01).min(1.0)));
        let quicker = Drive { glide: self.shortest() - 1, ..self.drive(0, self.level()) };
        let refusal = rig.refused(&Command::Drive(quicker));
        assert!(matches!(refusal, Refusal::OutOfRange { field: Field::Glide, .. }), "{refusal:?}");
        assert!(self.level() >= 1.0 || matches!(rig.refused(&louder), Refusal::Travel { .. }), "{self:?}");
        rig.record();
        let (sounds, every) = self.blocks;
        let period = f64::from(RATE_HZ) / self.resonance_hz / BLOCK as f64;
        // Free motion falls to a hundredth in 1.5 Q periods.
        let turns = 4 + (1.5 * self.quality * period / every as f64) as u32;
        for turn in 0..turns {
            let begins = rig.device.now();
            assert_eq!(rig.accepted(&Command::Drive(self.drive(turn, self.level()))), begins);
            rig.live_blocks(sounds);
            match self.end {
                End::Stop => rig.accepted(&Command::Stop),
                End::Emergency => rig.accepted(&Command::EmergencyStop),
                End::Fade => rig.accepted(&Command::Drive(drive(&[], self.shortest()))),
            };
            if matches!(self.end, End::Emergency) {
                // The ramp; from arming on the amplifier wants four blocks of silence.
                rig.live_blocks(every - sounds - 4);
                rig.accepted(&Command::ClearFaults);
                rig.accepted(&Command::Arm);
                rig.live_blocks(4);
            } else {
                rig.live_blocks(every - sounds);
            }
        }
        rig.live_blocks(period as u64);
        travel(&rig.recording.codes, &self.limit())
    }
}

#[test]
fn stops_and_drives_in_step_with_the_resonance_move_the_actuator_as_far_as_the_safety_page_says() {
    // One row for each actuator and end; the columns are those of `Worst`.
    let worst = [
        (40.0, 3.0, End::Stop, 1.3738, (156, 253), (0.5794, 0.3444), 1.24),
        (40.0, 3.0, End::Emergency, 1.3744, (152, 168), (0.9644, 0.0770), 1.40),
        (40.0, 3.0, End::Fade, 1.3739, (154, 312), (0.8395, 0.2443), 1.21),
        (40.0, 10.0, End::Stop, 1.3376, (141, 238), (0.3568, 0.0525), 2.4),
        (40.0, 10.0, End::Emergency, 1.4099, (144, 160), (0.5110, 0.0398), 3.3),
        (40.0, 10.0, End::Fade, 1.2398, (179, 341), (0.1329, 0.4119), 2.0),
        (20.0, 10.0, End::Stop, 1.3994, (278, 375), (0.2399, 0.3967), 2.8),
        (20.0, 10.0, End::Emergency, 1.4107, (306, 322), (0.7672, 0.0522), 3.4),
        (20.0, 10.0, End::Fade, 1.2321, (375, 697), (0.1327, 0.5123), 2.0),
        (20.0, 30.0, End::Stop, 1.3707, (292, 389), (0.1737, 0.4806), 7.3),
        (20.0, 30.0, End::Emergency, 1.4099, (304, 320), (0.8691, 0.0384), 8.9),
        (20.0, 30.0, End::Fade, 1.2176, (340, 659), (0.3652, 0.2155), 4.7),
    ]
    .map(|(resonance_hz, quality, end, ratio, blocks, phase, stated)| Worst {
        resonance_hz,
        quality,
        end,
        ratio,
        blocks,
        phase,
        stated,
    });
    for case in &worst {
        let found = case.play();
        // The search knew neither codes nor what rounds them, and the page rounds up.
        assert!((0.95..1.01).contains(&(found / case.stated)), "{case:?}: {found}");
        // The page's bound: full scale holds this actuator at its peak travel.
        assert!(found < 2_f64.sqrt() * (1.0 + case.quality / 5.0), "{case:?}: {found}");
    }
    let page = std::fs::read_to_string(root().join("firmware/SAFETY.md")).unwrap();
    for three in worst.chunks(3) {
        let [stop, emergency, fade] = [0, 1, 2].map(|end| three[end].stated);
        let Worst { resonance_hz, quality, .. } = three[0];
        let row = format!("| {resonance_hz} Hz, Q {quality} | {stop:?} | {emergency:?} | {fade:?} |");
        assert!(page.contains(&row), "{row}");
    }
}
