//! Every accepted motion keeps the peak travel: the tests integrate a mass on a spring beside the planned motions.

use std::boxed::Box;
use std::f64::consts::{PI, TAU};
use std::vec::Vec;

use proptest::prelude::*;
use slipline_dds::bank::BLOCK;
use slipline_protocol::command::{Apply, Drive, Tone};
use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Knot;
use slipline_protocol::units::{CentiDecibel, Level, Phase, Position};

use super::*;
use crate::motion::Placement;
use crate::planning::plan::Planner;
use crate::timing::block_at_or_after;

/// Low, so that a second has few samples.
const RATE: u32 = 20_000;
/// The tones that are used.
const SLOTS: usize = 4;
const TABLE: TableRef = TableRef { slot: SlotIndex::First, knots: 33 };

fn limit(resonance_hz: f64, quality: f64, static_share: f64) -> TravelLimit {
    TravelLimit {
        resonance_uhz: (resonance_hz * 1e6).ceil() as u64,
        quality_per_mille: (quality * 1e3).ceil() as u32,
        static_ppm: (static_share * 1e6).ceil() as u32,
    }
}

/// A table from one frequency to another, all gains 1.
fn table(slots: &TableSlots, slot: SlotIndex, from_hz: f64, to_hz: f64) -> TableRef {
    for index in 0..TABLE.knots {
        let hz = from_hz * (to_hz / from_hz).powf(f64::from(index) / f64::from(TABLE.knots - 1));
        let step = (hz / f64::from(RATE) * 4_294_967_296.0) as u32;
        slots.write(slot, index, Knot { step, gain: Gain::FULL });
    }
    TableRef { slot, ..TABLE }
}

fn drive(tones: &[(u16, u16)], glide: u32) -> Drive {
    let tones = (0u8..).zip(tones).map(|(slot, &(position, level))| Tone {
        slot,
        position: Position(position),
        level: Level(level),
        phase: Phase(u16::from(slot) * 9000),
    });
    Drive { tones: tones.collect(), master: CentiDecibel(0), glide, apply: Apply::Next }
}

/// A device's thread side, as far as it plans, and the actuator that hangs on it.
struct TravelBench {
    slots: Box<TableSlots>,
    excursion: Excursion,
    timing: Timing,
    motion: Motion,
    at: u64,
    limit: TravelLimit,
    phases: [f64; SLOTS],
    /// Place and speed of the mass; 1 = the peak travel.
    place: f64,
    speed: f64,
}

impl TravelBench {
    fn new(limit: TravelLimit, from_hz: f64, to_hz: f64) -> Self {
        let slots = Box::new(TableSlots::new());
        let tables =
            [table(&slots, SlotIndex::First, from_hz, to_hz), TableRef { slot: SlotIndex::Second, knots: 0 }];
        let mut excursion = Excursion::unlimited(RATE);
        excursion.set(Some(limit), tables, &slots).unwrap();
        Self {
            slots,
            excursion,
            timing: Timing::at(RATE),
            motion: Motion::silent(),
            at: 0,
            limit,
            phases: [0.0; SLOTS],
            place: 0.0,
            speed: 0.0,
        }
    }

    fn shortest(&self) -> u32 {
        self.timing.shortest_glide(&self.limit)
    }

    fn planner<'a>(&'a self, is_stopped: &'a mut dyn FnMut() -> bool) -> Planner<'a> {
        Planner { slots: &self.slots, timing: &self.timing, is_stopped }
    }

    /// As the controller does it.
    fn ask(&mut self, drive: &Drive) -> Result<(), Refusal> {
        self.excursion.check_glide(drive.glide, &self.timing)?;
        let motion = self.planner(&mut || false).drive(drive, self.at, TABLE, &self.motion)?;
        self.excursion.check(&motion, &self.slots)?;
        self.motion = motion;
        Ok(())
    }

    /// Lets the mass move until an index; its largest travel on the way.
    fn pass(&mut self, until: u64) -> f64 {
        let resonance = TAU * self.limit.resonance_uhz as f64 * 1e-6 / f64::from(RATE);
        let quality = f64::from(self.limit.quality_per_mille) / 1e3;
        let static_share = f64::from(self.limit.static_ppm) / 1e6;
        // 120 steps and more in each period of the resonance: the integration itself does not matter.
        const STEPS: u32 = 2;
        let dt = 1.0 / f64::from(STEPS);
        let mut largest = 0.0_f64;
        while self.at < until {
            let (start, end) = (self.places(self.at), self.places(self.at + BLOCK as u64));
            for sample in 0..BLOCK * STEPS as usize {
                let part = sample as f64 / (BLOCK as f64 * f64::from(STEPS));
                let mut force = 0.0;
                for ((phase, a), b) in self.phases.iter_mut().zip(&start).zip(&end) {
                    if a.is_silent() && b.is_silent() {
                        continue;
                    }
                    let between = |a: f64, b: f64| a + part * (b - a);
                    let level = |placement: &Placement| f64::from(placement.amplitude().0) / 2_147_483_648.0;
                    let turns = |placement: &Placement| {
                        placement.setting.step.0 as f64 / 18_446_744_073_709_551_616.0
                    };
                    *phase = (*phase + TAU * between(turns(a), turns(b)) * dt) % TAU;
                    force += between(level(a), level(b)) * phase.sin();
                }
                // Leapfrog, the damping by the mean of both speeds: of second order.
                let spring = resonance * resonance * (static_share * force - self.place);
                let damping = 0.5 * dt * resonance / quality;
                self.speed = (self.speed * (1.0 - damping) + dt * spring) / (1.0 + damping);
                self.place += dt * self.speed;
                largest = largest.max(self.place.abs());
            }
            self.at += BLOCK as u64;
        }
        largest
    }

    fn places(&self, at: u64) -> [Placement; MAX_TONES] {
        self.motion.at(at, &self.slots)
    }

    /// Samples until free motion has fallen to a thousandth: seven times its time constant.
    fn settles(&self) -> u64 {
        let quality = f64::from(self.limit.quality_per_mille) / 1e3;
        let resonance_hz = self.limit.resonance_uhz as f64 * 1e-6;
        block_at_or_after((7.0 * quality.max(1.0) / (PI * resonance_hz) * f64::from(RATE)) as u64)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn no_accepted_drive_moves_a_mass_on_a_spring_beyond_the_peak_travel(
        resonance_hz in 30.0..200.0,
        quality in 0.3..12.0,
        static_share in 0.05..8.0,
        drives in prop::collection::vec(
            (prop::collection::vec((any::<u16>(), 1000u16..), 1..SLOTS), 0u32..4000), 1..4,
        ),
    ) {
        let mut bench = TravelBench::new(limit(resonance_hz, quality, static_share), 20.0, 1200.0);
        for (tones, longer) in drives {
            let glide = bench.shortest() + longer;
            let mut asked = drive(&tones, glide);
            // As the refusal says: the levels that it allows are accepted.
            while let Err(refusal) = bench.ask(&asked) {
                let share = match refusal {
                    Refusal::Travel { allowed_per_mille: 0, .. } => {
                        // The tones that sound are too loud for the way: they must end first.
                        prop_assert!(!bench.motion.ends_silent());
                        prop_assert_eq!(bench.ask(&drive(&[], glide)), Ok(()));
                        let silent = block_at_or_after(bench.motion.end()) + bench.settles();
                        prop_assert!(bench.pass(silent) <= 2.0);
                        continue;
                    }
                    Refusal::Travel { travel_per_mille, allowed_per_mille } => {
                        prop_assert!(travel_per_mille > 1000 && allowed_per_mille < 1000);
                        f64::from(allowed_per_mille) / 1000.0
                    }
                    Refusal::Headroom { .. } => 0.9,
                    other => panic!("{other:?}"),
                };
                for tone in &mut asked.tones {
                    tone.level = Level((f64::from(tone.level.0) * share) as u16);
                }
            }
            let end = block_at_or_after(bench.motion.end()) + bench.settles();
            // A change adds free motion for a moment.
            let moment = bench.pass(end);
            prop_assert!(moment <= 2.0, "{moment}");
            let steady = bench.pass(end + u64::from(RATE) / 4);
            prop_assert!(steady <= 1.0, "{steady}");
        }
    }
}

/// The largest travel while a tone begins, over its steady travel.
fn overshoot(ratio: f64, quality: f64) -> f64 {
    let limit = limit(60.0, quality, 1e-3);
    let mut bench = TravelBench::new(limit, 60.0 * ratio, 60.0 * ratio * 1.01);
    let glide = bench.shortest();
    bench.ask(&drive(&[(0, u16::MAX)], glide)).unwrap();
    let settles = bench.settles();
    let moment = bench.pass(settles + u64::from(glide));
    moment / bench.pass(bench.at + u64::from(RATE) / 2)
}

#[test]
fn a_tone_that_begins_in_two_periods_overshoots_as_little_as_the_physics_page_says() {
    for quality in [0.5, 3.0, 30.0] {
        for ratio in [0.1, 0.3, 0.5, 1.6, 2.0, 5.0] {
            let found = overshoot(ratio, quality);
            assert!(found < 1.4, "{ratio} {quality}: {found}");
        }
        for ratio in [0.6, 0.8, 0.9, 0.97, 1.0, 1.05, 1.2, 1.4] {
            let found = overshoot(ratio, quality);
            assert!(found < 2.0, "{ratio} {quality}: {found}");
        }
    }
}

#[test]
fn a_glide_across_the_resonance_counts_with_its_peak_although_both_ends_are_harmless() {
    let mut bench = TravelBench::new(limit(60.0, 10.0, 0.5), 6.0, 600.0);
    let glide = 10 * bench.shortest();
    for end in [0, u16::MAX] {
        let mut rested = TravelBench::new(bench.limit, 6.0, 600.0);
        assert_eq!(rested.ask(&drive(&[(end, u16::MAX)], glide)), Ok(()), "at rest at {end}");
    }
    assert_eq!(bench.ask(&drive(&[(0, u16::MAX)], glide)), Ok(()));
    bench.at = block_at_or_after(bench.motion.end());
    let refused = bench.ask(&drive(&[(u16::MAX, u16::MAX)], glide)).unwrap_err();
    // Q times the static share, and the thousandth.
    assert!(
        matches!(refused, Refusal::Travel { travel_per_mille: 5000..=5025, allowed_per_mille: 0 }),
        "{refused:?}"
    );
    let quieter = drive(&[(u16::MAX, 65535 / 6)], glide);
    assert_eq!(bench.ask(&quieter), Err(refused), "no level helps: it starts at the one it has");
    // Lowered where it is, it may cross.
    assert_eq!(bench.ask(&drive(&[(0, 65535 / 6)], glide)), Ok(()));
    bench.at = block_at_or_after(bench.motion.end());
    let loud = bench.ask(&drive(&[(u16::MAX, u16::MAX)], glide)).unwrap_err();
    assert!(
        matches!(loud, Refusal::Travel { travel_per_mille: 5000..=5025, allowed_per_mille: 198..=199 }),
        "{loud:?}"
    );
    assert_eq!(bench.ask(&quieter), Ok(()));
}

#[test]
fn travels_add_up() {
    let mut bench = TravelBench::new(limit(600.0, 0.7, 1.0), 20.0, 60.0);
    let glide = bench.shortest();
    // Within the headroom, since static travel at full scale is just the peak travel: less than the thousandth.
    let half = u16::MAX / 2;
    let refused = bench.ask(&drive(&[(0, half), (9000, half + 1)], glide)).unwrap_err();
    assert!(matches!(refused, Refusal::Travel { .. }), "{refused:?}");
    assert_eq!(bench.ask(&drive(&[(0, half - 100), (9000, half - 100)], glide)), Ok(()));
}

#[test]
fn a_table_that_takes_the_tones_to_a_resonance_is_not_swapped_in() {
    let mut bench = TravelBench::new(limit(60.0, 10.0, 0.5), 500.0, 600.0);
    let glide = bench.shortest();
    bench.ask(&drive(&[(0, u16::MAX)], glide)).unwrap();
    bench.at = block_at_or_after(bench.motion.end());
    let swap = |bench: &mut TravelBench, from_hz| {
        bench.excursion.begin(SlotIndex::Second);
        let other = table(&bench.slots, SlotIndex::Second, from_hz, 700.0);
        bench.excursion.written(other, 0, &bench.slots);
        let motion = bench.planner(&mut || false).swap(bench.at, other, &bench.motion).unwrap();
        bench.excursion.check(&motion, &bench.slots)
    };
    // Both tables alone are harmless here, but the tone would glide from 500 Hz across 60 Hz.
    assert!(matches!(swap(&mut bench, 6.0), Err(Refusal::Travel { .. })));
    assert_eq!(swap(&mut bench, 400.0), Ok(()));
}

#[test]
fn a_glide_shorter_than_two_periods_of_the_resonance_is_refused_with_the_shortest() {
    let mut bench = TravelBench::new(limit(50.0, 2.0, 0.1), 200.0, 600.0);
    let shortest = 2 * RATE / 50;
    assert_eq!(bench.shortest(), shortest);
    let refused = Refusal::OutOfRange {
        field: Field::Glide,
        min: shortest.into(),
        max: bench.timing.max_glide.into(),
        got: i64::from(shortest) - 1,
    };
    assert_eq!(bench.ask(&drive(&[(0, 9)], shortest - 1)), Err(refused));
    assert_eq!(bench.ask(&drive(&[(0, 9)], shortest)), Ok(()));
    // Never more than the longest glide, and never less than the shortest of a device without a limit.
    let shortest = |resonance_hz| bench.timing.shortest_glide(&limit(resonance_hz, 2.0, 0.1));
    assert_eq!((shortest(0.1), shortest(1e6)), (bench.timing.max_glide, bench.timing.min_glide));
}

#[test]
fn a_limit_out_of_range_is_refused_with_its_field_and_the_one_before_stays() {
    let mut bench = TravelBench::new(limit(50.0, 2.0, 0.1), 200.0, 600.0);
    let good = bench.limit;
    let tables = [TABLE, TableRef { slot: SlotIndex::Second, knots: 0 }];
    for (field, bad) in [
        (Field::Resonance, TravelLimit { resonance_uhz: 99_999, ..good }),
        (Field::Resonance, TravelLimit { resonance_uhz: u64::MAX, ..good }),
        (Field::Quality, TravelLimit { quality_per_mille: 99, ..good }),
        (Field::Quality, TravelLimit { quality_per_mille: 1_000_001, ..good }),
        (Field::StaticTravel, TravelLimit { static_ppm: 0, ..good }),
        (Field::StaticTravel, TravelLimit { static_ppm: 1_000_000_001, ..good }),
    ] {
        let refused = bench.excursion.set(Some(bad), tables, &bench.slots).unwrap_err();
        assert!(matches!(refused, Refusal::OutOfRange { field: found, .. } if found == field), "{refused:?}");
        assert_eq!(bench.excursion.limit(), Some(good));
    }
    bench.excursion.clear();
    assert_eq!(bench.excursion.limit(), None);
}

#[test]
fn a_glide_is_judged_by_all_intervals_that_it_touches_in_any_order_of_writing() {
    let bench = TravelBench::new(limit(60.0, 10.0, 0.5), 6.0, 600.0);
    let mut in_chunks = Excursion::unlimited(RATE);
    let empty = TableRef { knots: 0, ..TABLE };
    in_chunks
        .set(Some(bench.limit), [empty, TableRef { slot: SlotIndex::Second, knots: 0 }], &bench.slots)
        .unwrap();
    // Knot by knot first: then every interval lies between two chunks.
    for (first, end) in (0..16).map(|first| (first, first + 1)).chain([(16, 23), (23, TABLE.knots)]) {
        in_chunks.written(TableRef { knots: end, ..TABLE }, first, &bench.slots);
    }
    let largest: Vec<f32> = [&bench.excursion, &in_chunks].iter().map(|it| it.first.largest(0, 32)).collect();
    assert_eq!(largest[0], largest[1]);
    for first in 0..32 {
        for last in first + 1..=32 {
            assert_eq!(bench.excursion.first.largest(first, last), in_chunks.first.largest(first, last));
        }
    }
    assert!((largest[0] - 5.0).abs() < 0.03, "{largest:?}");
}
