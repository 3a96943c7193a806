//! Why there is no model.

use crate::effect_choice::EffectError;
use crate::fit::firefly::FireflyError;
use crate::fit::gradient_descent::DescentError;
use crate::model::DeviceLimit;
use thiserror::Error;

/// Why there is no model.
#[derive(Debug, Error)]
pub enum TrainError {
    /// Nothing to learn from.
    #[error("no training runs are left after holding out; name fewer runs with --hold-out")]
    NoTrainingRuns,
    /// The restart count is zero.
    #[error("at least one restart is needed")]
    NoRestarts,
    /// More restarts than anybody waits for.
    #[error("{found} restarts; at most {most} are made, so ask for fewer with --restarts")]
    TooManyRestarts {
        /// Asked for.
        found: usize,
        /// Made at most.
        most: usize,
    },
    /// A device has room for so many letters.
    #[error("serial number `{found}` is longer than the {most} bytes that a device has room for")]
    LongSerial {
        /// The serial number.
        found: String,
        /// Bytes that fit.
        most: usize,
    },
    /// A model file holds no larger one.
    #[error("seed {found} is above {most}, the largest that a model file holds")]
    LargeSeed {
        /// The seed.
        found: u64,
        /// The largest.
        most: u64,
    },
    /// Stopped before the first restart ended.
    #[error("cancelled before the first restart ended")]
    Cancelled,
    /// An effect that this campaign or no device can have.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The paper's methods train a network alone.
    #[error("effects can be fitted with the second-order method only")]
    EffectsNeedSecondOrder,
    /// A setting of the firefly swarm makes no sense.
    #[error("firefly swarm: {0}")]
    Swarm(#[from] FireflyError),
    /// A setting of the gradient descent makes no sense.
    #[error("gradient descent: {0}")]
    Descent(#[from] DescentError),
    /// No slope can be learnt of one level.
    #[error(
        "the reference is the same in every row of the training runs, so they don't say what a change of it does: state the scale factor with --scale-factor"
    )]
    NoScaleFactor,
    /// What was found can't measure.
    #[error("what the training found is no instrument: {0}")]
    Unusable(DeviceLimit),
    /// References beyond what a device can compute with.
    #[error("references of this size are beyond the 32-bit numbers of a device: give them in another unit")]
    Numbers,
    /// No restart gave finite weights.
    #[error("no restart converged to finite weights; look at the campaign with `tempco inspect`")]
    NoFiniteWeights,
}
