//! Chooses the board's memory map and passes the linker scripts.

use std::{env, fs, path::PathBuf};

/// A board's feature and its memory map.
const BOARDS: [(&str, &str); 3] = [
    ("board-f4discovery", "memory/f407vg.x"),
    ("board-nucleo-g474re", "memory/g474re.x"),
    ("board-nucleo-h743zi2", "memory/h743zi.x"),
];

/// Whether cargo builds with a feature: cargo sets an environment variable for each.
fn has(feature: &str) -> bool {
    env::var_os(format!("CARGO_FEATURE_{}", feature.to_uppercase().replace('-', "_"))).is_some()
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=memory");
    println!("cargo::rerun-if-env-changed=SLIPLINE_BUILD");
    let commit = env::var("SLIPLINE_BUILD").unwrap_or_else(|_| "development".into());
    println!("cargo::rustc-env=SLIPLINE_BUILD={commit}");
    if env::var("CARGO_CFG_TARGET_ARCH").as_deref() != Ok("arm") {
        return;
    }
    let chosen: Vec<_> = BOARDS.iter().filter(|(board, _)| has(board)).collect();
    let [(_, memory)] = chosen[..] else {
        let known = BOARDS.map(|(board, _)| board).join(", ");
        println!("cargo::error=choose one board: --no-default-features --features ..., with one of {known}");
        return;
    };
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(memory, out.join("memory.x")).expect("the memory map can be copied");
    fs::copy("memory/fast.x", out.join("fast.x")).expect("what memory maps include can be copied");
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
