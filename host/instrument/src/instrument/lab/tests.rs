//! The lab, without a device: obstacles, and what is known of the simulated plate.

use super::*;
use crate::hold::HoldEnd;
use crate::instrument::tests::StillLink;
use slipline_link::protocol::listen::InputsReport;
use slipline_link::simulator::loopback::Loopback;
use slipline_model::setup::Setup;

/// A lab and its neighbours.
struct House {
    desk: Desk,
    drive: Drive,
    lab: Lab,
    attention: Attention,
    out: Outbox,
}

impl House {
    /// The simulated device at the bench has reported these inputs.
    fn with(inputs: Option<InputsReport>) -> Self {
        let loopback = Loopback::connect(400_000).unwrap();
        let mut snapshot = Snapshot { revision: 1, ..loopback.view().clone() };
        snapshot.device.inputs = inputs;
        snapshot.link.port = Some(Port::Simulated);
        let link = StillLink::with(snapshot);
        let setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        let mut jobs = Jobs::inline();
        let mut drive = Drive::new(Box::new(link), &setup.plate, &mut jobs);
        drive.take_snapshot();
        let lab = Lab::new(&setup.plate, Bench::default(), &mut jobs);
        let (attention, out) = (Attention::default(), Outbox::default());
        Self { desk: Desk::new(setup), drive, lab, attention, out }
    }

    fn perform(&mut self, act: impl FnOnce(&mut Lab, &mut Reach<'_>)) {
        let Self { desk, drive, lab, attention, out } = self;
        act(lab, &mut Reach { desk, drive, attention, out });
    }

    fn notice(&self) -> Option<&str> {
        self.out.notices().last().map(|notice| notice.text.as_str())
    }
}

#[test]
fn a_hold_and_a_measurement_without_an_input_state_the_obstacle() {
    let mut house = House::with(None);
    house.perform(|lab, reach| lab.switch_hold(true, reach));
    assert!(house.notice().unwrap().contains("no input for a sensor"));
    house.out = Outbox::default();
    house.perform(|lab, reach| lab.perform_measure(MeasureIntent::Begin(None), reach));
    assert!(house.notice().unwrap().contains("no input for a sensor"));
    assert!(!house.lab.is_measuring() && !house.lab.hold.needs_sensor());
}

#[test]
fn a_hold_waits_for_the_rig_of_the_simulated_device_and_another_action_ends_it() {
    let mut house = House::with(Some(InputsReport { inputs: 2, ..InputsReport::default() }));
    house.perform(|lab, reach| lab.switch_hold(true, reach));
    assert!(house.notice().is_none() && house.lab.hold.awaits_rig);
    house.perform(|lab, reach| lab.turn(None, reach));
    house.perform(|lab, reach| lab.turn(None, reach));
    assert!(house.lab.hold.holding.is_on() && !house.lab.hold.awaits_rig);
    house.perform(|lab, reach| lab.end_hold(HoldEnd::Measured, reach.out));
    assert!(house.notice().unwrap().starts_with("The levels are not held any more"));
}

#[test]
fn an_unknown_plate_is_known_once_it_is_measured_and_stays_under_a_plate_calibrated_on_it() {
    let mut house = House::with(None);
    let known = |house: &House| {
        let plate = house.lab.simulated_plate(house.desk.plate(), house.drive.snapshot());
        plate.map(|plate| Arc::ptr_eq(plate, house.desk.plate()))
    };
    assert_eq!((known(&house), house.lab.take_other_truth()), (Some(true), false));
    house.perform(|lab, reach| lab.perform_measure(MeasureIntent::Secret(true), reach));
    assert_eq!((known(&house), house.lab.take_other_truth()), (None, true));
    house.lab.rig.note_measured();
    assert_eq!((known(&house), house.lab.take_other_truth()), (Some(false), true));
    let calibrated = Arc::new(slipline_plate::Plate::clone(house.desk.plate()));
    house.lab.rig.is_described_by(&calibrated);
    house.lab.use_plate(&calibrated, &mut house.out);
    assert!(!house.lab.take_other_truth(), "it is the same plate on the rig");
    house.lab.use_plate(&Arc::new(slipline_plate::preset("membrane").unwrap()), &mut house.out);
    assert!(house.lab.take_other_truth(), "another plate has another unknown one");
}
