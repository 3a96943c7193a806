//! Why a text is no model, or a model nothing for a device.

use crate::expression::ExpressionError;
use firmware_core::LoadError;
use std::path::PathBuf;
use thiserror::Error;

/// Why there is no model.
#[derive(Debug, Error)]
pub enum ModelError {
    /// The file can't be read.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text is no model.
    #[error("{path}: not a model file: {source}", path = path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line and column are in its text.
        source: Box<toml::de::Error>,
    },
    /// Another version wrote it.
    #[error("{path}:{line}: model format {found}, this version reads {supported}", path = path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// Found.
        found: i64,
        /// Understood.
        supported: u32,
    },
    /// A coefficient makes no physical sense.
    #[error(
        "{path}:{line}: effect `{effect}`: {parameter} = {value} is outside {low} to {high}",
        path = path.display(), low = bounds.0, high = bounds.1
    )]
    Bound {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// The effect.
        effect: String,
        /// The coefficient.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// The least and the greatest value that it can have.
        bounds: (f64, f64),
    },
    /// The text is a model that no device can run.
    #[error("{path}: the model can't be used: {source}", path = path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<DeviceLimit>,
    },
    /// The model doesn't fit a device.
    #[error("the model can't be put on a device: {0}")]
    Device(#[from] DeviceLimit),
}

/// What a device can't hold.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DeviceLimit {
    /// An effect unknown to this version.
    #[error("there is no effect named `{0}`; `tempco effects` lists them")]
    UnknownEffect(String),
    /// A coefficient is missing or surplus.
    #[error("effect `{effect}` takes the coefficients {expected}, the model has {found}")]
    Coefficients {
        /// The effect.
        effect: String,
        /// In the model.
        found: String,
        /// Needed.
        expected: String,
    },
    /// An effect's channel is not among the model's.
    #[error("effect `{effect}` needs a channel that the model's `channels` do not list")]
    Channel {
        /// The effect.
        effect: String,
    },
    /// An effect of the user's own doesn't say what it depends on, or another one does.
    #[error("effect `{effect}` {wrong}")]
    Expression {
        /// The effect.
        effect: String,
        /// What is wrong.
        wrong: &'static str,
    },
    /// An expression is wrong for the model's channels.
    #[error(transparent)]
    Text(#[from] ExpressionError),
    /// Too many of something.
    #[error("{what}: at most {most}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// The limit.
        most: usize,
    },
    /// It was told a scale factor and reads with another one.
    #[error(
        "its slope is not the one of the scale factor that was stated when it was trained (`scale_factor_hz_per_g`)"
    )]
    ScaleFactor,
    /// The core refuses it.
    #[error("{0}")]
    Load(LoadError),
}

impl ModelError {
    /// The way out.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        Some(match self {
            Self::Io { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
                "make one with `tempco train DATA -o model.toml`".to_owned()
            }
            Self::Io { .. } => return None,
            Self::Syntax { .. } => {
                "mend that line, or train the model again: `tempco train DATA -o model.toml`".to_owned()
            }
            Self::Format { .. } => {
                "read it with the version that wrote it (`made_by` in the file), or train the model again with this one"
                    .to_owned()
            }
            Self::Bound { effect, .. } => {
                format!("`tempco effects {effect}` explains its parameters; `tempco add` finds them from measurements")
            }
            Self::Unusable { source, .. } => return source.help().map(str::to_owned),
            Self::Device(source) => return source.help().map(str::to_owned),
        })
    }
}

impl DeviceLimit {
    /// The way out, where there is one.
    #[must_use]
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::ScaleFactor | Self::Load(firmware_core::LoadError::Slope { .. }) => Some(
                "train the model again, with --scale-factor if the reference never varies; with levels in between if it does",
            ),
            _ => None,
        }
    }
}
