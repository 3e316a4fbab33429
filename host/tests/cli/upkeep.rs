//! A board whose brown-out level is not set, and the wear of its flash.

use super::served::Served;
use super::{failure, json, slipline};
use slipline_link::simulator::Options;

#[test]
fn a_board_without_a_brown_out_level_is_armed_only_if_the_user_says_that_he_knows_it() {
    let served = Served::new("unguarded.sock", Options { brown_out_guarded: false, ..Options::default() });
    let drive =
        ["drive", "--port", &served.port, "--plate", "membrane", "--turning-point", "120mm", "--for", "50ms"];
    let verify = ["verify", "--port", &served.port];
    for command in [&drive[..], &verify[..]] {
        let message = failure(command, 1);
        assert!(message.contains("brown-out level of this board is not set"), "{message}");
        assert!(message.contains("add --despite-brown-out-level"), "{message}");
    }
    let driven = json(&[&drive[..], &["--despite-brown-out-level"]].concat());
    assert!(driven["driven_s"].as_f64().unwrap() > 0.0, "{driven}");

    assert_eq!(json(&["info", "--port", &served.port])["brown_out_guarded"], false);
    let output = slipline(&["info", "--port", &served.port]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("Warning") && text.contains("firmware/BOARDS.md"), "{text}");
}

#[test]
fn info_reports_the_wear_of_the_flash() {
    let served = Served::new("wear.sock", Options::default());
    let info = json(&["info", "--port", &served.port]);
    assert_eq!((&info["flash_erasures"], &info["flash_erasures_promised"]), (&0.into(), &20_000.into()));
    assert_eq!(info["brown_out_guarded"], true);
    let output = slipline(&["info", "--port", &served.port]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("0 of 20000 times") && !text.contains("Warning"), "{text}");
}
