//! The release that the firmware belongs to.

/// Major, minor and patch number of this workspace's version, as the hello states them. `Cargo.toml` is its only source.
pub const VERSION: (u8, u8, u8) = (
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
);

/// A decimal number. Evaluated by the compiler: what is above 255 or no number overflows and does not compile.
const fn number(text: &str) -> u8 {
    let mut value = 0;
    let mut bytes = text.as_bytes();
    while let [digit, rest @ ..] = bytes {
        value = value * 10 + (*digit - b'0');
        bytes = rest;
    }
    value
}
