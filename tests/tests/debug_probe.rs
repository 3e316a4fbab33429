//! with the debug probe detached nothing in the flashed images can wait for it, for nothing in them writes to it.

use std::path::Path;
use std::process::Command;

/// Crates that write to a debug probe, and can wait for one: logging over RTT, panic messages over it, semihosting
/// (which halts a chip that no probe watches). defmt without a transport is harmless, but would want one.
const TRANSPORTS: [&str; 9] = [
    "defmt",
    "defmt-rtt",
    "rtt-target",
    "rtt-log",
    "panic-rtt-target",
    "panic-probe",
    "panic-semihosting",
    "cortex-m-semihosting",
    "cortex-m-log",
];

#[test]
#[ignore = "needs the firmware's crates, which cargo test does not fetch: .ci/run images runs it"]
fn no_board_s_image_writes_to_a_debug_probe() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let manifest =
        std::fs::read_to_string(root.join("firmware/stm32/Cargo.toml")).expect("the boards are listed");
    let boards: Vec<&str> = manifest
        .lines()
        .filter(|line| line.starts_with("board-"))
        .filter_map(|line| line.split(' ').next())
        .collect();
    assert!(boards.contains(&"board-f4discovery"), "{boards:?}");
    for board in boards {
        let output = Command::new(env!("CARGO"))
            .args(["tree", "--offline", "--prefix", "none", "--format", "{p}", "--edges", "normal"])
            .args(["--target", "thumbv7em-none-eabihf", "--package", "slipline-stm32"])
            .args(["--no-default-features", "--features", board])
            .current_dir(&root)
            .output()
            .expect("cargo runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let tree = String::from_utf8_lossy(&output.stdout);
        let linked: Vec<&str> = tree.lines().filter_map(|line| line.split_whitespace().next()).collect();
        assert!(linked.contains(&"embassy-stm32"), "{board}: this is the image's tree");
        for transport in TRANSPORTS {
            assert!(!linked.contains(&transport), "{board} links {transport}");
        }
    }
}
