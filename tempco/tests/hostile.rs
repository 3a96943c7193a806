//! Claim: no input makes tempco panic, hang or swallow the machine's memory; each is answered or refused with a sentence.
//!
//! Each case spoils a small campaign, its options or a model file in a few ways at once and takes every verb over it.
//! `TEMPCO_HOSTILE=5000 cargo test --release -p tempco --test hostile` takes more cases than the usual ones, and
//! `TEMPCO_HOSTILE_SEED=7` others.

#[path = "hostile/campaign.rs"]
mod campaign;
#[path = "hostile/model.rs"]
mod model;
#[path = "hostile/random.rs"]
mod random;
#[path = "hostile/verbs.rs"]
mod verbs;

use random::Random;
use std::fmt::Write;

fn number_of(variable: &str, usual: u64) -> u64 {
    std::env::var(variable).map_or(usual, |text| text.parse().expect("a number"))
}

#[test]
fn every_hostile_input_is_answered_or_refused() {
    let (count, seed) = (number_of("TEMPCO_HOSTILE", 60), number_of("TEMPCO_HOSTILE_SEED", 1));
    let (mut faults, mut tally) = (String::new(), verbs::Tally::default());
    for case in 0..count {
        let mut random = Random::new(seed.wrapping_mul(1_000_003).wrapping_add(case));
        let folder = tempfile::TempDir::new().expect("a folder");
        let spoilt = campaign::spoilt(&mut random);
        for fault in verbs::chain(folder.path(), &spoilt, &mut random, &mut tally) {
            writeln!(faults, "case {case} of seed {seed}, {}: {fault}", spoilt.how.join(" + "))
                .expect("a string takes it");
        }
    }
    println!("{count} hostile campaigns: {tally}");
    assert!(faults.is_empty(), "\n{faults}");
    // A generator that spoils everything beyond reading would test the reader alone.
    assert!(tally.trained * 4 > count, "only {} of {count} could be trained on", tally.trained);
}
