//! Why a command could not do what it was asked, and the way out.

use crate::visible::visible;
use serde::Serialize;
use std::fmt;
use std::path::Path;
use std::process::ExitCode;
use trainer::campaign::CampaignError;
use trainer::model::{DeviceLimit, ModelError};
use trainer::train::TrainError;

/// What a command answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Done, and all is well.
    Yes,
    /// Done, and the answer is no.
    No,
}

impl From<Answer> for ExitCode {
    fn from(answer: Answer) -> Self {
        Self::from(match answer {
            Answer::Yes => 0,
            Answer::No => 1,
        })
    }
}

/// An error with a sentence that says what to do.
#[derive(Clone, Debug, Serialize)]
pub struct Failure {
    message: String,
    help: Option<String>,
    /// Whoever read the answer has gone: nobody is left to be told.
    #[serde(skip)]
    nobody_reads: bool,
}

impl Failure {
    pub fn new(message: impl fmt::Display) -> Self {
        Self { message: message.to_string(), help: None, nobody_reads: false }
    }

    /// The reader of standard output has had enough.
    pub fn nobody_reads() -> Self {
        Self { nobody_reads: true, ..Self::new("nobody reads the answer") }
    }

    pub const fn is_nobody_reads(&self) -> bool {
        self.nobody_reads
    }

    pub fn help(self, help: impl fmt::Display) -> Self {
        Self { help: Some(help.to_string()), ..self }
    }

    pub fn io(path: &Path, error: &std::io::Error) -> Self {
        Self::new(format_args!("{}: {error}", path.display()))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\x1b[1;31merror:\x1b[0m {}", visible(&self.message))?;
        match &self.help {
            Some(help) => write!(f, "\n\x1b[1;36mhelp:\x1b[0m {}", visible(help)),
            None => Ok(()),
        }
    }
}

impl From<CampaignError> for Failure {
    fn from(error: CampaignError) -> Self {
        Self::new(&error).help(error.help())
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self { help: error.help(), ..Self::new(error) }
    }
}

impl From<TrainError> for Failure {
    fn from(error: TrainError) -> Self {
        match &error {
            TrainError::Unusable(limit) => Self { help: limit.help().map(str::to_owned), ..Self::new(error) },
            _ => Self::new(error),
        }
    }
}

impl From<DeviceLimit> for Failure {
    fn from(error: DeviceLimit) -> Self {
        Self { help: error.help().map(str::to_owned), ..Self::new(error) }
    }
}

macro_rules! plain {
    ($($error:ty),* $(,)?) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::new(error)
            }
        })*
    };
}

plain!(
    trainer::cross_validation::CrossValidationError,
    trainer::diagnose::DiagnoseError,
    trainer::ladder::LadderError,
    trainer::residuals::ResidualError,
    firmware_core::LoadError,
    protocol::BlobError,
    firmware_sim::link::LinkError,
);
