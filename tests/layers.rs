//! Claim: within each crate, too, arrows point one way only, and what belongs together stands together.
//!
//! A file that names what another one defines depends on it: in a `use`, in a path, in a macro, or by calling a method
//! that is written apart from its type. Re-exports are looked through: it is the file that defines a thing which is
//! depended on, and a file that merely shows what is below it does not depend on it. Documentation and tests may name anything.
//!
//! In every folder of modules, its parts are the children, each with all below it, and the folder's own file
//! (`effect.rs` of `effect/`). No part may lead, by whatever way, back to itself. So a file may re-export its children
//! and call down to them; but where it uses a child that reaches up for a type which the file itself defines, the two can't be
//! read apart, and that is a circle like one between neighbours.

#[path = "layers/circles.rs"]
mod circles;
#[path = "layers/house.rs"]
mod house;
#[path = "layers/names.rs"]
mod names;

use circles::{Circle, circles};
use house::House;
use tempfile::TempDir;

const CRATES: [&str; 6] = ["protocol", "firmware-core", "firmware", "firmware-sim", "trainer", "tempco"];

const LONGEST_FILE: usize = 400;

/// Every circle of a crate, in words.
fn circles_of(house: &House) -> String {
    let told = |circle: &Circle| format!("\nin {}: {}", circle.folder.join("::"), circle.told(house));
    circles(house).iter().map(told).collect()
}

#[test]
fn no_module_leads_back_to_itself() {
    let found: String = CRATES.into_iter().map(|folder| circles_of(&House::read(folder))).collect();
    assert!(
        found.is_empty(),
        "modules that need each other:\n{found}\n\
         To untie one: move what both need (most often a type, a constant, an error) into a file of its own below both, \
         or hand it over as an argument from the one that calls."
    );
}

/// Every `impl` of a type outside the folder of the file that defines it.
fn strays_of(house: &House) -> Vec<String> {
    let mut strays = Vec::new();
    for block in house.impls() {
        let [here, home] = [block.file, block.defined_in].map(|file| &house.files[file]);
        if !here.module.starts_with(&home.module) {
            let (of, here, home) = (block.of, here.name.display(), home.name.display());
            strays.push(format!("{here}:{}: `impl {of}`, which {home} defines", block.line));
        }
    }
    strays
}

#[test]
fn methods_of_a_type_are_written_in_its_own_folder() {
    let strays: Vec<String> = CRATES.into_iter().flat_map(|folder| strays_of(&House::read(folder))).collect();
    assert!(
        strays.is_empty(),
        "methods far from their type: {strays:#?}\n\
         Move them to it, or let them be functions that take it: those may stand anywhere above it."
    );
}

#[test]
fn no_file_is_longer_than_one_reads_at_once() {
    let files = CRATES.into_iter().flat_map(|folder| House::read(folder).files);
    let long = files.filter(|file| file.lines > LONGEST_FILE);
    let long: Vec<String> = long.map(|file| format!("{}: {} lines", file.name.display(), file.lines)).collect();
    assert!(long.is_empty(), "over {LONGEST_FILE} lines: {long:#?}\nA second concept in a file gets one of its own.");
}

/// A crate of these files.
fn small(files: &[(&str, &str)]) -> (TempDir, House) {
    let folder = TempDir::new().expect("a folder");
    for (name, text) in files {
        let file = folder.path().join("src").join(name);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        std::fs::write(file, text).expect("a file");
    }
    let house = House::read(folder.path().to_str().expect("a name"));
    (folder, house)
}

#[test]
fn a_circle_is_seen_however_a_name_is_written() {
    for back in [
        "use crate::a::A;",
        "use super::a::{A, B as C};",
        "use crate::{a::A};",
        "use crate::A;",
        "use crate::a; fn f(_: a::A) {}",
        "fn f(_: crate::a::A) {}",
        "fn f() { let _ = vec![crate::a::A]; }",
        "#[derive(Serialize)] struct S(#[serde(with = \"crate::a::A\")] u8);",
        "macro_rules! m { () => { $crate::a::A }; }",
        "pub use crate::a::A;",
        "mod inside { use super::super::a::A; }",
    ] {
        let (_folder, house) = small(&[
            ("lib.rs", "mod a; mod b; pub use a::A;"),
            ("a.rs", "use crate::b::f; pub struct A;"),
            ("b.rs", &format!("{back} pub fn f() {{}}")),
        ]);
        let told = circles_of(&house);
        assert!(told.contains("a → b → a") && told.contains("b.rs:1 names"), "{back}: {told}");
    }
}

#[test]
fn a_file_and_what_is_below_it_are_a_circle_only_where_both_need_each_other() {
    let child = ("a/b.rs", "use super::A; pub fn f(_: A) {}");
    for (parent, is_circle) in [
        ("mod b; pub use b::f; pub struct A;", false),
        ("mod b; pub struct A; fn g() { b::f(A) }", true),
        ("mod b; mod c; pub use c::A; fn g() { b::f(A) }", false),
        ("mod b; pub struct A; #[cfg(test)] mod tests { fn g() { super::b::f(super::A) } }", false),
    ] {
        let (_folder, house) = small(&[("lib.rs", "mod a;"), ("a.rs", parent), child, ("a/c.rs", "pub struct A;")]);
        assert_eq!(!circles_of(&house).is_empty(), is_circle, "{parent}: {}", circles_of(&house));
    }
}

#[test]
fn calling_a_method_that_is_written_elsewhere_is_needing_that_file() {
    let apart = ("a/b.rs", "use super::A; impl A { pub fn far(&self) {} }");
    for (parent, is_circle) in
        [("mod b; pub struct A;", false), ("mod b; pub struct A; impl A { fn near(&self) { self.far() } }", true)]
    {
        let (_folder, house) = small(&[("lib.rs", "mod a;"), ("a.rs", parent), apart]);
        assert_eq!(!circles_of(&house).is_empty(), is_circle, "{parent}");
        assert!(strays_of(&house).is_empty());
    }
    let (_folder, house) = small(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "pub struct A;"),
        ("b.rs", "use crate::a::A; impl A { pub fn far(&self) {} }"),
    ]);
    assert!(matches!(strays_of(&house).as_slice(), [stray] if stray.contains("b.rs:1: `impl A`")));
}
