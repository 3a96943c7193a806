//! Hands the linker the memory map at the workspace's root.

use std::env::var;

fn main() {
    let root = var("CARGO_MANIFEST_DIR").expect("cargo sets it") + "/..";
    println!("cargo:rerun-if-changed={root}/memory.x");
    println!("cargo:rustc-link-search={root}");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if var("CARGO_FEATURE_LOG").is_ok() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
    // Without this the linker pads the sections to pages, which a flash image has no use for.
    println!("cargo:rustc-link-arg-bins=--nmagic");
}
