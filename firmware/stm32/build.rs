//! Chooses the board's memory map and passes the linker scripts.

use std::{env, fs, path::PathBuf};

/// Board feature, as cargo hands it to a build script, and its memory map.
const BOARDS: [(&str, &str); 3] = [
    ("CARGO_FEATURE_BOARD_F4DISCOVERY", "memory/f407vg.x"),
    ("CARGO_FEATURE_BOARD_NUCLEO_G474RE", "memory/g474re.x"),
    ("CARGO_FEATURE_BOARD_NUCLEO_H743ZI2", "memory/h743zi.x"),
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=memory");
    println!("cargo::rerun-if-env-changed=SLIPLINE_BUILD");
    let commit = env::var("SLIPLINE_BUILD").unwrap_or_else(|_| "development".into());
    println!("cargo::rustc-env=SLIPLINE_BUILD={commit}");
    if env::var("CARGO_CFG_TARGET_ARCH").as_deref() != Ok("arm") {
        return;
    }
    let chosen: Vec<_> = BOARDS.iter().filter(|(feature, _)| env::var_os(feature).is_some()).collect();
    let [(_, memory)] = chosen[..] else {
        println!(
            "cargo::error=choose one board: --no-default-features --features board-f4discovery, \
             board-nucleo-g474re or board-nucleo-h743zi2"
        );
        return;
    };
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(memory, out.join("memory.x")).expect("the memory map can be copied");
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
