//! Numbers on the command line: a dimension has its unit, a comma is no doubt, a level is a factor, a share or decibels.

use super::{design, failure, file, json, number, refused, said};

#[test]
fn a_number_without_its_unit_is_refused_with_the_unit_that_was_probably_meant() {
    let drive = ["drive", "--port", "unix:/no/such/device", "--plate", "membrane", "--turning-point"];
    let at = [&drive[..], &["120mm"]].concat();
    let measure = ["measure", "--port", "unix:/no/such/device", "--plate", "al-bending", "--sensor", "34mm"];
    for (arguments, wanted) in [
        ([&drive[..], &["160"]].concat(), "invalid value '160' for '--turning-point': did you mean 160mm?"),
        ([&drive[..], &["0.16"]].concat(), "did you mean 0.16m?"),
        ([&drive[..], &["16"]].concat(), "did you mean 16cm?"),
        (
            vec!["measure", "--plate", "al-bending", "--sensor", "0.034"],
            "did you mean 0.034m? (must be 0 m to 340 mm, on the plate)",
        ),
        (vec!["verify", "--window", "250"], "did you mean 250ms?"),
        (vec!["drive", "--felt-edge", "0.25"], "did you mean 0.25m?"),
        ([&drive[..], &["160:0.5"]].concat(), "did you mean 160mm?"),
        ([&at[..], &["--for", "5"]].concat(), "did you mean 5s? (must be 0 to 600 s)"),
        ([&at[..], &["--for", "1,000ms"]].concat(), "did you mean 1000ms or 1.000ms? (must be 0 to 600 s)"),
        ([&at[..], &["--glide", "20"]].concat(), "did you mean 20ms? (must be 5 ms to 10 s)"),
        (vec!["respond", "--plate", "membrane", "--freq", "126"], "did you mean 126Hz?"),
        (vec!["respond", "--plate", "membrane", "--freq", "1,234Hz"], "did you mean 1234Hz or 1.234Hz?"),
        (
            vec!["respond", "--freq", "126Hz", "--finger", "90mm:1,0.1g,10mm"],
            "its resistance: did you mean 1Ns/m?",
        ),
        (
            vec!["respond", "--freq", "126Hz", "--finger", "90mm:1Ns/m,0.1,10mm"],
            "its mass: did you mean 0.1g?",
        ),
        (vec!["respond", "--freq", "126Hz", "--finger", "90:light"], "its place: did you mean 90mm?"),
        (vec!["calibrate", "--plate", "membrane", "--touch", "250:246mm"], "did you mean 250mm?"),
        (
            [&measure[..], &["--amplifier", "2", "--piezo", "1nF", "--shunt", "1A"]].concat(),
            "did you mean 2V?",
        ),
        (
            [&measure[..], &["--amplifier", "2V", "--piezo", "220", "--shunt", "1A"]].concat(),
            "did you mean 220nF?",
        ),
    ] {
        refused(&arguments, 2, &[wanted]);
    }
    for (more, wanted) in [
        (["--rim", "20"], "did you mean 20mm? (must be 10 to 500 mm)"),
        (["--wave-speed", "12"], "did you mean 12m/s?"),
        (["--tension", "70"], "did you mean 70N/m?"),
        (["--start-margin", "40"], "did you mean 40mm?"),
    ] {
        let message = String::from_utf8(design(&more).stderr).unwrap();
        assert!(message.contains(wanted), "{more:?} does not say {wanted:?}: {message}");
    }
    // Zero is zero in any unit.
    assert!(failure(&[&at[..], &["--for", "0"]].concat(), 1).contains("/no/such/device"));
}

#[test]
fn a_level_is_a_factor_a_share_or_decibels() {
    let wav = file("levels.wav");
    let tones = ["--turning-point", "120mm:50%", "--turning-point", "200mm:-20dB", "--level", "-40 dB"];
    let record = ["record", "--plate", "membrane", "--seconds", "1ms", "--wav", wav.to_str().unwrap()];
    let value = json(&[&record[..], &tones, &["--turning-point", "160mm"]].concat());
    for (tone, level) in value["tones"].as_array().unwrap().iter().zip([0.5, 0.1, 0.01]) {
        assert!((number(tone, "level") - level).abs() < 1e-9, "{value}");
    }
    refused(&[&record[..], &["--turning-point", "120mm:3dB"]].concat(), 2, &["its level: must be 0 to 1"]);
}

#[test]
fn a_zero_has_no_sign() {
    let feeling = file("zero.toml");
    std::fs::write(&feeling, "[feeling]\nfriction_residual = -0.0\n").unwrap();
    let wav = file("zero.wav");
    let record = ["record", "--json", "--plate", "membrane", "--turning-point", "120mm", "--seconds", "1ms"];
    let files = ["--wav", wav.to_str().unwrap(), "--feeling", feeling.to_str().unwrap()];
    let text = said(&[&record[..], &files].concat());
    assert!(text.contains("\"friction_residual\":0.0,"), "{text}");
}
