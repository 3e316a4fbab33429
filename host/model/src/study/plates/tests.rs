use super::*;
use crate::study::Draft;
use slipline_plate::{Equation, TurningWidth, preset, quantity::decibels, respond};

fn study(plate: Plate, places: &str, count: u64, vary: &str) -> Study {
    let text =
        format!("plate = \"x\"\nseed = 7\ncount = {count}\nturning_point_m = [{places}]\n[vary]\n{vary}");
    let spec = Draft::parse(&text).unwrap().finish(Some(plate)).unwrap();
    Study::new(spec, &mut Progress::unwatched()).unwrap()
}

fn membrane() -> Plate {
    preset("membrane").unwrap()
}

const THREE: &str = "\"model.wave_speed_m_per_s\" = { normal = 0.01 }\nloss_factor = { log_normal = 0.3 }\n\"taper.rate_per_m\" = { uniform = 0.02 }";

#[test]
fn any_range_has_the_bits_of_the_whole() {
    for name in ["membrane", "al-bending", "al-sh"] {
        let plate = preset(name).unwrap();
        let (start_m, end_m) = plate.span_m();
        let places = format!("{start_m:?}, {:?}, {end_m:?}", 0.5 * (start_m + end_m));
        let vary = "loss_factor = { log_normal = 0.3 }\n\"taper.rate_per_m\" = { uniform = 0.02 }";
        let study = study(plate, &places, 24, vary);
        let whole = study.run_range(0..24);
        assert_eq!((whole.status.len(), whole.varied.len(), whole.results[1].len()), (24, 48, 72));
        // In turns, alone, and by another study of the same text.
        let again = Study::new(
            Draft::parse(&study.spec().to_toml()).unwrap().finish(None).unwrap(),
            &mut Progress::unwatched(),
        );
        let again = again.unwrap();
        for first in [16, 0, 8] {
            let part = again.run_range(first..first + 8);
            let rows = first as usize * 3..first as usize * 3 + 24;
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&part.results[1]), bits(&whole.results[1][rows.clone()]), "{name}");
            assert_eq!(bits(&part.results[0]), bits(&whole.results[0][rows]), "{name}");
            assert_eq!(part.status, whole.status[first as usize..first as usize + 8]);
        }
        assert_eq!(study.run_range(24..24), Chunk::empty(24, 2));
    }
}

#[test]
fn a_field_s_numbers_do_not_depend_on_which_others_vary() {
    let (all, one) = (
        study(membrane(), "0.16", 9, THREE),
        study(membrane(), "0.16", 9, "loss_factor = { log_normal = 0.3 }"),
    );
    for i in 0..9 {
        assert_eq!(all.varied(i)[0].to_bits(), one.varied(i)[0].to_bits());
    }
}

/// On an exponential taper, measured straight across, V/(W0 e^(-d x)) at the turning point is that of the frequency:
/// x moves by -ln(V'/V)/d.
#[test]
fn a_faster_wave_turns_nearer_by_the_logarithm_of_its_speed() {
    let plate = membrane().with_turning_width(TurningWidth::Plain);
    let study = study(plate, "0.1, 0.16, 0.24", 50, "\"model.wave_speed_m_per_s\" = { normal = 0.01 }");
    let chunk = study.run_range(0..50);
    for (i, shifts_m) in chunk.results[0].chunks(3).enumerate() {
        let expected_m = -(chunk.varied[i] / 12.0).ln() / 4.62;
        for shift_m in shifts_m {
            assert!((shift_m - expected_m).abs() < 1e-9, "{i}: {shift_m} {expected_m}");
        }
    }
    let statistics = crate::study::Statistics::of(&chunk.results[0]).unwrap();
    assert!((1.5e-3..3e-3).contains(&statistics.standard_deviation.unwrap()), "0.01/4.62 is 2.2 mm");
}

/// Loss times 1 + d changes K^2 by a phase: the wave is weaker by the integral of d eta K^2/(2 k) from the driven end to the
/// turning point, which is d eta K arcosh(K/q0)/(2 rate) on this taper, q0 = pi/(2 W0).
#[test]
fn a_lossier_plate_has_a_lower_peak_by_the_attenuation_along_its_way() {
    let plate = membrane().with_turning_width(TurningWidth::Plain);
    let study = study(plate, "0.12, 0.2", 40, "loss_factor = { log_normal = 0.1 }");
    let chunk = study.run_range(0..40);
    for (i, levels_db) in chunk.results[1].chunks(2).enumerate() {
        for (level_db, frequency_hz) in levels_db.iter().zip(study.frequencies_hz()) {
            let wavenumber = std::f64::consts::TAU * frequency_hz / 12.0;
            let way = wavenumber / (2.0 * 4.62) * (wavenumber * 0.05 / std::f64::consts::FRAC_PI_2).acosh();
            let expected_db = -20.0 / 10_f64.ln() * (chunk.varied[i] - 0.03) * way;
            assert!(
                (level_db - expected_db).abs() < 0.02 + 0.08 * expected_db.abs(),
                "{i}: {level_db} {expected_db}"
            );
        }
        assert!(chunk.results[0][2 * i..][..2].iter().all(|shift_m| shift_m.abs() < 1e-12));
    }
}

#[test]
fn level_and_shift_match_the_fine_solution_of_the_plate_s_own_file() {
    for name in ["membrane", "al-bending", "latex-membrane"] {
        let nominal = preset(name).unwrap();
        let (start_m, end_m) = nominal.span_m();
        let place_m = 0.5 * (start_m + end_m);
        let vary = "loss_factor = { log_normal = 0.3 }\nfull_scale_m = { uniform = 0.1 }\n\"taper.rate_per_m\" = { uniform = 0.02 }";
        let study = study(nominal.clone(), &format!("{place_m:?}"), 6, vary);
        let chunk = study.run_range(0..6);
        let frequency_hz = study.frequencies_hz()[0];
        let peak = |plate: &Plate| {
            let response = respond(plate, frequency_hz, 2001, Equation::Corrected).unwrap();
            let at_full_scale = plate.drive_response(frequency_hz).norm() * plate.spec().full_scale_m;
            (response.turning_point_m, response.peak.unwrap().amplitude * at_full_scale)
        };
        let (nominal_m, nominal_peak) = peak(&nominal);
        assert!((nominal_m - place_m).abs() < 2e-4, "the table moves a knot onto a resonance");
        for i in 0..6 {
            // By the text of the plate's file.
            let plate = Plate::from_toml(&study.plate(i as u64).unwrap().to_toml()).unwrap();
            let (turning_m, found_peak) = peak(&plate);
            assert!((chunk.results[0][i] - (turning_m - nominal_m)).abs() < 1e-12, "{name}");
            let level_db = decibels(found_peak / nominal_peak);
            assert!(
                (chunk.results[1][i] - level_db).abs() < 1e-3,
                "{name}: {} {level_db}",
                chunk.results[1][i]
            );
            assert_eq!(plate.spec().loss_factor, study.varied(i as u64)[1]);
        }
        assert!(chunk.results[1].iter().any(|level_db| level_db.abs() > 0.1));
    }
}

#[test]
fn a_bad_plate_has_its_reason_and_leaves_the_others_alone() {
    let wild = "loss_factor = { log_normal = 3.0 }\n\"model.wave_speed_m_per_s\" = { log_normal = 1.0 }";
    let study = study(membrane(), "0.09, 0.27", 400, wild);
    let chunk = study.run_range(0..400);
    let of = |status| chunk.status.iter().filter(|found| **found == status).count();
    let counts = Status::ALL.map(of);
    assert_eq!(counts.iter().sum::<usize>(), 400);
    assert_eq!(counts[0], 0);
    for status in [Status::Done, Status::Refused, Status::CannotEnter, Status::TooHigh] {
        assert!(of(status) > 10, "{status:?}: {counts:?}");
    }
    for (i, status) in chunk.status.iter().enumerate() {
        let finite = chunk.results[1][2 * i..][..2].iter().filter(|level| level.is_finite()).count();
        let turning = chunk.results[0][2 * i..][..2].iter().filter(|shift| shift.is_finite()).count();
        assert_eq!(finite, turning);
        assert_eq!(study.plate(i as u64).is_err(), *status == Status::Refused, "{i}");
        match status {
            Status::Done => assert_eq!(finite, 2),
            Status::Refused => assert_eq!(finite, 0),
            Status::CannotEnter | Status::TooHigh | Status::Silent => assert!(finite < 2),
            Status::NotYet | Status::NotSolved | Status::WorkerFailed => panic!("{i}: {status:?}"),
        }
        // A loss factor is at most 0.5.
        if chunk.varied[2 * i] > 0.5 {
            assert_eq!(*status, Status::Refused);
        }
    }
    // The wave that enters at the far place keeps its number where the near one has none.
    assert!(chunk.results[1].chunks(2).any(|pair| pair[0].is_nan() && pair[1].is_finite()));
    let refused = chunk.status.iter().position(|status| *status == Status::Refused).unwrap();
    let error = study.plate(refused as u64).unwrap_err().to_string();
    assert!(error.starts_with("plate: ") && error.contains("must be"), "{error}");
}

#[cfg(feature = "native")]
#[test]
fn threads_give_every_chunk_once_in_order_and_with_the_same_bits() {
    let study = study(membrane(), "0.12, 0.24", 53, THREE);
    let whole = crate::study::csv::rows(&study, &study.run_range(0..53));
    for (threads, at_once) in [(1, 53), (1, 8), (2, 8), (5, 1), (2, 1000)] {
        let mut rows = String::new();
        crate::study::run_in_order(&study, threads, at_once, |chunk| {
            rows.push_str(&crate::study::csv::rows(&study, &chunk));
            true
        })
        .unwrap();
        assert_eq!(rows, whole, "{threads} threads, {at_once} plates");
    }
    let mut taken = 0;
    crate::study::run_in_order(&study, 2, 8, |_| {
        taken += 1;
        taken < 3
    })
    .unwrap();
    assert_eq!(taken, 3, "ended by its caller");
}

#[test]
fn the_csv_has_its_specification_and_reads_back_to_the_same_bits() {
    let wild = "\"model.wave_speed_m_per_s\" = { log_normal = 1.0 }";
    let study = study(membrane(), "0.09, 0.27", 40, wild);
    let chunk = study.run_range(0..40);
    let text = crate::study::csv::head(&study) + &crate::study::csv::rows(&study, &chunk);
    let comments: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix('#')).collect();
    let spec: String = comments[4..].iter().map(|line| format!("{}\n", line.trim_start())).collect();
    assert_eq!(&Draft::parse(&spec).unwrap().finish(None).unwrap(), study.spec());
    let mut rows = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    assert_eq!(
        names,
        [
            "plate",
            "status",
            "vary_model_wave_speed_m_per_s",
            "turning_point_shift_m_at_0.09",
            "level_db_at_0.09",
            "turning_point_shift_m_at_0.27",
            "level_db_at_0.27"
        ]
    );
    for (i, row) in rows.enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!((cells[0], cells[1]), (i.to_string().as_str(), chunk.status[i].meaning()));
        let number = |cell: &str| if cell.is_empty() { f64::NAN } else { cell.parse::<f64>().unwrap() };
        let pairs = [
            (cells[2], chunk.varied[i]),
            (cells[3], chunk.results[0][2 * i]),
            (cells[4], chunk.results[1][2 * i]),
            (cells[5], chunk.results[0][2 * i + 1]),
            (cells[6], chunk.results[1][2 * i + 1]),
        ];
        for (cell, value) in pairs {
            assert!(
                number(cell).to_bits() == value.to_bits() || number(cell).is_nan() && value.is_nan(),
                "{row}"
            );
        }
    }
}
