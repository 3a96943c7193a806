//! Which effects are missing: every effect at every shape, screened, fitted and compared.

mod candidate;
mod catalogue;
mod contender;
mod cross_validation;
mod forward_selection;
mod identifiability;
mod predictive;
mod screening;
mod shapes;
mod starts;

pub(super) use candidate::Candidate;
pub(super) use catalogue::with_channels;
pub(super) use contender::{Contender, Found};
pub(super) use cross_validation::held_out;
pub(super) use forward_selection::missing;
pub(super) use identifiability::{Screening, unobservable};
pub(super) use predictive::most_predictive;
pub(super) use screening::screen;
pub(super) use starts::starts;
