//! Bytes on the line: COBS(message ‖ CRC-32) ‖ 0.
//!
//! Consistent overhead byte stuffing (Cheshire & Baker 1999) removes every zero from the frame, so a
//! zero always ends one: after any loss the receiver is back in step at the next zero. Sender and
//! receiver are written here with checked access only; the common crates index, and an index that can
//! fail is a panic path in the image.

use crate::checksum::crc32;
use crate::limits::{MAX_FRAME, MAX_LINE};
use crate::message::{Envelope, Request, Response};
use core::fmt;
use heapless::Vec;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why bytes are no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrameError {
    /// More bytes than a frame can have.
    TooLong,
    /// The stuffing or the length is broken: bytes were lost.
    Malformed,
    /// The bytes changed on the way.
    Checksum,
    /// The frame is sound and its message unknown to this version.
    UnknownMessage {
        /// The number to answer to.
        sequence: u16,
    },
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TooLong => "frame longer than the protocol allows",
            Self::Malformed => "frame broken: bytes were lost",
            Self::Checksum => "frame corrupted",
            Self::UnknownMessage { .. } => "message unknown to this version",
        })
    }
}

impl core::error::Error for FrameError {}

/// A frame on the line, its final zero included.
pub type Line = Vec<u8, MAX_LINE>;

/// Frames a request.
///
/// # Errors
/// [`FrameError::TooLong`].
pub fn encode_request(message: &Envelope<Request>) -> Result<Line, FrameError> {
    encode_frame(message)
}

/// Frames a response.
///
/// # Errors
/// [`FrameError::TooLong`].
pub fn encode_response(message: &Envelope<Response>) -> Result<Line, FrameError> {
    encode_frame(message)
}

/// Frames any message.
///
/// # Errors
/// [`FrameError::TooLong`].
pub fn encode_frame<T: Serialize>(message: &T) -> Result<Line, FrameError> {
    let mut buffer = [0; MAX_FRAME - 4];
    let message = postcard::to_slice(message, &mut buffer).map_err(|_| FrameError::TooLong)?;
    let mut body = Vec::<u8, MAX_FRAME>::new();
    body.extend_from_slice(message).map_err(|_| FrameError::TooLong)?;
    body.extend_from_slice(&crc32(message).to_le_bytes()).map_err(|_| FrameError::TooLong)?;
    stuff(&body).ok_or(FrameError::TooLong)
}

/// Replaces every zero: each group of non-zero bytes is preceded by its length plus one.
fn stuff(body: &[u8]) -> Option<Line> {
    let mut line = Line::new();
    for group in body.split(|byte| *byte == 0) {
        let mut pieces = group.chunks(254).peekable();
        if pieces.peek().is_none() {
            line.push(1).ok()?;
        }
        while let Some(piece) = pieces.next() {
            line.push(u8::try_from(piece.len() + 1).ok()?).ok()?;
            line.extend_from_slice(piece).ok()?;
            // A full piece implies no zero; if the group ends with it, the zero needs a code of its own.
            if piece.len() == 254 && pieces.peek().is_none() {
                line.push(1).ok()?;
            }
        }
    }
    line.push(0).ok()?;
    Some(line)
}

/// Receives bytes one at a time and hands out messages.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    body: Vec<u8, MAX_FRAME>,
    left: u8,
    zero_after: bool,
    error: Option<FrameError>,
}

impl Decoder {
    /// A decoder waiting for the first byte of a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self { body: Vec::new(), left: 0, zero_after: false, error: None }
    }

    /// Takes one byte; at the end of a frame returns its message or what was wrong with it.
    /// Empty frames (idle zeros) are skipped.
    pub fn push<T: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<Envelope<T>, FrameError>> {
        if byte != 0 {
            self.unstuff(byte);
            return None;
        }
        let finished = core::mem::take(self);
        if finished.body.is_empty() && finished.error.is_none() && finished.left == 0 && !finished.zero_after {
            return None;
        }
        Some(finished.finish())
    }

    fn unstuff(&mut self, byte: u8) {
        if self.left == 0 {
            if self.zero_after {
                self.store(0);
            }
            self.left = byte.wrapping_sub(1);
            self.zero_after = byte != 0xFF;
        } else {
            self.left = self.left.wrapping_sub(1);
            self.store(byte);
        }
    }

    fn store(&mut self, byte: u8) {
        if self.body.push(byte).is_err() {
            self.error = Some(FrameError::TooLong);
        }
    }

    fn finish<T: DeserializeOwned>(&self) -> Result<Envelope<T>, FrameError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        if self.left != 0 {
            return Err(FrameError::Malformed);
        }
        let (message, checksum) = self.body.split_last_chunk::<4>().ok_or(FrameError::Malformed)?;
        if crc32(message) != u32::from_le_bytes(*checksum) {
            return Err(FrameError::Checksum);
        }
        // The number first: a message from the future must still be refused by its number.
        let (sequence, body) = postcard::take_from_bytes(message).map_err(|_| FrameError::Malformed)?;
        match postcard::take_from_bytes(body) {
            Ok((body, [])) => Ok(Envelope { sequence, body }),
            _ => Err(FrameError::UnknownMessage { sequence }),
        }
    }
}
