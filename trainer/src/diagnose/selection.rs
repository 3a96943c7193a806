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
mod uncertainty;

pub(super) use candidate::Candidate;
pub(super) use catalogue::with_channels;
pub(super) use contender::{Contender, Found, Searched};
pub(super) use cross_validation::{HeldOut, as_it_is, held_out, predicted};
pub(super) use forward_selection::{inexact, missing};
pub(super) use identifiability::{Screening, unobservable};
pub(super) use predictive::{is_worse, most_predictive, reads_worse};
pub(super) use screening::screen;
pub(super) use starts::starts;
pub(super) use uncertainty::standard_uncertainties;
