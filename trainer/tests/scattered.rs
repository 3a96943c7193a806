//! Training where no two samples share a state and the slope has structure that no polynomial follows.

// The soaked campaign is for the benchmarks.
#[allow(dead_code)]
#[path = "../benches/shared/synthetic.rs"]
mod synthetic;

use synthetic::NOISE_G;
use trainer::campaign::HoldOut;
use trainer::progress::Quiet;
use trainer::train::{TrainSettings, train};

/// The polynomial misses this map by a hundred times the noise. A training that takes the polynomial's word
/// for the scatter stops there.
#[test]
fn training_reaches_the_noise_of_scattered_samples() {
    let campaign = synthetic::scattered(2_160);
    let split = campaign.split(&HoldOut::None).expect("runs to train on");
    let settings = TrainSettings { restarts: 8, ..TrainSettings::new(1) };
    let model = train(&campaign, &split, &settings, &Quiet).expect("a model").model;
    let ratio = model.provenance.training_residual / NOISE_G;
    assert!(ratio < 1.1, "{ratio:.2} times the noise");
}
