//! The same sources as the product's, with what a next minor version of the protocol might add.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-cfg=slipline_next");
}
