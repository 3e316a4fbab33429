//! Examples at the end of the help of each command. A test runs all of them in this order, in one folder that is empty at first.

/// A command and its examples.
pub const EXAMPLES: &[(&str, &[&str])] = &[
    ("presets", &["slipline presets"]),
    ("ports", &["slipline ports --json"]),
    ("info", &["slipline info --port sim"]),
    ("watch", &["slipline watch --port sim"]),
    ("profile", &["slipline profile --port sim"]),
    ("board", &["slipline board brown-out --port sim"]),
    ("texture", &["slipline texture --plate membrane --solid 260mm --out solid.toml"]),
    (
        "drive",
        &[
            "slipline drive --port sim --plate membrane --felt-edge 250mm --for 500ms",
            "slipline drive --turning-point 120mm:50% --turning-point 200mm:-20dB --for 500ms",
            "slipline drive --setup solid.toml --for 500ms",
        ],
    ),
    (
        "respond",
        &[
            "slipline respond --plate al-bending --freq 40kHz",
            "slipline respond --plate membrane --freq 126Hz --2d --out response.svg",
        ],
    ),
    ("table", &["slipline table --plate membrane --out table.json"]),
    (
        "simulate",
        &[
            "slipline simulate --plate membrane --felt-edge 250mm --out envelope.csv",
            "slipline simulate --plate membrane --turning-point 160mm --actual-plate membrane-heavy",
            "slipline simulate --setup solid.toml",
        ],
    ),
    ("record", &["slipline record --plate membrane --turning-point 120mm --for 500ms --out codes.wav"]),
    ("verify", &["slipline verify --port sim --tones 4 --window 50ms"]),
    (
        "selftest",
        &[
            "slipline selftest --port sim --wire dac=sensor --wire trigger=trigger-in --short --out test.json",
            "slipline selftest --judge test.json",
            "slipline selftest --port sim --amplifier",
        ],
    ),
    ("serve", &["slipline serve --socket slipline.sock --plate membrane"]),
    ("page", &["slipline page --folder target/page"]),
    ("check", &["slipline check --plate membrane --turning-point 120mm"]),
    (
        "design",
        &[
            "slipline design --material aluminium --thickness 2mm --band 20..40kHz --length 300mm --out plate",
            "slipline design --material latex --thickness 0.5mm --band 80..220Hz --length 40cm --tension 70N/m",
        ],
    ),
    ("merit", &["slipline merit --plate membrane --turning-point 160mm"]),
    ("study", &["slipline study study.toml --out study.csv"]),
    (
        "measure",
        &[
            "slipline measure --plate al-bending --actual-plate secret --sensor 34mm --points 64 --out near.csv",
            "slipline measure --plate al-bending --actual-plate secret --sensor 187mm --points 64 --out far.csv",
        ],
    ),
    ("sweep", &["slipline sweep --port sim --plate al-bending --for 150ms --out sweep.toml"]),
    (
        "calibrate",
        &[
            "slipline calibrate --plate al-bending --plan",
            "slipline calibrate --plate al-bending --data near.csv --data far.csv --out calibrated.toml",
            "slipline calibrate --plate al-bending --touch 25kHz:236mm --touch 35kHz:270mm --out touched.toml",
            "slipline calibrate --plate membrane --touch 220mm:218mm --touch 270mm:267mm --feeling-out f.toml",
        ],
    ),
    (
        "trim",
        &["slipline trim --plate touched.toml --sensor 34mm --points 32 --for 500ms --out trimmed.toml"],
    ),
    ("figures", &["slipline figures --out figures"]),
    ("completions", &["slipline completions bash"]),
    ("manual", &["slipline manual --out manual"]),
    ("images", &["slipline images"]),
    ("udev", &["slipline udev"]),
];

/// The end of the help of a command.
pub(super) fn help(command: &str) -> Option<String> {
    let (_, lines) = EXAMPLES.iter().find(|(name, _)| *name == command)?;
    Some(format!("Examples:\n  {}", lines.join("\n  ")))
}
