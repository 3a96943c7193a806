//! Why a command could not do what it was asked, and the way out.

use serde::Serialize;
use std::fmt;
use std::path::Path;
use std::process::ExitCode;
use trainer::campaign::CampaignError;

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
}

impl Failure {
    pub fn new(message: impl fmt::Display) -> Self {
        Self { message: message.to_string(), help: None }
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
        write!(f, "\x1b[1;31merror:\x1b[0m {}", self.message)?;
        match &self.help {
            Some(help) => write!(f, "\n\x1b[1;36mhelp:\x1b[0m {help}"),
            None => Ok(()),
        }
    }
}

impl From<CampaignError> for Failure {
    fn from(error: CampaignError) -> Self {
        Self::new(&error).help(error.help())
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
    trainer::model::ModelError,
    trainer::model::DeviceLimit,
    trainer::residuals::ResidualError,
    trainer::train::TrainError,
    firmware_core::LoadError,
    protocol::BlobError,
    firmware_sim::link::LinkError,
);
