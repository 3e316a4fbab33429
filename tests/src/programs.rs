//! The programs that tests start. Each is built once per test binary, by the cargo that runs the tests.

use crate::source_tree::root;
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};
use std::sync::OnceLock;

/// The emulated device's image.
///
/// # Panics
/// If it does not build.
pub fn image() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| {
        let target = ["--release", "--target", "thumbv7em-none-eabihf"];
        executable(
            "slipline-qemu",
            &[&["build", "-p", "slipline-qemu", "--bin", "slipline-qemu"], &target[..]].concat(),
        )
    })
}

/// The host's program, of the build that `cargo test` makes: by its package's name alone other features would be
/// selected, and everything built once more.
///
/// # Panics
/// If it does not build.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| executable("slipline", &["test", "--no-run", "--test", "cli"]))
}

/// Builds with cargo; returns the program of that name.
fn executable(name: &str, arguments: &[&str]) -> PathBuf {
    let output = Process::new(env!("CARGO"))
        .args(arguments)
        .args(["--message-format", "json"])
        .current_dir(root())
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{arguments:?} does not build");
    let message = |line: &str| serde_json::from_str::<serde_json::Value>(line).expect("cargo prints JSON");
    let messages = String::from_utf8_lossy(&output.stdout);
    let built = messages.lines().map(message).find(|message| {
        let target = &message["target"];
        target["kind"] == serde_json::json!(["bin"])
            && target["name"] == name
            && message["executable"].is_string()
    });
    PathBuf::from(built.expect("cargo names the program")["executable"].as_str().expect("a path"))
}
