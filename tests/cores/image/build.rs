//! Hands the linker the memory map of the machine that QEMU emulates for each target.

use std::env::var;

fn main() {
    let of = |name: &str| var(name).expect("cargo sets it");
    let machine = match of("TARGET").as_str() {
        "thumbv6m-none-eabi" => "microbit",
        "thumbv7m-none-eabi" | "thumbv7em-none-eabihf" => "mps2",
        "thumbv8m.main-none-eabihf" => "mps2-an505",
        "riscv32imac-unknown-none-elf" | "riscv32imc-unknown-none-elf" => "virt",
        // The host needs none.
        _ => return,
    };
    let folder = format!("{}/memory/{machine}", of("CARGO_MANIFEST_DIR"));
    println!("cargo:rerun-if-changed={folder}");
    println!("cargo:rustc-link-search={folder}");
    if machine == "virt" {
        println!("cargo:rustc-link-arg-bins=-Tmemory.x");
    }
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
}
