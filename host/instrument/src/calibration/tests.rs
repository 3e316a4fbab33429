use super::*;
use slipline_plate::Complex64;
use slipline_plate::calibrate::{CalibrateError, MeasuredPoint, SensorKind};

fn measurement(place_m: f64) -> Measurement {
    let point = |i: u32| MeasuredPoint {
        frequency_hz: 100.0 + f64::from(i),
        response: Complex64::ONE,
        noise: 0.01,
        headroom_db: None,
    };
    Measurement::at(place_m, SensorKind::Velocity, (0..10).map(point).collect())
}

fn answer(place_m: f64) -> PlaceResponse {
    PlaceResponse { name: "run".to_owned(), measurement: Arc::new(measurement(place_m)) }
}

fn calibration() -> CalibrationWizard {
    CalibrationWizard::of(&Arc::new(slipline_plate::preset("membrane").unwrap()))
}

#[test]
fn the_pages_follow_each_other_and_wait_for_the_answers() {
    let mut calibration = calibration();
    let mut visited = vec![calibration.step];
    while let Some(next) = calibration.step.next() {
        if let Some(sensor) = calibration.step.sensor() {
            assert!(calibration.obstacle().is_some() && calibration.job(400e3).is_none());
            calibration.take_answer(sensor, answer(0.1 * (1.0 + sensor as f64)));
        }
        assert_eq!(calibration.obstacle(), None);
        calibration.step = next;
        assert_eq!(next.back(), visited.last().copied());
        visited.push(next);
    }
    assert_eq!(visited, WizardPage::ALL);
    assert_eq!(
        (WizardPage::Plate.back(), WizardPage::Plate.number(), WizardPage::Result.number()),
        (None, 1, 5)
    );
    let places = |calibration: &CalibrationWizard| {
        calibration.job(400e3).unwrap().sensors.map(|measurement| measurement.place_m)
    };
    assert_eq!(places(&calibration), [0.1, 0.2]);
    // The check is beside the result: it may be left out.
    let checked_m =
        |calibration: &CalibrationWizard| calibration.job(400e3).unwrap().check.map(|it| it.place_m);
    calibration.step = WizardPage::Check;
    assert_eq!(
        (calibration.step.next(), calibration.step.back()),
        (Some(WizardPage::Result), Some(WizardPage::Result))
    );
    assert_eq!((calibration.obstacle(), checked_m(&calibration)), (None, None));
    calibration.take_answer(2, answer(0.15));
    assert_eq!(checked_m(&calibration), Some(0.15));
    calibration.leave_check_out();
    assert_eq!(checked_m(&calibration), None);
    calibration.exchange();
    assert_eq!(places(&calibration), [0.2, 0.1]);
    let other = Arc::new(slipline_plate::preset("al-bending").unwrap());
    let other = calibration.with_plate(&other);
    assert_eq!((other.step, places(&other)), (WizardPage::Plate, [0.2, 0.1]));
}

#[test]
fn calipers_move_the_places_and_impossible_ones_are_refused() {
    let mut calibration = calibration();
    // Beyond the third width mode, which propagates to 0.27 of the length, and before the last boundary.
    let of_plate = calibration.places_m();
    assert!(of_plate[..2].iter().all(|place_m| (place_m - of_plate[2]).abs() > 0.015), "{of_plate:?}");
    assert!(of_plate[0] >= 0.086 && of_plate[0] < of_plate[1] && of_plate[1] < 0.28, "{of_plate:?}");
    let of_file = calibration.calipers_of_file();
    let longer = Calipers { length_m: 0.33, ..of_file };
    calibration.take_calipers(Some(longer)).unwrap();
    let of_longer = calibration.places_m();
    assert_ne!(of_longer, of_plate);
    let refused = calibration.take_calipers(Some(Calipers { end_half_width_m: 0.5, ..of_file })).unwrap_err();
    assert!(refused.to_string().contains("end_half_width_m"), "{refused}");
    assert_eq!(calibration.calipers(), Some(longer), "the earlier dimensions stay");
    assert_eq!(calibration.places_m(), of_longer);
    calibration.take_calipers(None).unwrap();
    assert_eq!(calibration.places_m(), of_plate);
}

#[test]
fn a_refusal_leads_to_the_page_of_its_cause() {
    let (first, second, third) = (measurement(0.03), measurement(0.17), measurement(0.1));
    let remedy = |error: CalibrateError| Remedy::of(&error, [&first, &second], Some(&third));
    for (error, page) in [
        (CalibrateError::NoSignal { place_m: 0.03 }, WizardPage::FirstAnswer),
        (CalibrateError::NoSignal { place_m: 0.17 }, WizardPage::SecondPlace),
        (CalibrateError::Clipped { place_m: 0.17, count: 1, of: 9 }, WizardPage::SecondPlace),
        (CalibrateError::Misplaced { place_m: 0.03, found_m: 0.04 }, WizardPage::FirstAnswer),
        (CalibrateError::Clipped { place_m: 0.1, count: 1, of: 9 }, WizardPage::Check),
        (CalibrateError::DifferentSensors, WizardPage::SecondPlace),
        (CalibrateError::NoFit, WizardPage::Plate),
        (CalibrateError::Unlike { chi2_per_n: 20.0, most: 6.0 }, WizardPage::Plate),
    ] {
        assert_eq!(remedy(error.clone()), Remedy::Page(page), "{error}");
    }
    let swapped = CalibrateError::Swapped { first_m: 0.03, second_m: 0.17 };
    assert_eq!(remedy(swapped), Remedy::Exchange);
}

#[test]
fn the_pages_name_what_a_sensor_on_each_preset_may_weigh() {
    let note =
        |name: &str| CalibrationWizard::of(&Arc::new(slipline_plate::preset(name).unwrap())).sensor_note();
    for preset in slipline_plate::presets() {
        let note = note(preset.name);
        println!("{}: {note}", preset.name);
        assert!(note.starts_with("A laser suits every plate. ") && note.contains("microphone"), "{note}");
        assert!(note.contains(" mg with its mass stated") != note.contains("is not known"), "{note}");
    }
    let milligrams = |name: &str| -> f64 {
        let note = note(name);
        let (_, rest) = note.split_once("at most ").unwrap();
        rest.split_once(" mg").unwrap().0.parse().unwrap()
    };
    assert!(milligrams("tungsten-membrane") > 50.0, "a bare chip");
    assert!(milligrams("membrane") < 0.1 * milligrams("tungsten-membrane"));
}
