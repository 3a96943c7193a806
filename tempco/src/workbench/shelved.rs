//! A campaign that is set aside.

use super::entry::Entry;
use super::measured::Measured;

/// A campaign that is not looked at, its models, and the model that was.
pub struct Shelved {
    pub number: usize,
    pub measured: Measured,
    pub models: Vec<Entry>,
    pub current: Option<usize>,
}
