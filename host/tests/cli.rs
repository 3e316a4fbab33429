//! The command line as other programs use it: JSON fields, exit codes, and what it says of bad input.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn slipline(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_slipline")).args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = slipline(&[arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{arguments:?}: {error}"))
}

/// The message of a command that must fail with this code.
fn failure(arguments: &[&str], code: i32) -> String {
    let output = slipline(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(!message.contains("panicked"), "{arguments:?}: {message}");
    message
}

fn number(value: &Value, field: &str) -> f64 {
    value[field].as_f64().unwrap_or_else(|| panic!("{field} is {:?}", value[field]))
}

/// A file of this test's own.
fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{}-{name}", std::process::id()))
}

#[test]
fn presets_are_named_and_described() {
    let presets = json(&["presets"]);
    let presets = presets.as_array().unwrap();
    assert!(presets.len() >= 5);
    for preset in presets {
        assert!(!preset["name"].as_str().unwrap().is_empty());
        assert!(preset["description"].as_str().unwrap().len() > 20);
    }
    assert_eq!(presets[0]["name"], "membrane");
}

#[test]
fn the_simulated_plate_heads_the_ports() {
    let ports = json(&["ports"]);
    assert_eq!(ports[0]["port"], "sim");
    assert_eq!(ports[0]["is_ours"], true);
}

#[test]
fn info_tells_who_the_simulated_device_is() {
    let info = json(&["info", "--port", "sim"]);
    assert_eq!(info["simulated"], true);
    assert_eq!(number(&info, "sample_rate_hz"), 400_000.0);
    assert_eq!(number(&info, "tones"), 16.0);
    assert_eq!(info["protocol"], "1.0");
}

#[test]
fn respond_gives_the_amplitude_over_x_and_the_turning_point() {
    // The rubber rig: x0 = 39.5 and 101.7 mm at 30 and 40 Hz.
    for (frequency, turning_point_m) in [("30Hz", 0.0395), ("40Hz", 0.1017)] {
        let response = json(&["respond", "--plate", "paper-rubber", "--freq", frequency, "--points", "500"]);
        assert_eq!(response["position_m"].as_array().unwrap().len(), 500);
        let amplitude = response["amplitude"].as_array().unwrap();
        assert_eq!(amplitude.len(), 500);
        assert!((number(&response, "turning_point_m") - turning_point_m).abs() < 1e-4);
        assert!(number(&response, "edge_width_m") > 0.01);
        // Driven by displacement: the end moves as the drive does.
        assert!((number(&amplitude[0], "re").hypot(number(&amplitude[0], "im")) - 1.0).abs() < 1e-6);
    }
    let paper = json(&["respond", "--plate", "al-bending", "--freq", "40kHz", "--paper-mode"]);
    let ours = json(&["respond", "--plate", "al-bending", "--freq", "40kHz"]);
    assert_ne!(paper["amplitude"][100], ours["amplitude"][100]);
    assert!((number(&ours, "peak_position_m") - number(&ours, "turning_point_m")).abs() < 0.02);
}

#[test]
fn table_gives_span_and_knots_and_writes_them() {
    let path = file("table.json");
    let arguments =
        ["table", "--plate", "membrane", "--sample-rate", "200kHz", "--out", path.to_str().unwrap()];
    let table = json(&arguments);
    assert_eq!(serde_json::from_slice::<Value>(&std::fs::read(&path).unwrap()).unwrap(), table);
    std::fs::remove_file(path).unwrap();
    assert!((number(&table, "span_start_m") - 0.08).abs() < 1e-9);
    assert!((number(&table, "span_end_m") - 0.28).abs() < 1e-9);
    let knots = table["knots"].as_array().unwrap();
    assert_eq!(knots.len(), 1025);
    let frequencies: Vec<f64> = knots.iter().map(|knot| number(knot, "frequency_hz")).collect();
    assert!(frequencies.windows(2).all(|pair| pair[1] > pair[0]));
    assert!(knots.iter().all(|knot| (0.0..=1.0).contains(&number(knot, "gain"))));
    assert!(number(&table, "sensitivity_db_per_percent") < 1.0);
}

#[test]
fn simulate_reports_what_was_commanded_and_what_was_measured() {
    let (csv, png) = (file("envelope.csv"), file("envelope.png"));
    let run = json(&[
        "simulate",
        "--plate",
        "membrane",
        "--boundary",
        "120mm",
        "--csv",
        csv.to_str().unwrap(),
        "--png",
        png.to_str().unwrap(),
    ]);
    assert!((number(&run, "turning_point_m") - 0.12).abs() < 1e-4);
    assert!((number(&run, "frequency_hz") - 104.0).abs() < 1.0);
    assert_eq!(run["peak_present"], true);
    assert_eq!(number(&run, "clipped_samples"), 0.0);
    let off_m = number(&run, "measured_peak_position_m") - number(&run, "peak_position_m");
    assert!(off_m.abs() < number(&run, "edge_width_m") / 20.0);
    assert!(number(&run, "measured_peak_amplitude_m") > 1e-6);
    assert!(run.get("tones").is_none());

    let text = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(text.lines().next(), Some("position_m,predicted_rms_m,measured_rms_m,measured_maximum_m"));
    assert_eq!(text.lines().count(), 514);
    assert_eq!(&std::fs::read(&png).unwrap()[1..4], b"PNG");
    for path in [csv, png] {
        std::fs::remove_file(path).unwrap();
    }
}

#[test]
fn simulate_lists_several_tones_and_runs_on_another_plate() {
    let run = json(&[
        "simulate",
        "--plate",
        "membrane",
        "--tone",
        "100mm:0,3",
        "--tone",
        "220mm:0.3",
        "--tone",
        "160mm:0.2",
    ]);
    let tones = run["tones"].as_array().unwrap();
    assert_eq!(tones.len(), 3);
    assert_eq!(tones[0]["frequency_hz"], run["frequency_hz"]);
    for (tone, boundary_m) in tones.iter().zip([0.1, 0.22, 0.16]) {
        assert!((number(tone, "turning_point_m") - boundary_m).abs() < 1e-4);
        let off_m = number(tone, "measured_peak_position_m") - number(tone, "peak_position_m");
        assert!(off_m.abs() < number(tone, "edge_width_m") / 20.0);
    }

    // A membrane under a tenth more tension than the table thinks.
    let toml = slipline_plate::preset("membrane").unwrap().with_wave_speed(1.05).unwrap().to_toml();
    let path = file("tense.toml");
    std::fs::write(&path, toml).unwrap();
    let tense = path.to_str().unwrap();
    let run = json(&["simulate", "--plate", "membrane", "--actual-plate", tense, "--boundary", "160mm"]);
    std::fs::remove_file(&path).unwrap();
    assert!((number(&run, "commanded_boundary_m") - 0.16).abs() < 1e-9);
    // ln(1.05) / d = 10.6 mm nearer.
    assert!((number(&run, "turning_point_m") - 0.1494).abs() < 1e-4);
    assert!(number(&run, "sensitivity_db") > 0.1);
}

#[test]
fn a_plate_that_a_tones_frequency_cannot_enter_is_named_with_few_digits() {
    let message = failure(
        &["simulate", "--plate", "membrane", "--actual-plate", "al-bending", "--boundary", "120mm"],
        2,
    );
    assert!(
        message.contains("frequency = 104.453 Hz cannot enter the plate \"al-bending\": must be above"),
        "{message}"
    );
}

#[test]
fn a_design_ends_with_0_though_lights_are_red_and_its_help_says_so() {
    let designed = json(&[
        "design",
        "--material",
        "acrylic",
        "--thickness",
        "2mm",
        "--band",
        "2kHz..8kHz",
        "--length",
        "1m",
    ]);
    let lights = designed["lights"]["lights"].as_array().unwrap();
    assert!(lights.iter().any(|light| light["colour"] == "red"), "{lights:?}");
    assert!(designed["mounting"].as_str().unwrap().contains("Cut the frame twice"));
    let help = String::from_utf8(slipline(&["design", "--help"]).stdout).unwrap();
    assert!(
        help.split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains("0 designed, also where lights are red"),
        "{help}"
    );
}

#[test]
fn no_table_leaves_the_gains_out() {
    let with = json(&["simulate", "--plate", "al-bending", "--boundary", "250mm"]);
    let without = json(&["simulate", "--plate", "al-bending", "--boundary", "250mm", "--no-table"]);
    assert!(number(&without, "measured_peak_amplitude_m") > number(&with, "measured_peak_amplitude_m"));
}

#[test]
fn drive_and_verify_work_on_the_simulated_device() {
    let driven =
        json(&["drive", "--port", "sim", "--plate", "membrane", "--boundary", "126Hz", "--for", "200ms"]);
    assert!((number(&driven["tones"][0], "frequency_hz") - 126.0).abs() < 0.1);
    assert!(number(&driven, "stopped_at_samples") > number(&driven, "at_samples"));
    let verified = json(&["verify", "--port", "sim", "--window", "30ms"]);
    assert_eq!(verified["equal"], true);
    assert_eq!(verified["windows"].as_array().unwrap().len(), 4);
}

#[test]
fn record_writes_the_codes_of_the_drive() {
    let path = file("drive.wav");
    let wav = path.to_str().unwrap();
    json(&["record", "--plate", "membrane", "--boundary", "120mm", "--seconds", "100ms", "--wav", wav]);
    let mut reader = hound::WavReader::open(&path).unwrap();
    assert_eq!(reader.spec().sample_rate, 400_000);
    let samples: Vec<i16> = reader.samples().map(Result::unwrap).collect();
    std::fs::remove_file(path).unwrap();
    assert_eq!(samples.len(), 40_000);
    // 104.5 Hz for 0.1 s: ten periods, so about twenty passages through zero.
    let passages = samples.windows(2).filter(|pair| (pair[0] < 0) != (pair[1] < 0)).count();
    assert!((19..=23).contains(&passages), "{passages}");
    assert!(samples.iter().any(|sample| sample.abs() > 1000));
}

#[test]
fn bad_usage_ends_with_2_and_names_field_and_range() {
    for (arguments, words) in [
        (&["simulate", "--plate", "membrane"][..], &["--boundary"][..]),
        (
            &["simulate", "--plate", "membrane", "--boundary", "900mm"],
            &["'900mm' for '--boundary'", "80 to 280 mm"],
        ),
        (
            &["simulate", "--plate", "membrane", "--boundary", "nan"],
            &["'nan' for '--boundary'", "80 to 280 mm, or 86.83 to 218.7 Hz"],
        ),
        (&["simulate", "--plate", "membrane", "--boundary", "5kHz"], &["86.83 to 218.7 Hz"]),
        (&["simulate", "--plate", "membrane", "--boundary", "120mm", "--level", "1.2"], &["level", "0 to 1"]),
        (
            &["simulate", "--plate", "membrane", "--boundary", "120mm", "--seconds", "9999s"],
            &["'9999s' for '--seconds", "10 ms to 600 s"],
        ),
        (&["simulate", "--plate", "membrane", "--tone", "90mm"], &["90mm:0.5"]),
        (
            &["respond", "--plate", "membrane", "--freq", "2Hz"],
            &["'2Hz' for '--freq'", "60.01 Hz to 1.052 kHz"],
        ),
        (&["respond", "--plate", "membrane", "--freq", "120Hz", "--points", "1"], &["points"]),
        (&["respond", "--plate", "membrane", "--freq", "12 parsec"], &["Hz, kHz or MHz"]),
        (&["table", "--plate", "membrane", "--knots", "1026"], &["1025"]),
        (
            &["table", "--plate", "al-bending", "--sample-rate", "20kHz"],
            &["--sample-rate", "88.66 kHz to 100 MHz"],
        ),
        (&["table", "--plate", "no-such-plate"], &["no-such-plate", "membrane"]),
        (
            &["simulate", "--plate", "membrane", "--boundary", "1e400mm"],
            &["'1e400mm' for '--boundary'", "80 to 280 mm"],
        ),
        (
            &["simulate", "--plate", "membrane", "--boundary", "-5mm"],
            &["'-5mm' for '--boundary'", "80 to 280 mm"],
        ),
        (&["simulate", "--plate", "membrane", "--tone", "9mm:0.5"], &["'9mm' for '--tone'", "80 to 280 mm"]),
        (
            &["simulate", "--plate", "membrane", "--boundary", "120mm", "--level", "nan"],
            &["--level", "nan", "0 to 1"],
        ),
        (
            &["simulate", "--plate", "membrane", "--boundary", "120mm", "--level", "-1"],
            &["--level", "-1", "0 to 1"],
        ),
        (&["drive", "--port", "sim", "--plate", "membrane", "--for", "-1s"], &["--for", "-1s", "0 to 600 s"]),
        (
            &["drive", "--port", "sim", "--plate", "membrane", "--glide", "1e400s"],
            &["--glide", "5 ms to 10 s"],
        ),
        (
            &["respond", "--plate", "membrane", "--freq", "0Hz"],
            &["'0Hz' for '--freq'", "60.01 Hz to 1.052 kHz"],
        ),
        (
            &["respond", "--plate", "membrane", "--freq", "nan"],
            &["'nan' for '--freq'", "60.01 Hz to 1.052 kHz"],
        ),
        (&["table", "--plate", "membrane", "--knots", "-1"], &["--knots", "whole number, 2 to 1025"]),
        (&["table", "--plate", "mebrane"], &["did you mean membrane?"]),
        (&["verify", "--port", "sim", "--window", "9s"], &["'9s' for '--window'", "10 ms to 2.621 s"]),
        (
            &["simulate", "--plate", "membrane", "--boundary", "120mm", "--csv", "x", "--png", "./x"],
            &["--csv", "--png"],
        ),
        (&["info", "--port", "unix:"], &["unix:PATH"]),
        (&["info"], &["--port"]),
        (&["frobnicate"], &["frobnicate"]),
        (&["verify", "--port", "sim", "--tones", "17"], &["1 to 16"]),
    ] {
        let message = failure(arguments, 2);
        for word in words {
            assert!(message.contains(word), "{arguments:?} does not say {word:?}: {message}");
        }
    }
}

#[test]
fn tones_that_add_up_to_too_much_are_bad_usage_in_the_devices_words() {
    let tones = ["--plate", "membrane", "--boundary", "120mm", "--tone", "200mm:1"];
    let wav = file("loud.wav");
    for command in [
        &["drive", "--port", "sim", "--for", "100ms"][..],
        &["simulate"],
        &["simulate", "--no-table"],
        &["record", "--seconds", "10ms", "--wav", wav.to_str().unwrap()],
    ] {
        let message = failure(&[command, &tones].concat(), 2);
        assert!(message.contains("% of full scale; lower their levels"), "{command:?}: {message}");
    }
    assert!(!wav.exists());
}

#[test]
fn what_cannot_be_done_ends_with_1_and_says_why() {
    let message = failure(&["info", "--port", "no-such-port"], 1);
    assert!(message.contains("no-such-port"), "{message}");
    let arguments =
        ["record", "--plate", "membrane", "--boundary", "120mm", "--wav", "no/such/folder/drive.wav"];
    assert!(failure(&arguments, 1).contains("no/such/folder/drive.wav"));
}

#[test]
fn a_hostile_plate_file_is_refused_with_its_name_and_the_reason() {
    //
    let good = slipline_plate::preset("membrane").unwrap().to_toml();
    let with = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1).into_bytes()
    };
    let cases: [(&str, Vec<u8>, &[&str]); 12] = [
        ("huge", vec![b'#'; 3 << 20], &["too big", "1048576"]),
        ("text", with("length_m = ", "length_m = \"long\" # "), &["line 3", "length_m", "0.005 to 10 m"]),
        ("overflow", with("loss_factor = ", "loss_factor = 1e999 # "), &["line", "1e999", "0 to 0.5"]),
        ("section", with("[taper]", "[tapper]"), &["did you mean [taper]?"]),
        ("binary", vec![0xff, 0xfe, 0, 1], &["UTF-8"]),
        ("empty", Vec::new(), &["name is missing", "1 to 80"]),
        ("nan", with("length_m = ", "length_m = nan # "), &["length_m"]),
        ("infinite", with("loss_factor = ", "loss_factor = inf # "), &["loss_factor"]),
        ("negative", with("half_width_m = ", "half_width_m = -1.0 # "), &["half_width_m"]),
        ("unknown", with("length_m = ", "colour = \"red\"\nlength_m = "), &["colour", "line"]),
        ("nested", "[".repeat(100_000).into_bytes(), &["line 1"]),
        ("broken", with("length_m = ", "length_m == "), &["line"]),
    ];
    for (name, bytes, words) in cases {
        let path = file(&format!("{name}.toml"));
        std::fs::write(&path, bytes).unwrap();
        let message = failure(&["table", "--plate", path.to_str().unwrap()], 2);
        std::fs::remove_file(&path).unwrap();
        for word in words.iter().chain([&name]) {
            assert!(message.contains(word), "{name} does not say {word:?}: {message}");
        }
    }
    assert!(failure(&["table", "--plate", env!("CARGO_TARGET_TMPDIR")], 2).contains("directory"));
}

/// A design of the aluminium plate of the examples, with more options.
fn design(more: &[&str]) -> Output {
    let aluminium = "design --material aluminium --thickness 2mm --band 20kHz..40kHz --length 300mm";
    slipline(&aluminium.split(' ').chain(more.iter().copied()).collect::<Vec<_>>())
}

#[test]
fn what_a_design_is_asked_for_is_refused_by_its_option_and_in_its_unit() {
    for (more, words) in [
        (&["--start-margin", "400mm"][..], &["'400mm' for '--start-margin'", "300 µm to 270 mm"][..]),
        (&["--tension", "-5N/m"], &["'-5N/m' for '--tension'", "0.054 to 2.16e9 N/m"]),
        (&["--wave-speed", "1e9m/s"], &["--wave-speed", "0.1 to 20000 m/s"]),
        (&["--rim", "0"], &["--rim", "10 to 500 mm"]),
        (&["--loss", "nan"], &["--loss", "nan", "0 to 0.5"]),
        (&["--full-scale", "1m"], &["--full-scale", "1 nm to 100 mm"]),
        (&["--name", ""], &["--name", "1 to 80 characters"]),
    ] {
        let output = design(more);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{more:?}: {message}");
        for word in words {
            assert!(message.contains(word), "{more:?} does not say {word:?}: {message}");
        }
    }
}

#[test]
fn small_values_of_a_design_keep_their_digits() {
    let thin = "design --material latex --thickness 1um --band 80Hz..220Hz --length 30cm --tension 0.02N/m";
    let output = slipline(&thin.split(' ').collect::<Vec<_>>());
    let text = String::from_utf8(output.stdout).unwrap();
    for wanted in
        ["R = 58.73 µN s/m matches", "20.00 mN/m of width", "9.400 mm at the narrow end", "up to 0.0466\n"]
    {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
}

#[test]
fn a_file_that_is_there_is_replaced_only_when_asked() {
    let folder = file("kept");
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (json, csv, png, wav, own) = (path("t.json"), path("e.csv"), path("e.png"), path("d.wav"), path(""));
    let simulate = ["simulate", "--plate", "membrane", "--boundary", "120mm"];
    let record = ["record", "--plate", "membrane", "--boundary", "120mm", "--seconds", "1ms", "--wav", &wav];
    let commands: [(Vec<&str>, &str); 4] = [
        (vec!["table", "--plate", "membrane", "--knots", "5", "--out", &json], "t.json"),
        ([&simulate[..], &["--csv", &csv]].concat(), "e.csv"),
        ([&simulate[..], &["--png", &png]].concat(), "e.png"),
        (record.to_vec(), "d.wav"),
    ];
    for (arguments, name) in &commands {
        std::fs::write(folder.join(name), "mine").unwrap();
        let message = failure(arguments, 2);
        assert!(message.contains(name) && message.contains("--force"), "{message}");
        assert_eq!(std::fs::read(folder.join(name)).unwrap(), b"mine", "{name}");
        let output = slipline(&[&arguments[..], &["--force"]].concat());
        assert_eq!(output.status.code(), Some(0), "{name}");
        assert_ne!(std::fs::read(folder.join(name)).unwrap(), b"mine", "{name}");
    }
    // A folder's own files are kept alike, all or none of them.
    std::fs::write(folder.join("plate.toml"), "mine").unwrap();
    let output = design(&["--out", &own]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("holds plate.toml already") && message.contains("--force"), "{message}");
    assert!(!folder.join("frame.dxf").exists());
    assert_eq!(design(&["--out", &own, "--force"]).status.code(), Some(0));
    assert!(std::fs::read_to_string(folder.join("plate.toml")).unwrap().starts_with("name"));
    std::fs::write(folder.join("fig03.csv"), "mine").unwrap();
    assert!(failure(&["figures", "--out", &own], 2).contains("holds fig03.csv already"));
    let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().ends_with(".part")), "{left:?}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// A long recording over a file that is there, ended by a signal once it is being written.
#[cfg(unix)]
struct Recording {
    folder: PathBuf,
    child: std::process::Child,
}

#[cfg(unix)]
impl Recording {
    /// Begins it by these words of a shell before the command itself.
    fn begun(name: &str, shell: &str) -> Self {
        let folder = file(name);
        std::fs::create_dir_all(&folder).unwrap();
        let wav = folder.join("long.wav");
        std::fs::write(&wav, "mine").unwrap();
        let arguments = "record --plate membrane --boundary 120mm --seconds 600s --force --wav";
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{shell} exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_slipline")]);
        let child = command.args(arguments.split(' ')).arg(wav).spawn().unwrap();
        let recording = Self { folder, child };
        let begun = std::time::Instant::now();
        while recording.files() < 2 && begun.elapsed().as_secs() < 60 {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        assert_eq!(recording.files(), 2, "it is being written beside the old one");
        recording
    }

    fn files(&self) -> usize {
        std::fs::read_dir(&self.folder).unwrap().count()
    }

    fn signal(&self, signal: &str) {
        let told = Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
        assert!(told.success());
    }

    /// It ends, and the old file is there alone.
    fn ends(mut self) {
        assert_eq!(self.child.wait().unwrap().code(), Some(130));
        assert_eq!(self.files(), 1);
        assert_eq!(std::fs::read(self.folder.join("long.wav")).unwrap(), b"mine");
        std::fs::remove_dir_all(self.folder).unwrap();
    }
}

/// Whether Linux says that a process ignores SIGHUP.
#[cfg(unix)]
fn ignores_hangup(process: &str) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 1 == 1)
}

#[cfg(unix)]
#[test]
fn whoever_ends_it_leaves_no_half_written_file_and_keeps_the_old_one() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        // Tests that were begun with nohup cannot give their children a SIGHUP back.
        if signal != "-HUP" || !ignores_hangup("self") {
            let recording = Recording::begun("interrupted", "");
            recording.signal(signal);
            recording.ends();
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_hangup_that_is_ignored_from_the_start_stays_ignored() {
    let recording = Recording::begun("outliving", "trap '' HUP;");
    assert!(ignores_hangup(&recording.child.id().to_string()));
    recording.signal("-HUP");
    recording.signal("-TERM");
    recording.ends();
}

#[test]
fn red_lights_end_a_check_with_3_and_are_counted() {
    for (arguments, code, last) in [
        (&["check", "--plate", "al-sh"][..], 3, "slipline: 4 of 13 lights are red\n"),
        (&["check", "--plate", "al-sh", "--json"], 3, "slipline: 4 of 13 lights are red\n"),
        (&["check", "--plate", "membrane"], 0, ""),
        (&["check", "--plate", "membrane", "--boundary", "120mm"], 0, ""),
    ] {
        let output = slipline(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert_eq!(String::from_utf8(output.stderr).unwrap(), last, "{arguments:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let red = if arguments.contains(&"--json") { "\"colour\":\"red\"" } else { "red    " };
        assert_eq!(text.matches(red).count(), if code == 3 { 4 } else { 0 }, "{text}");
    }
    let lines = String::from_utf8(slipline(&["check", "--plate", "membrane"]).stdout).unwrap();
    assert!(lines.starts_with("green      edge slope "), "{lines}");
    assert!(lines.contains("\nunchecked  actuator band "), "{lines}");
    let report = json(&["check", "--plate", "membrane"]);
    assert_eq!(
        (&report["lights"][10]["name"], &report["lights"][10]["colour"]),
        (&"actuator band".into(), &"unchecked".into())
    );
    assert!(failure(&["check", "--plate", "nope"], 2).contains("nope"));
    let help = String::from_utf8(slipline(&["--help"]).stdout).unwrap();
    assert!(help.contains("Exit code: 0 done; 1 could not be done; 2 bad usage"), "{help}");
}
