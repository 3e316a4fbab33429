//! The first figure of a process is like every later one. In this process no other test draws.

use slipline_model::export::figures::Format;
use slipline_model::export::figures::plate::{Subject, plate_figure};
use slipline_model::field::steady_field::{SteadyField, steady_tones};
use slipline_model::setup::{Setup, ToneSetup};
use slipline_plate::DriveTable;
use std::sync::Arc;

#[test]
fn the_first_figure_of_a_process_is_as_large_as_the_second_and_looks_like_it() {
    let mut setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
    let first = setup.tones[0];
    // A caption of more than one line.
    setup.tones.extend([1, 2].map(|slot| ToneSetup {
        slot,
        position_m: 0.1 + 0.05 * f64::from(slot),
        ..first
    }));
    let table = DriveTable::build(&setup.plate, 400e3, 17).unwrap();
    let predicted = SteadyField::solve(&setup.plate, &steady_tones(&setup, Some(&table)));
    let subject = Subject {
        sounding: Some(predicted.clone()),
        setup,
        predicted,
        sheet: None,
        measured: None,
        full_peak_m: table.peak_at_full_scale_m(),
        magnification: 1.0,
        is_largest: false,
        wave_time_s: 0.0,
    };
    let size = |file: &[u8]| {
        let reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        reader.info().size()
    };
    let png = || plate_figure(&subject).unwrap().file(Format::Png).unwrap();
    let (first, second) = (png(), png());
    assert_eq!(size(&first), size(&second));
    assert!(first == second, "of one size, but not alike");
}
