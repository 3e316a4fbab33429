//! Texts about a measurement: recognition of its file, and its agreement with the plate on the screen.

use slipline_plate::calibrate::Comparison;
use slipline_plate::quantity::ticks;

/// Whether a text has the form of a measurement: the head of its table, or the place of a sensor above it.
#[must_use]
pub fn is_measurement(text: &str) -> bool {
    // A spreadsheet may have put it in quotation marks.
    text.lines().take(100).map(|line| line.trim().trim_matches('"')).any(|line| {
        let field = line.strip_prefix('#').and_then(|field| field.split_once('='));
        field.is_some_and(|(name, _)| matches!(name.trim(), "place_m" | "sensor"))
            || line.starts_with("frequency_hz")
    })
}

/// The agreement of a measurement with the compared plate, as a sentence; and whether it differs.
#[must_use]
pub fn differs(comparison: &Comparison) -> (bool, String) {
    if comparison.count == 0 {
        let text = "At none of these frequencies a wave enters this plate: is it the right plate file?";
        return (true, text.to_owned());
    }
    let (off, allowed) =
        (ticks::label(comparison.usual_db, 0.1), ticks::label(comparison.allowed_db.max(0.1), 0.1));
    if comparison.is_other_plate() {
        let text = format!(
            "Measured differs: half of the answers are more than {off} dB off this plate's model, and noise explains \
             {allowed} dB. Calibrate the plate, or check the sensor's place and the plate file."
        );
        return (true, text);
    }
    let text = format!(
        "The plate's model fits: half of the answers are within {off} dB of it. Only levels are compared: phases hold the \
         unknown delay of sensor and amplifier."
    );
    (false, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison(count: usize, usual_db: f64, chi2_per_n: f64) -> Comparison {
        Comparison {
            predicted: Vec::new(),
            off_db: Vec::new(),
            level_db: 0.0,
            count,
            usual_db,
            allowed_db: 0.02,
            chi2_per_n,
        }
    }

    #[test]
    fn only_what_noise_does_not_explain_is_said_to_differ() {
        let (is_off, text) = differs(&comparison(60, 3.12, 40.0));
        assert!(is_off && text.starts_with("Measured differs: half of the answers are more than 3.1 dB off"));
        assert!(text.contains("noise explains 0.1 dB. Calibrate"), "{text}");
        let (is_off, text) = differs(&comparison(60, 0.3, 2.0));
        assert!(
            !is_off
                && text.starts_with("The plate's model fits: half of the answers are within 0.3 dB of it.")
        );
        assert!(text.contains("Only levels are compared"), "{text}");
        let (is_off, text) = differs(&comparison(0, 0.0, 0.0));
        assert!(is_off && text.contains("right plate file"), "{text}");
    }

    #[test]
    fn a_measurement_is_known_by_its_head_and_other_tables_are_not_taken_for_one() {
        assert!(is_measurement("# place_m = 0.03\n# sensor = velocity\nfrequency_hz,re,im,noise\n"));
        assert!(is_measurement("\n  frequency_hz;re;im;noise\n") && is_measurement("#sensor=speed\n"));
        assert!(is_measurement("\"# place_m = 0.03\",,,\n") && is_measurement("\"frequency_hz\",\"re\"\n"));
        for other in ["0,0.3\n0.1,1\n", "time_s,slot,place_m\n0,0,0.1\n", "# a comment\n", ""] {
            assert!(!is_measurement(other), "{other}");
        }
    }
}
