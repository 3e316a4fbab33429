//! Refusals: the exit code and the message.

use super::{design, failure, file, refused, said, says, slipline, words};

#[test]
fn a_plate_that_a_tones_frequency_cannot_enter_is_named_with_few_digits() {
    refused(
        &words("simulate --plate membrane --actual-plate al-bending --turning-point 120mm"),
        2,
        &["frequency = 105.063 Hz cannot enter the plate \"al-bending\": must be above"],
    );
}

#[test]
fn bad_usage_ends_with_2_and_names_field_and_range() {
    for (more, wanted) in [
        ("900mm", &["'900mm' for '--turning-point'", "80 to 280 mm"][..]),
        ("nan", &["'nan' for '--turning-point'", "80 to 280 mm, or 87.57 to 219 Hz"]),
        ("5kHz", &["87.57 to 219 Hz"]),
        ("120mm --level 1.2", &["level", "0 to 1"]),
        ("120mm --for 9999s", &["'9999s' for '--for", "10 ms to 600 s"]),
        ("90mm:2", &["its level", "0 to 1"]),
        ("160mm --finger 9m:firm", &["finger place = 9 m", "0 to 0.32 m"]),
        ("160mm --sheet --finger 9m:firm", &["finger place = 9 m", "0 to 0.32 m"]),
        ("160mm --sheet --finger 9cm:-1Ns/m,0,10mm", &["finger resistance = -1", "0 to"]),
        ("160mm --finger 90mm:1Ns/m,0,1m", &["finger contact = 1 m", "0.0005 to 0.1 m"]),
        ("1e400mm", &["'1e400mm' for '--turning-point'", "80 to 280 mm"]),
        ("-5mm", &["'-5mm' for '--turning-point'", "80 to 280 mm"]),
        ("9mm:0.5", &["'9mm' for '--turning-point'", "80 to 280 mm"]),
        ("120mm --level nan", &["--level", "nan", "0 to 1"]),
        ("120mm --level -1", &["--level", "-1", "0 to 1"]),
        ("120mm --csv x.svg --png ./x.svg", &["--csv", "--figure"]),
    ] {
        refused(&words(&format!("simulate --plate membrane --turning-point {more}")), 2, wanted);
    }
    for (more, wanted) in [
        ("2Hz", &["'2Hz' for '--freq'", "61.06 Hz to 1.053 kHz"][..]),
        ("120Hz --points 1", &["points"]),
        ("120Hz --2d --paper-mode", &["--paper-mode cannot be used with --2d: the paper's equation"]),
        ("120Hz --finger 150mm:heavy", &["--finger", "none, light, firm, or R,M,WIDTH"]),
        ("120Hz --finger 9m:light", &["finger place", "0 to 0.32"]),
        ("120Hz --finger 90mm:1Ns/m,1t,1mm", &["its mass"]),
        ("120Hz --finger 90mm:R,1g,1mm", &["its resistance"]),
        ("120Hz --finger 90mm:1Ns/m,1g,wide", &["its width"]),
        ("120Hz --finger here:light", &["its place"]),
        ("120Hz --finger 90mm", &["write PLACE:KIND"]),
        ("120Hz --finger 90mm:1,1g", &["write PLACE:KIND"]),
        ("120Hz --finger -1mm:light", &["finger place", "0 to 0.32 m"]),
        ("0Hz", &["'0Hz' for '--freq'", "61.06 Hz to 1.053 kHz"]),
        ("nan", &["'nan' for '--freq'", "61.06 Hz to 1.053 kHz"]),
    ] {
        refused(&words(&format!("respond --plate membrane --freq {more}")), 2, wanted);
    }
    for (line, wanted) in [
        ("simulate --plate membrane", &["--felt-edge", "--turning-point"][..]),
        (
            "simulate --plate al-bending --turning-point 240mm --sheet",
            &["\"al-bending\" is a plate in bending", "respond --2d"],
        ),
        ("table --plate membrane --knots 1026", &["1025"]),
        ("table --plate al-bending --sample-rate 20kHz", &["--sample-rate", "88.7 kHz to 100 MHz"]),
        ("table --plate no-such-plate", &["no-such-plate", "membrane"]),
        ("drive --port sim --plate membrane --for -1s", &["--for", "-1s", "0 to 600 s"]),
        ("drive --port sim --plate membrane --glide 1e400s", &["--glide", "5 ms to 10 s"]),
        ("table --plate membrane --knots -1", &["--knots", "whole number, 2 to 1025"]),
        ("table --plate mebrane", &["did you mean membrane?"]),
        ("verify --port sim --window 9s", &["'9s' for '--window'", "10 ms to 2.621 s"]),
        ("info --port unix:", &["unix:PATH"]),
        ("frobnicate", &["frobnicate"]),
        ("verify --port sim --tones 17", &["1 to 16"]),
    ] {
        refused(&words(line), 2, wanted);
    }
    refused(&["respond", "--plate", "membrane", "--freq", "12 parsec"], 2, &["Hz, kHz or MHz"]);
}

#[test]
fn tones_that_add_up_to_too_much_are_bad_usage_in_the_devices_words() {
    let tones = ["--plate", "membrane", "--turning-point", "120mm", "--turning-point", "200mm:1"];
    let wav = file("loud.wav");
    for command in [
        &["drive", "--port", "sim", "--for", "100ms"][..],
        &["simulate"],
        &["simulate", "--no-table"],
        &["record", "--seconds", "10ms", "--wav", wav.to_str().unwrap()],
    ] {
        refused(&[command, &tones].concat(), 2, &["% of full scale; lower their levels"]);
    }
    assert!(!wav.exists());
}

#[test]
fn what_cannot_be_done_ends_with_1_and_says_why() {
    refused(&["info", "--port", "no-such-port"], 1, &["no-such-port"]);
    let arguments =
        ["record", "--plate", "membrane", "--turning-point", "120mm", "--wav", "no/such/folder/drive.wav"];
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
        says(&message, words);
    }
}

#[test]
fn small_values_of_a_design_keep_their_digits() {
    let thin = "design --material latex --thickness 1um --band 80Hz..220Hz --length 30cm --tension 0.02N/m --air vacuum";
    let text = said(&thin.split(' ').collect::<Vec<_>>());
    says(
        &text,
        &["R = 58.82 µN s/m matches", "20.00 mN/m of width", "9.407 mm at the narrow end", "up to 0.0466\n"],
    );
}

#[test]
fn a_design_writes_the_air_of_its_frame_and_a_shear_wave_has_none() {
    let film = "design --material silicone-rubber --thickness 250um --band 88Hz..219Hz --length 320mm";
    let text = |more: &[&str]| {
        let output = slipline(&film.split(' ').chain(more.iter().copied()).collect::<Vec<_>>());
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap(),
        )
    };
    let (code, bare) = text(&["--tension", "40N/m"]);
    assert_eq!(code, Some(0), "{bare}");
    assert!(bare.contains("[air]\nmounting = \"bare-frame\"\ntemperature_c = 20.0\n"), "{bare}");
    assert!(bare.contains("mm, which is counted, and"), "{bare}");
    let (_, vacuum) = text(&["--tension", "40N/m", "--air", "vacuum"]);
    assert!(
        vacuum.contains("[air]\nmounting = \"vacuum\"\n") && !vacuum.contains("temperature_c"),
        "{vacuum}"
    );
    let (code, shear) = text(&["--shear", "--air", "baffle"]);
    assert!(code == Some(2) && shear.contains("--air"), "{shear}");
}

#[test]
#[cfg(unix)]
fn a_pipe_as_a_plate_file_is_refused_at_once_and_a_name_cannot_move_the_cursor() {
    let pipe = file("fifo.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let message = failure(&["table", "--plate", pipe.to_str().unwrap()], 2);
    std::fs::remove_file(&pipe).unwrap();
    assert!(message.contains("is a pipe or a device: save its output in a file"), "{message}");
    let moving = file("bad\u{1b}[2J.toml");
    std::fs::write(&moving, "colour = 3").unwrap();
    let message = failure(&["table", "--plate", moving.to_str().unwrap()], 2);
    std::fs::remove_file(&moving).unwrap();
    assert!(!message.contains('\u{1b}') && message.contains("bad\u{fffd}[2J.toml"), "{message}");
}

#[test]
#[cfg(all(feature = "gui", target_os = "linux"))]
fn a_file_and_a_port_are_for_the_window_and_a_commands_name_wins() {
    let plate = file("opened-by-the-window.toml");
    std::fs::write(&plate, slipline_plate::preset("membrane").unwrap().to_toml()).unwrap();
    let plate = plate.to_str().unwrap();
    for opens in
        [&[plate][..], &["--port", "sim"], &[plate, "--port", "unix:/run/nowhere.sock"], &["--kiosk"], &[]]
    {
        let (error, code) = super::no_display::start(opens, &[]);
        assert!(code == Some(1) && error.contains("no display to open a window on"), "{opens:?}: {error}");
    }
    for (arguments, words) in [
        (&["presetz"][..], "'presetz' is neither a file nor a command; a similar command is 'presets'"),
        (&["no-such.toml"], "'no-such.toml' is neither a file nor a command; see slipline --help"),
        (&["--port", "unix:"], "\"unix:\" is not a port"),
        (&["--kiosk", "presets"], "--kiosk is for the window: it stands without a command"),
        (&["--port", "sim", "presets"], "FILE and --port before a command are for the window"),
    ] {
        let (error, code) = super::no_display::start(arguments, &[]);
        assert!(code == Some(2) && error.contains(words), "{arguments:?}: {error}");
    }
    let presets = slipline(&["--json", "presets"]);
    assert!(presets.status.success(), "an option of all commands may stand before them");
}

#[test]
#[cfg(target_os = "linux")]
fn an_error_of_the_system_is_in_words_that_a_user_can_act_on() {
    let long = format!("unix:/tmp/{}", "x".repeat(200));
    for (arguments, words) in [
        (["info", "--port", "/dev/null"], "/dev/null is not a serial port"),
        (["info", "--port", &long], "the path is too long for a socket: name a shorter one"),
        (["serve", "--socket", &long[5..]], "the path is too long for a socket: name a shorter one"),
        (["table", "--plate", "/dev/null/x"], "a part of its path is no folder"),
    ] {
        let code = if arguments[0] == "table" { 2 } else { 1 };
        let message = failure(&arguments, code);
        assert!(message.contains(words) && !message.contains("os error"), "{message}");
    }
}
