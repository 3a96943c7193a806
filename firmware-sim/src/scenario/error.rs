//! Why a scenario is refused.

use crate::limit::Fault;

/// Why a scenario cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The text is not a scenario; the message shows the line.
    #[error("this is not a scenario: {0}")]
    Toml(Box<toml::de::Error>),
    /// A number that cannot be.
    #[error("in {part}: {fault}")]
    Part {
        /// The part of the scenario.
        part: String,
        /// The number.
        fault: Fault,
    },
    /// Nothing to do.
    #[error("the scenario has no run; add at least one `[[run]]` with a `name` and a `kind`")]
    NoRun,
    /// Two runs of one name.
    #[error("two runs are named `{name}`; give every run a name of its own")]
    SameName {
        /// The name.
        name: String,
    },
    /// A run that begins while another goes on.
    #[error(
        "run `{run}` begins at age {begins_days} days, but the run before it ends at {ends_days:.4} days; \
         state a later `age_days`, or none to let it follow after the rig's `pause_h`"
    )]
    Overlap {
        /// The run that begins too early.
        run: String,
        /// When it begins, days.
        begins_days: f64,
        /// When the run before it ends, days.
        ends_days: f64,
    },
    /// A run of which no sample would be kept.
    #[error("run `{run}` keeps no sample of a part that lasts {part_s} s; lower `record_every_s` to at most that")]
    KeepsNothing {
        /// The run.
        run: String,
        /// The length of the part, s.
        part_s: f64,
    },
    /// A campaign that no memory holds.
    #[error("the scenario asks for {rows} samples and more; {limit} is the limit, so raise `record_every_s`")]
    TooManyRows {
        /// Samples asked for.
        rows: u64,
        /// Samples allowed.
        limit: u64,
    },
    /// A campaign that takes for ever.
    #[error("the scenario goes through {steps} time steps and more; {limit} is the limit, so raise `step_s`")]
    TooManySteps {
        /// Steps asked for.
        steps: u64,
        /// Steps allowed.
        limit: u64,
    },
    /// More poses than anybody writes down.
    #[error(
        "the runs have {parts} parts and more; {limit} is the limit, so shorten their lists, or `repeat` them less"
    )]
    TooManyParts {
        /// Parts asked for.
        parts: usize,
        /// Parts allowed.
        limit: usize,
    },
}
