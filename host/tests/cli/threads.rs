//! A system that starts no more threads: a sentence and exit code 1, or the work on fewer threads.

use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
use std::process::{Command, Stdio};

/// Ids of users that do not exist begin here.
const NOBODIES: u32 = 64_000;

/// Exit code and errors of a command of a user who may run this many threads.
fn limited(arguments: &str, threads: u32, user: u32) -> (Option<i32>, String) {
    let folder = std::env::temp_dir().join(format!("slipline-threads-{}", std::process::id()));
    let _ = std::fs::DirBuilder::new().mode(0o777).create(&folder);
    std::fs::write(folder.join("index.html"), "a page").unwrap();
    // The limit does not bind the superuser.
    let is_superuser = std::fs::metadata("/proc/self").unwrap().uid() == 0;
    let other = format!("setpriv --reuid {} --regid 65533 --clear-groups", NOBODIES + user);
    // By its number: another user may not enter the folder of the program.
    let script = format!(
        "exec 9<\"$0\"; exec timeout 60 {} bash -c 'ulimit -u {threads}; exec /proc/self/fd/9 {arguments}'",
        if is_superuser { other.as_str() } else { "" }
    );
    let mut command = Command::new("bash");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_slipline")]).current_dir(&folder);
    let output = command.env("XDG_CONFIG_HOME", &folder).stdin(Stdio::null()).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn without_a_thread_a_command_ends_with_a_sentence() {
    let words = "the system starts no more threads for this user: end other programs, or raise the limit";
    let mut user = 0;
    for (arguments, most) in [
        ("info --port sim", 5),
        ("drive --port sim --plate membrane --turning-point 150mm --for 10ms", 6),
        ("drive --port sim --plate membrane --turning-point 150mm --stdin", 6),
        ("page --folder . --listen 127.0.0.1:0", 1),
    ] {
        let mut refused = 0;
        for threads in 1..=most {
            user += 1;
            let (code, message) = limited(arguments, threads, user);
            assert!(!message.contains("panicked"), "{arguments} with {threads}: {message}");
            if code == Some(1) {
                assert!(
                    message.trim_end().lines().last().is_some_and(|line| line.contains(words)),
                    "{message}"
                );
                refused += 1;
            }
        }
        assert!(refused > 0, "{arguments}");
    }
    // One thread is enough for a table.
    let (code, message) = limited("table --plate membrane --knots 5", 1, 1000);
    assert_eq!(code, Some(0), "{message}");
}
