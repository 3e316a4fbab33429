//! The hold on a simulated device in virtual time. Its sensor shows the drive itself, so nothing has to
//! settle.

use super::*;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_link::{DeviceTable, DriveRequest, LinkState, Sounding};
use slipline_model::field::simulation::table_for;
use slipline_plate::preset;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU16, Ordering};

const RATE_HZ: u64 = 400_000;
/// Sensor signal without a touch, percent of the drive.
const FREE: u16 = 60;
const TOUCHED: u16 = 30;
const UNPLUGGED: u16 = 0;

static PLATE: LazyLock<(Arc<Plate>, Arc<DeviceTable>)> = LazyLock::new(|| {
    let plate = Arc::new(preset("al-bending").unwrap());
    let (_, table) = table_for(&plate, RATE_HZ as u32).unwrap();
    (plate, table)
});

struct Sensor {
    shows: Arc<AtomicU16>,
    codes: u32,
}

impl SimulatedInputs for Sensor {
    fn sample(&mut self, codes: &[u16; 128], _muted: bool, sensed: &mut [[u16; 128]; 2]) {
        let shows = i32::from(self.shows.load(Ordering::Relaxed));
        for (sensed, &code) in sensed[0].iter_mut().zip(codes) {
            // Dither: the input must not look stuck.
            self.codes = self.codes.wrapping_add(1);
            let dither = if shows == 0 { 0 } else { (self.codes % 2) as i32 };
            *sensed = (2048 + (i32::from(code) - 2048) * shows / 100 + dither) as u16;
        }
    }
}

struct Bench {
    loopback: Loopback,
    holding: Holding,
    plate: Arc<Plate>,
    shows: Arc<AtomicU16>,
    asked: Vec<Request>,
}

impl Bench {
    /// A device that drives one tone at this place and level.
    fn driving(boundary_m: f64, level: f64) -> Self {
        let (plate, table) = &*PLATE;
        let plate = Arc::clone(plate);
        let shows = Arc::new(AtomicU16::new(FREE));
        let sensor = Box::new(Sensor { shows: shows.clone(), codes: 0 });
        let device = SimulatedDevice::with_inputs(Options::default(), sensor);
        let mut loopback = Loopback::connect_to(device).unwrap();
        loopback.perform(Request::Upload(table.clone()), |_| ()).unwrap();
        let mut bench = Self { loopback, holding: Holding::default(), plate, shows, asked: Vec::new() };
        bench.drive(boundary_m, level);
        // The glide is over and a status has reported it.
        bench.loopback.pass(RATE_HZ / 10, |_| ());
        bench
    }

    /// The same with the level held.
    fn holding() -> Self {
        let mut bench = Self::driving(0.24, 0.3);
        bench.switch_on(12.0);
        bench.until_held();
        bench
    }

    fn drive(&mut self, boundary_m: f64, level: f64) {
        let drive = DriveRequest { glide_s: 0.02, ..DriveRequest::at(&[(boundary_m, level)]) };
        self.loopback.perform(Request::Play(Sounding::Drive(drive)), |_| ()).unwrap();
    }

    fn switch_on(&mut self, max_rise_db: f64) {
        self.holding.switch_on(&self.plate, max_rise_db, None);
    }

    fn turn(&mut self, rests: bool) {
        while let Some(request) = self.holding.turn(self.loopback.view(), &self.plate, rests) {
            self.asked.push(request.clone());
            self.holding.sent(self.loopback.hand_over(request));
        }
    }

    /// Runs the device for some tens of milliseconds per turn.
    fn pass(&mut self, turns: usize, rests: bool) {
        for _ in 0..turns {
            self.turn(rests);
            self.loopback.pass(RATE_HZ / 50, |_| ());
        }
    }

    fn until(&mut self, what: &str, is_there: impl Fn(&Standing<'_>) -> bool) {
        for _ in 0..60 {
            if is_there(&self.standing()) {
                return;
            }
            self.pass(1, true);
        }
        panic!("{what}: {:?}", self.standing());
    }

    fn until_held(&mut self) {
        self.until("held", |standing| standing.to_string().starts_with("Holding: the plate may be touched"));
    }

    /// Waits until it is off; returns its reason.
    fn until_off(&mut self) -> HoldEnd {
        self.until("off", |standing| matches!(standing, Standing::Off(_)));
        self.holding.ended().cloned().expect("it says why")
    }

    fn standing(&self) -> Standing<'_> {
        self.holding.standing(self.loopback.view())
    }

    /// The correction in force above the drive's level, dB.
    fn correction_db(&self) -> f64 {
        let Standing::Holding(Some(held)) = self.standing() else { panic!("{:?}", self.standing()) };
        f64::from(held.tones[0].correction.0) / 100.0
    }

    fn show(&self, percent: u16) {
        self.shows.store(percent, Ordering::Relaxed);
    }

    /// The requests since the last call, one letter each: Listen, Hold, Off.
    fn asked(&mut self) -> String {
        let letter = |request: Request| {
            if matches!(request, Request::Listen(_)) {
                return 'L';
            }
            let Request::Hold(hold) = request else { panic!("{request:?}") };
            if hold.tones.is_empty() { 'O' } else { 'H' }
        };
        std::mem::take(&mut self.asked).into_iter().map(letter).collect()
    }

    fn sum_per_mille(&mut self) -> u16 {
        self.loopback.perform(Request::Refresh, |_| ()).unwrap();
        self.loopback.view().drive.status.unwrap().sum_per_mille
    }
}

#[test]
fn the_measured_level_is_held_and_switching_off_restores_the_drives() {
    let mut bench = Bench::driving(0.24, 0.3);
    let free = bench.sum_per_mille();
    bench.switch_on(12.0);
    bench.turn(true);
    assert_eq!(bench.standing(), Standing::Waiting, "the status may be of before the switch");
    bench.until("it listens", |standing| matches!(standing, Standing::Listening(_)));
    assert!(bench.standing().to_string().ends_with("leave the plate untouched"));
    bench.until_held();
    assert_eq!(bench.asked(), "LH");
    assert!(bench.correction_db().abs() < 0.2);
    bench.show(TOUCHED);
    bench.pass(40, true);
    assert!((bench.correction_db() - 6.02).abs() < 0.3, "{}", bench.correction_db());
    let hertz = bench.holding.frequency_hz(0).unwrap();
    assert!((hertz / bench.plate.frequency_for_boundary_hz(0.24) - 1.0).abs() < 1e-3);
    assert!(bench.sum_per_mille() > free * 3 / 2);
    bench.holding.switch_off();
    bench.pass(8, true);
    assert_eq!((bench.asked().as_str(), bench.standing()), ("O", Standing::Off(None)));
    assert_eq!(bench.sum_per_mille(), free);
    assert!(!bench.loopback.view().is_holding());
}

#[test]
fn a_hold_asks_nothing_while_the_drive_changes_and_then_holds_the_new_tones() {
    let mut bench = Bench::driving(0.24, 0.3);
    bench.switch_on(12.0);
    bench.pass(40, false);
    assert_eq!((bench.asked().as_str(), bench.standing()), ("", Standing::Changing));
    bench.until_held();
    bench.asked();
    // During a drag the device ends the hold at the first drive.
    for place_m in [0.235, 0.23] {
        bench.drive(place_m, 0.3);
        bench.pass(2, false);
        assert_eq!((bench.asked().as_str(), bench.standing()), ("", Standing::Changing));
        assert!(bench.holding.is_on());
    }
    let before = bench.loopback.view().drive.hold.clone();
    bench.until_held();
    // A report on the previous hold does not end this one.
    let mut late = bench.loopback.view().clone();
    late.drive.hold = before;
    assert!(bench.holding.turn(&late, &bench.plate, true).is_none());
    assert_eq!(bench.holding.standing(&late), Standing::Holding(None));
    assert_eq!(bench.asked(), "LH");
    let hertz = bench.holding.frequency_hz(0).unwrap();
    assert!((hertz / bench.plate.frequency_for_boundary_hz(0.23) - 1.0).abs() < 1e-3);
    // A change while it listens: the outcome of that window is ignored.
    bench.drive(0.24, 0.3);
    bench.until("it listens", |standing| matches!(standing, Standing::Listening(_)));
    bench.pass(3, true);
    bench.drive(0.24, 0.2);
    bench.until_held();
    assert_eq!(bench.asked(), "LLH");
}

#[test]
fn a_hold_waits_in_silence_and_then_holds_the_next_drive() {
    let mut bench = Bench::holding();
    bench.loopback.perform(Request::Stop, |_| ()).unwrap();
    bench.pass(10, true);
    assert_eq!(bench.standing(), Standing::Silent);
    bench.drive(0.24, 0.3);
    bench.until_held();
}

#[test]
fn what_cannot_be_held_is_reported_and_nothing_is_ordered() {
    let mut bench = Bench::driving(0.24, 0.3);
    bench.show(UNPLUGGED);
    bench.switch_on(12.0);
    assert_eq!(bench.until_off(), HoldEnd::Cannot(super::super::HoldError::Stuck));
    assert_eq!(bench.asked(), "L");
    // A device without inputs.
    let mut bare = bench.loopback.view().clone();
    bare.device.inputs = None;
    bench.switch_on(12.0);
    assert!(bench.holding.turn(&bare, &bench.plate, true).is_none());
    assert!(bench.holding.ended().unwrap().to_string().starts_with("the device has no inputs"));
}

#[test]
fn codes_that_were_lost_are_listened_to_again_but_not_for_ever() {
    let mut bench = Bench::driving(0.24, 0.3);
    bench.switch_on(12.0);
    bench.until("it listens", |standing| matches!(standing, Standing::Listening(_)));
    bench.pass(4, true);
    bench.asked();
    bench.loopback.inject_overrun(1);
    bench.until_held();
    // The first of the two is answered after the sample index it requested: the plate has settled by then.
    assert_eq!(bench.asked(), "LLH");
    bench.drive(0.23, 0.3);
    let mut listened = 0;
    for _ in 0..60 {
        bench.pass(1, true);
        listened += bench.asked().len();
        bench.loopback.inject_overrun(1);
    }
    assert!(!bench.holding.is_on() && listened == 1 + 3 * 2, "{listened} {:?}", bench.standing());
    assert!(matches!(bench.holding.ended(), Some(HoldEnd::Refused(Refusal::InputLost { .. }))));
}

#[test]
fn an_act_of_the_user_ends_the_hold_and_the_device_is_released() {
    for end in [HoldEnd::Stopped, HoldEnd::Measured] {
        let mut bench = Bench::holding();
        bench.asked();
        bench.holding.end(end.clone());
        bench.pass(4, true);
        assert_eq!(bench.asked(), "O");
        assert_eq!(bench.standing(), Standing::Off(Some(&end)));
        assert!(!bench.loopback.view().is_holding() && !end.is_trouble());
    }
    let mut bench = Bench::holding();
    bench.asked();
    bench.plate = Arc::new((*bench.plate).clone());
    assert_eq!(bench.until_off(), HoldEnd::OtherPlate);
    bench.pass(1, true);
    assert_eq!(bench.asked(), "O");
    // It was not on: nothing to end or to report.
    bench.holding.switch_off();
    bench.holding.end(HoldEnd::Stopped);
    bench.pass(4, true);
    assert_eq!((bench.asked().as_str(), bench.standing()), ("", Standing::Off(None)));
}

#[test]
fn a_device_that_is_muted_stopped_or_gone_ends_the_hold() {
    for (request, is_trouble) in [(Request::Disarm, false), (Request::EmergencyStop, true)] {
        let mut bench = Bench::holding();
        bench.loopback.perform(request, |_| ()).unwrap();
        let end = bench.until_off();
        assert!(
            if is_trouble { matches!(end, HoldEnd::Fault(_)) } else { end == HoldEnd::Disarmed },
            "{end}"
        );
        assert_eq!(end.is_trouble(), is_trouble);
    }
    let mut bench = Bench::holding();
    bench.asked();
    let mut gone = bench.loopback.view().clone();
    gone.link.state = LinkState::Disconnected;
    assert!(bench.holding.turn(&gone, &bench.plate, true).is_none(), "there is no device to ask");
    assert_eq!(bench.holding.ended(), Some(&HoldEnd::LinkLost));
    bench.pass(2, true);
    assert_eq!(bench.asked(), "", "no request later either");
}
