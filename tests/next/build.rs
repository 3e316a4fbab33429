//! The same sources as the product's, with what a next minor version of the protocol might add.

fn main() {
    // From the folder of the crate that is built, below this one. A path that is not there would build it each time.
    println!("cargo::rerun-if-changed=../build.rs");
    println!("cargo::rustc-cfg=slipline_next");
}
