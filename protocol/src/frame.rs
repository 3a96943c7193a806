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

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: [u8; 254] = [7; 254];

    /// Bodies and how they stand on the line.
    fn table() -> [(&'static [u8], &'static [&'static [u8]]); 8] {
        [
            (&[], &[&[1, 0]]),
            (&[0], &[&[1, 1, 0]]),
            (&[0, 0], &[&[1, 1, 1, 0]]),
            (&[0x11, 0x22, 0, 0x33], &[&[3, 0x11, 0x22, 2, 0x33, 0]]),
            (&[0x11, 0], &[&[2, 0x11, 1, 0]]),
            (&[7; 253], &[&[254], &[7; 253], &[0]]),
            (&FULL, &[&[255], &FULL, &[1, 0]]),
            (&[7; 255], &[&[255], &FULL, &[2, 7, 0]]),
        ]
    }

    #[test]
    fn zeros_are_replaced_and_come_back() {
        for (body, line) in table() {
            let stuffed = stuff(body).expect("it fits");
            assert!(stuffed.iter().eq(line.iter().copied().flatten()), "{body:?} became {stuffed:?}");
            let mut decoder = Decoder::new();
            stuffed[..stuffed.len() - 1].iter().for_each(|byte| decoder.unstuff(*byte));
            assert!(decoder.body == *body && decoder.left == 0, "{stuffed:?} became {:?}", decoder.body);
        }
    }

    fn received<T: DeserializeOwned>(bytes: &[u8]) -> Option<Result<Envelope<T>, FrameError>> {
        let mut decoder = Decoder::new();
        bytes.iter().find_map(|byte| decoder.push(*byte))
    }

    #[test]
    fn messages_come_through_up_to_the_longest() {
        for length in [0, 1, 128, 249] {
            let message =
                Envelope { sequence: 300, body: (length as u8, Vec::<u8, 256>::from_iter((0..length).map(|_| 0))) };
            let line = encode_frame(&message);
            // Sequence, the number and the length of a list take 2 + 1 + (1 or 2) bytes, the checksum 4.
            if length < 249 {
                assert_eq!(received(&line.expect("it fits")), Some(Ok(message)));
            } else {
                assert_eq!(line, Err(FrameError::TooLong));
            }
        }
        let request = Envelope { sequence: 1, body: Request::ReadBlob { offset: 2 } };
        assert_eq!(received(&encode_request(&request).expect("it fits")), Some(Ok(request)));
        let response = Envelope { sequence: 1, body: Response::Done };
        assert_eq!(received(&encode_response(&response).expect("it fits")), Some(Ok(response)));
    }

    #[test]
    fn a_frame_of_another_encoder_may_end_with_a_full_group() {
        let mut body = [7; 254];
        let checksum = crc32(&body[..250]).to_le_bytes();
        body[250..].copy_from_slice(&checksum);
        assert!(!checksum.contains(&0));
        let mut decoder = Decoder::new();
        for byte in [0xFF].iter().chain(&body) {
            assert_eq!(decoder.push::<u8>(*byte), None);
        }
        // 250 bytes of 7: the number 7, and a body that is longer than this message.
        assert_eq!(decoder.push::<u8>(0), Some(Err(FrameError::UnknownMessage { sequence: 7 })));
    }

    #[test]
    fn idle_zeros_are_nothing_and_broken_frames_are_named() {
        let table: [(&[u8], Option<FrameError>); 6] = [
            (&[0, 0, 0], None),
            (&[1, 0], Some(FrameError::Malformed)),
            (&[2, 0], Some(FrameError::Malformed)),
            (&[0xFF, 0], Some(FrameError::Malformed)),
            (&[6, 1, 2, 3, 4, 5, 0], Some(FrameError::Checksum)),
            (&[6, 1, 2, 3, 0], Some(FrameError::Malformed)),
        ];
        for (bytes, error) in table {
            assert_eq!(received::<Request>(bytes), error.map(Err), "{bytes:?}");
        }
        let mut long = [1; 300];
        long[299] = 0;
        assert_eq!(received::<Request>(&long), Some(Err(FrameError::TooLong)));
    }

    #[test]
    fn a_byte_too_many_behind_a_message_makes_another_message() {
        let line = encode_frame(&Envelope { sequence: 9, body: (Request::Measure, 1_u8) }).expect("it fits");
        assert_eq!(received::<Request>(&line), Some(Err(FrameError::UnknownMessage { sequence: 9 })));
    }
}
