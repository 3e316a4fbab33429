//! The light for a device whose DAC's output is not linear up to full scale.

use super::*;

#[test]
fn a_tone_beyond_the_linear_share_is_amber_and_its_sentence_states_how_far_to_lower_it() {
    let plate = preset("membrane").expect("a preset");
    let lights = |level: f64, linear_share: f64| {
        let conditions = Conditions { level, linear_share, ..Conditions::default() };
        let report = Checker::new(&plate, conditions).expect("checks").over_span(&mut Progress::unwatched());
        report.expect("over the span")
    };
    assert!(lights(1.0, 1.0).light("linear output").is_none(), "nothing exceeds full scale");
    // Somewhere on the span the table needs all of full scale.
    let report = lights(1.0, 0.88);
    let beyond = light(&report, "linear output");
    assert_eq!((beyond.colour, report.lights.len()), (Colour::Amber, 23));
    assert!((value(&report, "linear output") - 100.0 / 0.88).abs() < 0.5, "{beyond:?}");
    let sentence = "The tone takes 100 % of full scale, and the output of the DAC is linear up to 88 %: its peaks are flattened, which \
                    adds harmonics. Lower the level by 1.2 dB.";
    assert_eq!(beyond.sentence, sentence);
    let within = lights(10_f64.powf(-1.2 / 20.0), 0.88);
    assert_eq!(light(&within, "linear output").colour, Colour::Green, "{within:?}");
    let absurd = Checker::new(&plate, Conditions { linear_share: 0.0, ..Conditions::default() });
    assert!(absurd.expect_err("absurd").to_string().contains("linear share = 0: must be 0.1 to 1"));
}
