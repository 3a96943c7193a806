//! Why a request got no useful answer.

use protocol::limits::MAX_STORED;
use protocol::{FrameError, Refusal, Response};
use std::convert::Infallible;
use thiserror::Error;

/// Why a request got no useful answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LinkError<E = Infallible> {
    /// The line is gone.
    #[error("the line failed: {0}")]
    Line(#[source] E),
    /// Nobody answered.
    #[error("no answer after {tries} tries; is the instrument connected and powered?")]
    NoAnswer {
        /// How often the request was sent.
        tries: u32,
    },
    /// The instrument will not do it.
    #[error("the instrument refused: {0}")]
    Refused(Refusal),
    /// The instrument answered another question.
    #[error("the instrument answered {0}, which does not belong to the request")]
    Unexpected(&'static str),
    /// The answer is sound and its kind is not known here.
    #[error("the instrument answered with a message that this version doesn't know; update this program")]
    UnknownAnswer,
    /// The request does not fit a frame.
    #[error("the request can't be sent: {0}")]
    Request(#[source] FrameError),
    /// The calibration is longer than a device stores.
    #[error("the calibration is longer than the {MAX_STORED} bytes that a device stores")]
    TooLong,
}

/// The error that an answer amounts to where another was expected.
pub(super) fn wrong<E>(response: &Response) -> LinkError<E> {
    match response {
        Response::Refused(refusal) => LinkError::Refused(*refusal),
        Response::Identity(_) => LinkError::Unexpected("with its identity"),
        Response::State(_) => LinkError::Unexpected("with its state"),
        Response::Measured { .. } => LinkError::Unexpected("with a measurement"),
        Response::Reading(_) => LinkError::Unexpected("with a reading"),
        Response::Done => LinkError::Unexpected("that it is done"),
        Response::Piece { .. } => LinkError::Unexpected("with a piece of its calibration"),
        Response::Storage(_) => LinkError::Unexpected("with what it stores"),
        Response::Nonce { .. } => LinkError::Unexpected("with a challenge"),
        Response::UntilPowerOff => LinkError::Unexpected("that it could not store a calibration"),
        Response::StreamedReading { .. } | Response::StreamedSample { .. } => LinkError::Unexpected("with a stream"),
        _ => LinkError::UnknownAnswer,
    }
}
