//! `slipline board`: the brown-out level, shown, asked about, and written with a hand on the board; latched faults cleared.

use super::served::Served;
use super::{failure, json, piped, refused, slipline};
use slipline_link::protocol::board::Analogue;
use slipline_link::simulator::Options;
use std::io::{BufRead as _, BufReader};

fn delivered(name: &str) -> Served {
    Served::new(name, Options { brown_out_guarded: false, ..Options::default() })
}

#[test]
fn the_level_is_written_once_with_the_button_and_compared_after_the_restart() {
    let served = delivered("brown-out.sock");
    let show = ["board", "brown-out", "--port", &served.port];
    let set = [&show[..], &["--set", "--power-is-safe"]].concat();
    let before = json(&show);
    assert_eq!((&before["brown_out_guarded"], &before["brown_out_level"]), (&false.into(), &0.into()));
    let message = failure(&set, 1);
    assert!(message.contains("hold the user button on the board"), "{message}");
    served.device.lock().unwrap().press_button(true);
    let written = json(&set);
    served.device.lock().unwrap().press_button(false);
    assert_eq!((&written["written"], &written["brown_out_guarded"]), (&true.into(), &true.into()));
    assert_eq!(json(&["info", "--port", &served.port])["brown_out_guarded"], true);
    let again = json(&set);
    assert_eq!((&again["written"], &again["option_bytes"]), (&false.into(), &written["option_bytes"]));
    let text = String::from_utf8(slipline(&show).stdout).unwrap();
    assert_eq!(text, "The brown-out level is 2: set. The board needs 2.\n");
}

#[test]
fn without_a_terminal_the_question_needs_its_flag_and_names_the_risk() {
    let served = delivered("brown-out-asked.sock");
    served.device.lock().unwrap().press_button(true);
    let set = ["board", "brown-out", "--set", "--port", &served.port];
    refused(&set, 2, &["its whole flash", "add --power-is-safe"]);
    refused(&["board", "brown-out", "--power-is-safe", "--port", "sim"], 2, &["--set"]);
    assert_eq!(json(&["board", "brown-out", "--port", &served.port])["brown_out_guarded"], false);
}

#[test]
fn a_supply_that_is_too_low_is_named_with_its_range() {
    let analogue = Analogue { reference_mv: 2850, ..Options::default().analogue };
    let options = Options { brown_out_guarded: false, analogue, ..Options::default() };
    let served = Served::new("brown-out-low.sock", options);
    served.device.lock().unwrap().press_button(true);
    let message = failure(&["board", "brown-out", "--set", "--power-is-safe", "--port", &served.port], 1);
    assert!(message.contains("reference voltage VREF+ (mV) is 2850; allowed are 2900 to 65535"), "{message}");
}

#[test]
fn latched_faults_are_cleared_by_one_command_that_arms_nothing() {
    let served = Served::new("clear-faults.sock", Options::default());
    let drive =
        ["drive", "--plate", "membrane", "--turning-point", "120mm", "--for", "60s", "--port", &served.port];
    let mut drive = piped(drive);
    let told = BufReader::new(drive.stdout.take().unwrap()).lines().map(Result::unwrap);
    assert!(told.into_iter().any(|line| line.starts_with("Driving for")));
    // The program dies, and the device stops by itself: its time passes while nobody says hello.
    drive.kill().unwrap();
    drive.wait().unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    let clear = ["board", "clear-faults", "--port", &served.port];
    let message = failure(&["selftest", "--short", "--port", &served.port], 1);
    assert!(message.contains("`slipline board clear-faults`"), "{message}");
    assert_eq!(json(&clear)["port"], served.port.as_str());
    let text = String::from_utf8(slipline(&clear).stdout).unwrap();
    assert_eq!(text, "The device has no latched fault.\n");
}
