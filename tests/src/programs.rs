//! The programs that tests start. Each is built once per test binary, by the cargo that runs the tests.

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
        executable(&[&target[..], &["-p", "slipline-qemu", "--bin", "slipline-qemu"]].concat())
    })
}

/// The host's program, without its window: the command line is the same.
///
/// # Panics
/// If it does not build.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| executable(&["-p", "slipline", "--no-default-features", "--bin", "slipline"]))
}

fn executable(arguments: &[&str]) -> PathBuf {
    let output = Process::new(env!("CARGO"))
        .args(["build", "--message-format", "json"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{arguments:?} does not build");
    let messages = String::from_utf8_lossy(&output.stdout);
    let path =
        messages.lines().rev().find_map(|line| line.split_once("\"executable\":\"")?.1.split('"').next());
    PathBuf::from(path.expect("cargo names the executable"))
}
