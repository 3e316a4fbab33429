//! The drive of a plate file: actuator, source, ends and lead-in.

use super::*;

#[test]
fn the_travel_of_an_actuator_is_given_as_a_whole_and_refused_by_field_and_range() {
    let with = |fields: &str| {
        Plate::from_toml(&format!("{GOOD}[actuator]\nresonance_hz = 40\nquality = 2\n{fields}"))
    };
    let travel_of =
        |plate: &Plate| plate.spec().actuator.as_ref().and_then(Actuator::resonator).expect("given").travel;
    assert_eq!(travel_of(&with("").expect("no limit")), None);
    let plate = with("peak_travel_m = 2e-3\nstatic_travel_m = 5e-3\n").expect("a limit");
    let travel = travel_of(&plate);
    assert_eq!(travel, Some(slipline_plate::Travel { peak_m: 2e-3, static_m: 5e-3 }));
    assert_eq!(Plate::from_toml(&plate.to_toml()).expect("its own text"), plate);
    for (fields, wanted) in [
        (
            "peak_travel_m = 2e-3\n",
            "actuator.static_travel_m is missing: how far a steady signal at DAC full scale would move it, a number, \
             1e-9 to 0.1 m",
        ),
        (
            "static_travel_m = 2e-3\n",
            "actuator.peak_travel_m is missing: farthest that the actuator may move from its rest",
        ),
        (
            "peak_travel_m = 2\nstatic_travel_m = 2e-3\n",
            "line 22: actuator.peak_travel_m = 2: must be 1e-9 to 0.1 m",
        ),
        (
            "peak_travel_m = 1e-3\nstatic_travel_m = nan\n",
            "actuator.static_travel_m = nan: must be 1e-9 to 0.1 m",
        ),
        (
            "peak_travel_m = 1e-6\nstatic_travel_m = 2e-3\n",
            "actuator.static_travel_m = 0.002: must be 1e-9 to 0.001 m: at most 1000 times actuator.peak_travel_m = 1e-6",
        ),
        ("peak_travel_mm = 2\n", "did you mean peak_travel_m?"),
    ] {
        let found = with(fields).expect_err(fields).to_string();
        assert!(found.contains(wanted), "{fields}: {found}");
    }
}

const BENDING: &str = r#"
name = "mine"
length_m = 0.34
loss_factor = 0.002
span_start_m = 0.2
span_end_m = 0.27

[taper]
kind = "exponential"
half_width_m = 0.02
rate_per_m = 4.62

[model]
kind = "bending-supported"
youngs_modulus_pa = 70e9
poisson_ratio = 0.33
density_kg_per_m3 = 2700.0
thickness_m = 0.002

"#;

#[test]
fn a_source_is_read_with_its_impedance_its_slope_and_its_lead_in_and_written_back() {
    let read = |drive: &str| Plate::from_toml(&format!("{BENDING}{drive}")).expect(drive);
    let plate = read("[drive]\nend = \"source\"\nat_frequency_hz = 28e3\n");
    let soft = Source::soft(&plate.spec().model, 28e3);
    assert_eq!(plate.spec().drive_end, DriveEnd::Source(soft));
    assert_eq!(soft.slope, Some(EndSlope::Free), "free unless it is said");
    let whole = read(
        "[drive]\nend = \"source\"\nat_frequency_hz = 28e3\nresistance_n_s_per_m = 3\nmass_kg = 1e-3\n\
         stiffness_n_per_m = 2e4\nslope = \"held\"\n[drive.lead_in]\nlength_m = 0.06\nloss_factor = 0.2\n\
         end_resistance_n_s_per_m = 55.0\n",
    );
    let lead_in = LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 55.0 };
    let wanted = Source {
        impedance: Impedance { resistance_n_s_per_m: 3.0, mass_kg: 1e-3, stiffness_n_per_m: 2e4 },
        slope: Some(EndSlope::Held),
        lead_in: Some(lead_in),
        ..soft
    };
    assert_eq!(whole.spec().drive_end, DriveEnd::Source(wanted));
    let hinged = read("[drive]\nend = \"displacement\"\nslope = \"free\"\n");
    assert_eq!(hinged.spec().drive_end, DriveEnd::DisplacementAndSlope { slope: EndSlope::Free });
    for plate in [plate, whole, hinged] {
        assert_eq!(Plate::from_toml(&plate.to_toml()).expect("its own text"), plate);
    }
}

#[test]
fn an_end_that_does_not_suit_the_plate_is_refused_with_the_reason() {
    let source = "end = \"source\"\nat_frequency_hz = 28e3\n";
    let lead_in = "[drive.lead_in]\nlength_m = 0.06\nloss_factor = 0.2\n";
    let membrane = GOOD.replace("end = \"displacement\"", "end = \"source\"\nat_frequency_hz = 140");
    let tensioned = membrane.replace("m_per_s = 12.0", "m_per_s = 12.0\ntension_n_per_m = 40");
    assert!(Plate::from_toml(&tensioned).is_ok());
    for (text, wanted) in [
        (
            format!("{BENDING}[drive]\n{source}slope = \"tight\"\n"),
            "drive.slope = \"tight\": must be one of \"free\", \"held\"",
        ),
        (format!("{BENDING}[drive]\n{source}mass_kg = -1\n"), "drive.mass_kg = -1: must be 0 to 1000 kg"),
        (
            format!("{BENDING}[drive]\n{source}stiffness_n_per_m = nan\n"),
            "drive.stiffness_n_per_m = nan: must be 0 to 1e12 N/m",
        ),
        (
            format!("{BENDING}[drive]\nend = \"source\"\n"),
            "drive.at_frequency_hz is missing: \"source\" needs it",
        ),
        (
            format!("{BENDING}[drive]\n{source}ratio = 1\n"),
            "drive.ratio does not belong here: \"source\" has at_frequency_hz, resistance_n_s_per_m",
        ),
        (
            format!("{BENDING}[drive]\nend = \"displacement\"\n{lead_in}"),
            "line 22: drive.lead_in does not belong here: it works only behind a soft drive, a \"source\"; \"displacement\" hides it",
        ),
        (
            format!("{BENDING}[drive]\n{source}lead_in = 3\n"),
            "drive.lead_in = 3: must be a section [drive.lead_in]",
        ),
        (
            format!("{BENDING}[drive]\n{source}[drive.lead_in]\nlength_m = 0.06\n"),
            "drive.lead_in.loss_factor is missing: loss factor of the lead-in with its layer, a number, 0 to 2",
        ),
        (
            format!("{BENDING}[drive]\n{source}{lead_in}end_resistance_n_s_per_m = -2\n"),
            "line 26: drive.lead_in.end_resistance_n_s_per_m = -2: must be 0 to 1e9 N s/m",
        ),
        (
            format!("{BENDING}[drive]\n{source}[drive.lead_in]\nlength_m = 0\nloss_factor = 0.2\n"),
            "drive.lead_in.length_m = 0: must be 0.001 to 10 m",
        ),
        (
            format!("{BENDING}[drive]\n{source}[drive.lead_in]\nlength_m = 0.06\nloss_factor = 3\n"),
            "drive.lead_in.loss_factor = 3: must be 0 to 2",
        ),
        (
            format!("{BENDING}[drive]\n{source}{lead_in}lenght_m = 2\n"),
            "drive.lead_in.lenght_m does not belong here: did you mean length_m?",
        ),
        (
            membrane,
            "line 13: model.tension_n_per_m is missing: a source needs it: the force per metre of width, in N/m",
        ),
        (
            format!("{tensioned}slope = \"free\"\n"),
            "drive.slope does not belong here: only the end of a plate in bending has a slope",
        ),
        (
            format!("{tensioned}{lead_in}"),
            "drive.lead_in does not belong here: only a plate in bending has one",
        ),
        (
            tensioned.replace("n_per_m = 40", "n_per_m = 0"),
            "model.tension_n_per_m = 0: must be 1e-9 to 1e13 N/m",
        ),
    ] {
        let found = Plate::from_toml(&text).expect_err(&text).to_string();
        assert!(found.contains(wanted), "{wanted}: {found}");
    }
}

#[test]
fn a_measured_actuator_is_read_in_place_of_a_resonance() {
    let with = |fields: &str| Plate::from_toml(&format!("{GOOD}[actuator]\n{fields}"));
    let plate = with("points = [[50, 0.0, 0.0], [200.0, -6, -90.0]]").expect("a curve");
    let Some(Actuator::Measured(curve)) = &plate.spec().actuator else { panic!("a measured curve") };
    assert_eq!(curve.points, [[50.0, 0.0, 0.0], [200.0, -6.0, -90.0]]);
    assert_eq!(Plate::from_toml(&plate.to_toml()).expect("its own text"), plate);
    for (fields, wanted) in [
        (
            "points = [[50, 0.0], [200.0, -6, -90.0]]",
            "actuator.points[0] = [50, 0.0]: must be a triple [frequency, gain, phase]",
        ),
        ("points = [[50, 0, 0]]", "actuator.points has 1 points: must be 2 to 10000"),
        (
            "points = [[50, 0, 0], [40, 0, 0]]",
            "line 20: actuator.points[1][0] = 40: must be 50.001 to 1e7 Hz: frequencies must rise from point to point",
        ),
        ("points = [[50, 0, 0], [400, 300, 0]]", "actuator.points[1][1] = 300: must be -200 to 200 dB"),
        (
            "points = [[50, 0, nan], [400, 0, 0]]",
            "actuator.points[0][2] = nan: must be -36000 to 36000 degrees",
        ),
        (
            "quality = 2\npoints = [[50, 0, 0], [60, 0, 0]]",
            "actuator.quality does not belong here: the response is given by points already",
        ),
    ] {
        let found = with(fields).expect_err(fields).to_string();
        assert!(found.contains(wanted), "{fields}: {found}");
    }
}

#[test]
fn the_bandwidth_of_the_amplifier_is_read_with_or_without_a_response_and_refused_by_field_and_range() {
    let with = |fields: &str| Plate::from_toml(&format!("{GOOD}[actuator]\n{fields}"));
    let stated = "amplifier_bandwidth_hz = 120000\n";
    let good = Plate::from_toml(GOOD).expect("valid");
    assert_eq!(good.spec().amplifier_bandwidth_hz, None);
    let alone = with(stated).expect("a bandwidth alone");
    assert!(alone.spec().actuator.is_none() && alone.spec().harmonics.is_none());
    assert_eq!(DriveTable::build(&alone, 400e3, 17), DriveTable::build(&good, 400e3, 17));
    let whole = with(&format!("resonance_hz = 40\nquality = 2\n{stated}")).expect("beside a response");
    assert!(whole.spec().actuator.is_some());
    for plate in [&alone, &whole] {
        assert_eq!(plate.spec().amplifier_bandwidth_hz, Some(120e3));
        assert_eq!(Plate::from_toml(&plate.to_toml()).as_ref(), Ok(plate), "its own text");
    }
    for (fields, wanted) in [
        ("amplifier_bandwidth_hz = 9\n", "actuator.amplifier_bandwidth_hz = 9: must be 10 to 1"),
        ("amplifier_bandwidth_hz = nan\n", "actuator.amplifier_bandwidth_hz = nan: must be 10 to 1"),
        ("quality = 2\namplifier_bandwidth_hz = 100\n", "actuator.resonance_hz is missing"),
    ] {
        let found = with(fields).expect_err(fields).to_string();
        assert!(found.contains(wanted), "{fields}: {found}");
    }
}

#[test]
fn harmonics_are_read_with_or_without_a_response_and_refused_by_field_and_range() {
    let with = |fields: &str| Plate::from_toml(&format!("{GOOD}[actuator]\n{fields}"));
    let two = "harmonic_level = 0.8\nharmonic_2_points = [[50, -40, 0], [500, -43, 30]]\n";
    let alone = with(two).expect("harmonics alone");
    let spec = alone.spec();
    let harmonics = spec.harmonics.as_ref().expect("stated");
    assert!(spec.actuator.is_none() && harmonics.third.is_none() && harmonics.level == 0.8);
    assert_eq!(harmonics.second.as_ref().map(|curve| curve.points[1]), Some([500.0, -43.0, 30.0]));
    let whole = with(&format!(
        "resonance_hz = 40\nquality = 2\n{two}harmonic_3_points = [[50, -46, 0], [500, -46, 0]]\n"
    ));
    let whole = whole.expect("a resonance with harmonics");
    assert!(
        whole.spec().actuator.is_some()
            && whole.spec().harmonics.as_ref().is_some_and(|it| it.third.is_some())
    );
    for plate in [&alone, &whole] {
        assert_eq!(Plate::from_toml(&plate.to_toml()).as_ref(), Ok(plate), "its own text");
    }
    // Neither response nor table have a digit of them.
    let good = Plate::from_toml(GOOD).expect("valid");
    assert_eq!(DriveTable::build(&alone, 400e3, 17), DriveTable::build(&good, 400e3, 17));
    let points = "harmonic_2_points = [[50, -40, 0], [500, -40, 0]]\n";
    for (fields, wanted) in [
        (
            points.to_owned(),
            "actuator.harmonic_level is missing: level of the tone at which the harmonics hold, a number, 0.001 to 1",
        ),
        (
            "harmonic_level = 0.5\n".to_owned(),
            "actuator.harmonic_2_points is missing: the drive's second harmonic",
        ),
        (format!("harmonic_level = 0\n{points}"), "actuator.harmonic_level = 0: must be 0.001 to 1"),
        (format!("harmonic_level = nan\n{points}"), "actuator.harmonic_level = nan: must be 0.001 to 1"),
        (
            "harmonic_level = 0.5\nharmonic_3_points = [[50, 3, 0], [500, -40, 0]]\n".to_owned(),
            "actuator.harmonic_3_points[0][1] = 3: must be -200 to 0 dB",
        ),
        (
            "harmonic_level = 0.5\nharmonic_2_points = [[50, -40, 0], [50, -40, 0]]\n".to_owned(),
            "actuator.harmonic_2_points[1][0] = 50: must be",
        ),
        (
            "harmonic_level = 0.5\nharmonic_2_points = [[50, -40, 0]]\n".to_owned(),
            "actuator.harmonic_2_points",
        ),
        (
            "harmonic_level = 0.5\nharmonic_2_points = [[50, -40], [60, -40]]\n".to_owned(),
            "a triple [frequency, level, phase] of numbers, in Hz, dB and degrees",
        ),
        (format!("quality = 2\nharmonic_level = 0.5\n{points}"), "actuator.resonance_hz is missing"),
        ("harmonics_level = 0.5\n".to_owned(), "did you mean harmonic_level?"),
    ] {
        let found = with(&fields).expect_err(&fields).to_string();
        assert!(found.contains(wanted), "{fields}: {found}");
    }
}
