//! The self-test of a board: its page, its report, and the judgement of a report.

use super::{file, refused, said, says, slipline};
use serde_json::{Value, json};

/// A report of the simulated device with both wires. Its clock is this computer's, which other tests may hold up, so its step
/// may be red.
fn report(name: &str) -> (Value, String) {
    let path = file(name).display().to_string();
    let wires = ["selftest", "--port", "sim", "--wire", "dac=sensor", "--wire", "trigger=trigger-in"];
    let page = said(&[&wires[..], &["--short", "--force", "--out", &path]].concat());
    says(
        &page,
        &[
            "Board simulated, unit 73696d756c617465642d3030",
            "green    supply ",
            "VREF+: 3.3 V  (allowed: 2.9 V to 3.4 V)",
        ],
    );
    says(&page, &["Not shown:", "skipped  bootloader"]);
    let line = page.lines().last().unwrap();
    assert!(
        line.starts_with("SELFTEST ") && line.contains(" unit=73696d756c617465642d3030 build="),
        "{line}"
    );
    (serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap(), path)
}

fn step<'a>(report: &'a mut Value, name: &str) -> &'a mut Value {
    report["steps"].as_array_mut().unwrap().iter_mut().find(|step| step["name"] == name).unwrap()
}

#[test]
fn a_report_is_judged_offline_by_the_limits_of_the_program() {
    let (mut report, path) = report("report.json");
    assert_eq!(report["wires"], json!(["dac=sensor", "trigger=trigger-in"]));
    assert_eq!(report["short"], true);
    for wired in ["DAC to ADC", "delay", "noise", "trigger", "codes", "load", "supply", "mute"] {
        let step = step(&mut report, wired);
        assert_eq!(step["verdict"], "green", "{step}");
    }
    assert_eq!(step(&mut report, "mute time")["verdict"], "skipped");
    // The time of a busy computer does not matter here.
    for timed in ["clocks", "link"] {
        let step = step(&mut report, timed);
        (step["verdict"], step["readings"][0]["value"]) = (json!("green"), json!(0.5));
    }
    let judged = |report: &Value| {
        std::fs::write(&path, report.to_string()).unwrap();
        let output = slipline(&["selftest", "--judge", &path, "--json"]);
        let judged: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), judged)
    };
    let (code, good) = judged(&report);
    assert_eq!((code, &good["passed"], &good["date"]), (Some(0), &json!(true), &report["date"]));
    assert_eq!(good["steps"], report["steps"]);
    // A value moved past its limit, which the file hides.
    let reading = &mut step(&mut report, "supply")["readings"][0];
    (reading["value"], reading["at_least"]) = (json!(2.7), Value::Null);
    let (code, mut bad) = judged(&report);
    assert_eq!((code, &bad["passed"]), (Some(3), &json!(false)));
    let supply = step(&mut bad, "supply");
    assert_eq!(supply["verdict"], "red");
    says(supply["sentence"].as_str().unwrap(), &["VREF+ is 2.7 V, allowed: 2.9 V to 3.4 V."]);
    refused(&["selftest", "--judge", &path], 3, &["1 of 18 steps is red"]);
}

#[test]
fn a_broken_report_is_refused_with_its_field() {
    let (good, path) = report("broken.json");
    let refuses = |text: &str, wanted: &[&str]| {
        std::fs::write(&path, text).unwrap();
        refused(&["selftest", "--judge", &path], 2, wanted);
    };
    refuses("{", &["broken.json: it is not JSON"]);
    refuses("[]", &["the report: must be an object"]);
    for (place, value, wanted) in [
        ("/schema", json!(0), "schema = 0: must be 1, that of this version"),
        ("/unit", json!(7), "unit: must be a text"),
        ("/simulated", json!("no"), "simulated: must be true or false"),
        ("/steps", json!({}), "steps: must be a list of up to 18 entries"),
        ("/steps", json!([]), "steps has no step \"clocks\""),
        ("/steps/1/name", json!("suply"), "steps[1].name = \"suply\": must be \"supply\""),
        (
            "/steps/1/verdict",
            json!("blue"),
            "steps[1].verdict = \"blue\": must be skipped, green, amber or red",
        ),
        ("/steps/1/readings/0/value", json!("3.3"), "steps[1].readings[0].value: must be a number"),
        ("/steps/1/readings/0/at_most", json!("3.4"), "steps[1].readings[0].at_most: must be a number"),
        (
            "/steps/1/readings/0/quantity",
            json!("VREF+ "),
            "steps[1].readings[0].quantity = \"VREF+ \": must be VREF+, brown-out level unset",
        ),
        (
            "/steps/1/readings/0/value_unit",
            json!("mV"),
            "steps[1].readings[0].value_unit = \"mV\": must be \"V\"",
        ),
        (
            "/steps/10/readings/2/value",
            json!(-1),
            "steps[10].readings[2].value = -1: must be a whole number from 0",
        ),
        ("/steps/7/readings/0/value", json!(0.5), "steps[7].readings[0].value = 0.5: must be a whole number"),
        ("/wires", json!(["dac"]), "wires[0]: must be dac=sensor or trigger=trigger-in"),
        ("/short", json!(1), "short: must be true or false"),
        ("/steps/1/verdict", json!("skipped"), "steps[1].readings: must be empty in a skipped step"),
        (
            "/unit",
            json!("1\nSELFTEST PASS"),
            "unit: must be a text of up to 1000 letters without control characters",
        ),
        ("/steps/1/readings", json!([]), "steps[1].readings has no number by which the step is green"),
        ("/unit", json!(""), "unit: must be a text that is not empty"),
        ("/unit", json!("7\u{202e}8"), "unit: must be a text of up to 1000 letters"),
        ("/image_sha256", json!("12"), "image_sha256: must be 64 hexadecimal digits or null"),
        // Parts that no test can give together.
        (
            "/wires",
            json!(["dac=sensor", "dac=sensor"]),
            "wires[1]: must be another wire than those before it",
        ),
        (
            "/wires",
            json!(["dac=sensor"]),
            "wires: must be a list with trigger=trigger-in, by which the step trigger",
        ),
        ("/codes_crc", Value::Null, "codes_crc: must be eight hexadecimal digits where codes were compared"),
        ("/codes_crc", json!("12345"), "codes_crc: must be eight hexadecimal digits"),
        ("/steps/15/verdict", json!("red"), "steps[15].verdict: must be skipped in a short test"),
        (
            "/short",
            json!(false),
            "steps[0].readings has \"rate error in a short time\": must be \"rate error\" in this test",
        ),
    ] {
        let mut broken = good.clone();
        *broken.pointer_mut(place).unwrap() = value;
        refuses(&broken.to_string(), &[wanted]);
    }
    // A step without its first number.
    let mut broken = good.clone();
    broken["steps"][1]["readings"].as_array_mut().unwrap().remove(0);
    refuses(&broken.to_string(), &["steps[1].readings has no \"VREF+\", by which the step is green"]);
    for (at, quantity) in [
        (2, "resistor missing"),
        (2, "pin high while muted"),
        (1, "brown-out level unset"),
        (10, "reopenings without answer"),
    ] {
        let mut broken = good.clone();
        broken["steps"][at]["readings"]
            .as_array_mut()
            .unwrap()
            .retain(|reading| reading["quantity"] != quantity);
        refuses(&broken.to_string(), &[&format!("steps[{at}].readings has no {quantity:?}, by which")]);
    }
    let mut broken = good;
    broken.as_object_mut().unwrap().remove("board");
    refuses(&broken.to_string(), &["board is missing"]);
}

#[test]
fn bad_usage_of_a_selftest_names_what_is_allowed() {
    refused(&["selftest", "--wire", "dac=shunt"], 2, &["dac=shunt", "dac=sensor or trigger=trigger-in"]);
    for option in ["--ask", "--force", "--despite-brown-out-level", "--actual-amplifier=10kHz"] {
        refused(
            &["selftest", "--judge", "report.json", option],
            2,
            &["--judge", option.split('=').next().unwrap()],
        );
    }
    refused(&["selftest", "--actual-plate", "membrane"], 2, &["--actual-plate"]);
    refused(&["selftest", "--port", "/dev/ttyNone"], 1, &["/dev/ttyNone"]);
    refused(&["selftest", "--judge", "no-report.json"], 2, &["no-report.json"]);
    refused(&["selftest", "--amplifier", "--amplifier-unplugged"], 2, &["--amplifier"]);
    refused(&["selftest", "--amplifier", "--wire", "dac=sensor"], 2, &["--amplifier", "--wire"]);
}

#[test]
fn the_amplifier_is_tested_by_itself() {
    // The clocks of a busy computer do not matter here.
    let output = slipline(&["selftest", "--port", "sim", "--amplifier", "--json"]);
    let mut report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(step(&mut report, "mute")["verdict"], "green");
    let amplifier = step(&mut report, "amplifier");
    assert_eq!(amplifier["verdict"], "green", "{amplifier}");
    assert!(amplifier["readings"][1]["value"].as_f64().unwrap() > 20.0, "{amplifier}");
    assert_eq!(step(&mut report, "load")["verdict"], "skipped");
}

#[test]
fn a_report_that_would_be_the_trace_is_refused_before_anything_is_driven() {
    let path = file("report-and-trace.json");
    let path = path.to_str().unwrap();
    let (folder, name) = path.rsplit_once('/').unwrap();
    let other = format!("{folder}/./{name}");
    for out in [path, other.as_str()] {
        let command = ["selftest", "--port", "sim", "--force", "--trace", path, "--out", out];
        refused(&command, 2, &["is the file of --trace: name another file"]);
        assert_eq!(std::fs::read_to_string(path).unwrap(), "", "no frame went to a device");
    }
    std::fs::remove_file(path).unwrap();
}

#[cfg(unix)]
#[test]
fn a_selftest_that_a_signal_ends_leaves_the_board_disarmed() {
    use super::served::Served;
    use slipline_link::simulator::Options;
    use std::time::{Duration, Instant};

    for (sent, name) in [("-INT", "interrupted.sock"), ("-KILL", "killed.sock")] {
        let served = Served::new(name, Options::default());
        let mut child = super::piped(["selftest", "--port", &served.port]);
        std::thread::sleep(Duration::from_secs(1));
        super::signal(child.id(), sent);
        assert!(!child.wait().unwrap().success(), "{sent}");
        // After a kill the dead-man disarms it, within a second of the device's time.
        let limit = Instant::now() + Duration::from_secs(60);
        loop {
            let info = super::json(&["info", "--port", &served.port]);
            if info["state"] == "Idle" || info["state"] == "Fault" {
                break;
            }
            assert!(Instant::now() < limit, "{sent}: {info}");
        }
    }
}
