//! The solver by itself, so that it can be compared with other solvers on equal terms.
//!
//! What `tempco train` puts around it for calibrations (anchors, a noise model, several passes) is left
//! out. For each of so many restarts on the first campaign it prints, as soon as it has them, the RMS
//! residuals on the first and on the second campaign, µg:
//! `cargo run --release -p trainer --example scattered -- samples.csv truth.csv 30`.

#[path = "shared/separable.rs"]
mod separable;

use separable::{Departure, random_start};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::PathBuf;
use trainer::campaign::{Campaign, ReadOptions};
use trainer::fit::levenberg_marquardt::{CAUTIOUS, Limits, minimise};
use trainer::fit::random::stream;

/// More patient than the trainer's: it is the last digit that is compared.
const LIMITS: Limits = Limits { iterations: 1000, decrease: 1e-7, step: 1e-9, damping: CAUTIOUS };
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [samples, truth, restarts] = arguments.as_slice() else {
        return Err("expected SAMPLES.csv TRUTH.csv RESTARTS".into());
    };
    let read = |path: &String| Campaign::read(&[PathBuf::from(path)], &ReadOptions::default());
    let (samples, truth) = (read(samples)?, read(truth)?);
    let departure = Departure::of(&samples);
    let mut problem = departure.problem();
    for index in 0..restarts.parse()? {
        let start = random_start(&mut stream(SEED, index));
        let minimum = minimise(&mut problem, &start, &LIMITS, |_, _| ControlFlow::Continue(()));
        if let Some(fit) = problem.fit(&minimum.point) {
            let [seen_ug, fresh_ug] = [&samples, &truth].map(|on| departure.residual_on_g(&fit, on) * 1e6);
            println!("{seen_ug:.4} {fresh_ug:.4}");
        }
    }
    Ok(())
}
