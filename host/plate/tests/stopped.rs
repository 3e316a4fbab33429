//! Long computations report their progress and end when the caller stops them.

use slipline_plate::check::{CheckError, Checker, Conditions};
use slipline_plate::design::{DesignError, Edge, Material, Request, Wave, design};
use slipline_plate::{DriveTable, KNOTS_MAX, Progress, Stopped, TableError, preset, sensitivity_per_percent};

/// The fractions that a computation reports until `limit` of it is done.
fn reported(limit: f64, compute: impl FnOnce(&mut Progress<'_>)) -> Vec<f64> {
    let mut shares = Vec::new();
    compute(&mut Progress::new(&mut |share| {
        shares.push(share);
        share < limit
    }));
    shares
}

#[test]
fn a_whole_computation_reports_rising_shares_up_to_nearly_all() {
    let plate = preset("membrane").expect("a preset");
    let coarse = DriveTable::build(&plate, 400e3, 33).expect("a table");
    let computations: [&dyn Fn(&mut Progress<'_>); 4] = [
        &|progress| drop(DriveTable::build_watched(&plate, 400e3, KNOTS_MAX, progress).expect("a table")),
        &|progress| assert!(sensitivity_per_percent(&coarse, &plate, progress).is_ok()),
        &|progress| drop(Checker::watched(&plate, Conditions::default(), progress).expect("checks")),
        &|progress| {
            let checker = Checker::new(&plate, Conditions::default()).expect("checks");
            drop(checker.over_span(progress).expect("on the span"));
        },
    ];
    for (number, compute) in computations.into_iter().enumerate() {
        let shares = reported(2.0, compute);
        // A check is prepared in eleven sweeps of eight boundaries.
        let fewest = if number == 2 { 11 } else { 40 };
        assert!(shares.len() >= fewest, "{number}: {}", shares.len());
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{number}");
        assert!(shares[0] < 0.03 && shares[shares.len() - 1] > 0.95, "{number}: {shares:?}");
    }
}

#[test]
fn a_no_ends_the_computation_at_once() {
    for name in ["membrane", "al-bending"] {
        let plate = preset(name).expect("a preset");
        let shares = reported(0.3, |progress| {
            let table = DriveTable::build_watched(&plate, 400e3, KNOTS_MAX, progress);
            assert_eq!(table, Err(TableError::Stopped(Stopped)));
        });
        let last = shares[shares.len() - 1];
        assert!((0.3..0.4).contains(&last), "{name}: {last}");
        assert!(shares[..shares.len() - 1].iter().all(|&share| share < 0.3), "{name}");
        reported(0.3, |progress| {
            let checker = Checker::watched(&plate, Conditions::default(), progress);
            assert_eq!(checker.map(drop), Err(CheckError::Stopped(Stopped)));
        });
    }
}

#[test]
fn a_design_can_be_stopped_at_every_step_of_it() {
    let material = Material::named("aluminium").expect("known");
    let wave = Wave::Bending { edge: Edge::Supported, thick_plate: true };
    let request = Request::new("stopped", material, 2e-3, wave, (20e3, 40e3), 0.3);
    let shares = reported(2.0, |progress| {
        assert_eq!(
            design(&request, progress),
            Ok(design(&request, &mut Progress::unwatched()).expect("possible"))
        );
    });
    assert!(shares.len() >= 5 && shares.is_sorted() && shares[shares.len() - 1] == 1.0, "{shares:?}");
    for limit in &shares {
        let until = reported(*limit, |progress| {
            assert_eq!(design(&request, progress), Err(DesignError::Stopped(Stopped)));
        });
        assert_eq!(until.last(), Some(limit));
    }
}
