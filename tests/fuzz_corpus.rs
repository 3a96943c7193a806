//! Claim: no bytes, from the line, from flash, from a file or from a user, do more than being refused.
//!
//! The corpus of `fuzz/` and mutations of it, always the same. `fuzz/README.md` says how to search on.

use std::path::PathBuf;
use tests::fuzz::TARGETS;
use tests::workspace::root;

/// Mutations of each file of the corpus.
const MUTATIONS: u64 = 500;

/// Numbers that look random and are the same everywhere (SplitMix64).
struct Scatter(u64);

impl Scatter {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ (mixed >> 31)) as usize % bound.max(1)
    }

    /// A few changes of the kinds that fuzzers make.
    fn mutate(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len() + 1);
            match self.below(6) {
                0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
                1 if at < bytes.len() => bytes[at] = [0, 1, 0x7F, 0x80, 0xFF, b'-', b'9', b'\n'][self.below(8)],
                2 if at < bytes.len() => drop(bytes.drain(at..(at + 1 + self.below(8)).min(bytes.len()))),
                3 => bytes.insert(at, self.below(256) as u8),
                4 => bytes.truncate(at),
                _ => {
                    let from = self.below(other.len());
                    let piece = &other[from..(from + self.below(16)).min(other.len())];
                    bytes.splice(at..at, piece.iter().copied());
                }
            }
        }
    }
}

/// The corpus of a target, in the order of the names.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = root().join("fuzz/corpus").join(target);
    let mut files: Vec<PathBuf> =
        folder.read_dir().expect("a corpus").map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files.iter().map(|file| std::fs::read(file).expect("a readable file")).collect()
}

#[test]
fn the_corpus_and_its_mutations_do_no_harm() {
    for (name, target) in TARGETS {
        let corpus = corpus(name);
        assert!(corpus.len() >= 3, "{name} needs a corpus");
        let mut scatter = Scatter(corpus.len() as u64);
        for seed in &corpus {
            target(seed);
            for _ in 0..MUTATIONS {
                let mut bytes = seed.clone();
                let other = &corpus[scatter.below(corpus.len())];
                scatter.mutate(&mut bytes, other);
                target(&bytes);
            }
        }
    }
}
