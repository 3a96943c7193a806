//! Why a text is no expression.

use thiserror::Error;

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("expression `{text}`, column {column}: found {found}, expected {expected}{}", hint(.nearest.as_deref()))]
pub struct ExpressionError {
    /// The whole text.
    pub text: String,
    /// Where in it, in letters from 1.
    pub column: usize,
    /// What stands there.
    pub found: String,
    /// What could stand there.
    pub expected: String,
    /// The known name that was perhaps meant.
    pub nearest: Option<String>,
}

fn hint(nearest: Option<&str>) -> String {
    nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}
