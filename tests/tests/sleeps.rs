//! No verdict of a test depends on how fast the computer is: each sleep of test code polls with a limit that only a hang
//! reaches, or stands here with its reason.

use slipline_tests::source_tree::{files, relative, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// What a sleep is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sleep {
    /// Between two looks at something that is waited for. The limit stands in the lines around it, in one of these words.
    Polls,
    /// For this reason.
    Because(&'static str),
}
use Sleep::{Because, Polls};

/// The limits by which polling ends.
const LIMITS: [&str; 7] =
    ["HANG", "elapsed()", "deadline", "Instant::now() <", "for _ in 0..", "range(", "time.monotonic()"];

/// Each file of test code that sleeps, with its sleeps in order.
const SLEEPS: &[(&str, &[Sleep])] = &[
    (
        "host/instrument/src/native/client.rs",
        &[Because(
            "no wait: it stands for a computation that is longer than the link waits for a sign of life",
        )],
    ),
    (
        "host/tests/cli/brown_out.rs",
        &[Because(
            "the device's own time, which runs on however slow the computer is: a hello would end the wait for its host",
        )],
    ),
    ("host/tests/cli/files.rs", &[Polls]),
    ("host/tests/cli/following.rs", &[Polls]),
    ("host/tests/cli/held_up.rs", &[Polls]),
    ("host/tests/cli/progress.rs", &[Polls]),
    (
        "host/tests/cli/selftest.rs",
        &[Because("The signal may come anywhere in the sixteen seconds of the test.")],
    ),
    ("host/tests/cli/signals.rs", &[Polls, Polls]),
    ("host/tests/cli/trigger.rs", &[Polls, Polls]),
    ("host/tests/cli/trim.rs", &[Polls]),
    ("host/window/src/sound/tests.rs", &[Polls]),
    (
        "host/window/tests/gui/hang.rs",
        &[Because("a job that is held: it ends when the test lets go of it or drops its queue")],
    ),
    ("host/window/tests/gui/test_app.rs", &[Polls]),
    ("tests/desktop/test_starts.py", &[Polls, Polls, Polls]),
    (
        "tests/protocol/client.py",
        &[
            Polls,
            Because("no test: until the device's clock has passed an index, which it does by itself"),
            Polls,
            Polls,
            Because("no test: the client's demonstration sounds for a time that its user names"),
            Because("the same"),
        ],
    ),
    ("tests/page/board.py", &[Polls]),
    (
        "tests/python/test_device_faults.py",
        &[
            Because("no wait: the time for which a host hangs, longer than the dead man's"),
            Polls,
            Because("no wait: the time for which a host hangs, as above"),
            Polls,
            Because("no wait: the time in which the dead man stops the device"),
        ],
    ),
    (
        "tests/python/test_trials_device.py",
        &[
            Because("no wait: the length of a break, longer than the unattended time"),
            Because("no wait: the time of an answer, longer than the unattended time"),
        ],
    ),
    (
        "tests/python/test_device_threads.py",
        &[
            Because(
                "no wait: another thread is usually inside the call by then; before it the outcome must be the same",
            ),
            Because("the same"),
            Because("no wait: a random moment of a disturbance"),
        ],
    ),
    ("tests/protocol/device_case.py", &[Polls]),
    ("tests/protocol/server.py", &[Polls]),
    (
        "tests/protocol/test_device.py",
        &[Because(
            "a device in real time: it must be longer than its dead-man allows, and may be any longer",
        )],
    ),
    (
        "tests/protocol/test_sessions.py",
        &[
            Because(
                "a device in real time: three of them are longer than its dead-man, one is shorter by 0.3 s",
            ),
            Polls,
            Polls,
            Because("a status does not feed the dead-man: between two of them, until its time is over"),
        ],
    ),
    ("tests/python/line.py", &[Polls]),
    (
        "tests/python/test_device_attended.py",
        &[
            Because("a row of the issue: a program that sleeps for half a minute drives on"),
            Because("a row of the issue: of a sleep of 5 s the drive ends after 3 s"),
            Because("each is shorter than the time without a call by more than a second, all are longer"),
            Because("longer than the time without a call, and may be any longer"),
            Because("the same"),
            Because("longer than the second without a sign of life; it may be any longer"),
            Because("longer than what that handler takes for two lines, and may be any longer"),
        ],
    ),
    (
        "tests/python/test_device_ends.py",
        &[
            Because("the program is at its wait, or on its way there: it must end as fast"),
            Because("no wait: Ctrl-C ends it"),
            Because(
                "a program that is stopped for longer than the device's dead-man allows, and may be for any longer",
            ),
            Because("the same for one that is killed"),
        ],
    ),
    ("tests/python/test_study.py", &[Polls]),
    (
        "tests/src/command_proxy.rs",
        &[
            Because("between two looks for a host, until the proxy is dropped"),
            Because("a device that takes nothing now: the host's own time limits end it"),
        ],
    ),
    (
        "tests/src/qemu.rs",
        &[
            Because("QEMU looks once a second whether its terminal is open; longer does no harm"),
            Polls,
            Polls,
        ],
    ),
    ("tests/src/turned_clock.rs", &[Polls]),
    ("tests/tests/ports.rs", &[Because("a cable without bytes, between two looks, until it is pulled")]),
];

/// The folders of test code: integration tests, their rigs, and the files of unit tests among the sources.
const FOLDERS: [&str; 4] = ["tests", "host", "firmware", "shared"];

fn is_test_code(path: &str) -> bool {
    path.starts_with("tests/") || path.contains("/tests/") || path.ends_with("/tests.rs")
}

/// The lines that sleep; in a source of the product those after the head of its test module.
fn sleeps(path: &str, text: &str) -> Vec<usize> {
    let is_rust = path.ends_with(".rs");
    let call = if is_rust { "sleep(" } else { "time.sleep(" };
    let mut is_test = is_test_code(path);
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        is_test |= line.trim() == "mod tests {";
        let is_call = line.contains(call) && !line.contains("fn sleep(") && !line.contains("rig.sleep(");
        if is_test && is_call && !line.trim_start().starts_with("//") {
            found.push(number);
        }
    }
    found
}

#[test]
fn each_sleep_of_a_test_polls_with_a_limit_or_has_its_reason() {
    let all = FOLDERS.iter().flat_map(|folder| files(&root().join(folder), &[".rs", ".py"]));
    let text = |path: PathBuf| (relative(&path), fs::read_to_string(&path).expect("a source is text"));
    let mut sources: BTreeMap<String, String> = all.map(text).collect();
    // This file names what it looks for.
    sources.remove("tests/tests/sleeps.rs");
    let listed: BTreeMap<&str, &[Sleep]> = SLEEPS.iter().copied().collect();
    let mut wrong = Vec::new();
    for (path, text) in &sources {
        let lines: Vec<&str> = text.lines().collect();
        let found = sleeps(path, text);
        let reasons = listed.get(path.as_str()).copied().unwrap_or_default();
        if found.len() != reasons.len() {
            wrong.push(format!("{path}: {} sleeps, {} listed", found.len(), reasons.len()));
        }
        for (&number, reason) in found.iter().zip(reasons) {
            let around = &lines[number.saturating_sub(12)..lines.len().min(number + 6)];
            let has_limit = around.iter().any(|line| LIMITS.iter().any(|limit| line.contains(limit)));
            match reason {
                Polls if !has_limit => wrong.push(format!("{path}:{}: no limit", number + 1)),
                Because("") => wrong.push(format!("{path}:{}: no reason", number + 1)),
                _ => {}
            }
        }
    }
    wrong.extend(
        listed.keys().filter(|path| !sources.contains_key(**path)).map(|path| format!("{path} is gone")),
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_sleep_that_is_not_listed_is_found() {
    let product = "fn wait() {\n    thread::sleep(time);\n}\n\nmod tests {\n    fn it() {\n        sleep(TIME);\n    }\n}\n";
    assert_eq!(sleeps("host/src/wait.rs", product), [6]);
    assert_eq!(sleeps("tests/src/wait.rs", product), [1, 6]);
    assert_eq!(sleeps("tests/protocol/wait.py", "sleep(1)\n    time.sleep(2)\n# time.sleep(3)\n"), [1, 2]);
}
