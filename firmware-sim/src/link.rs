//! The host's end of the conversation, over any line that carries bytes.
//!
//! Apart from the virtual instrument because a serial port or a socket speaks the same: whoever has
//! a [`Transport`] has an instrument. It knows sequence numbers, repetition and pieces, nothing of
//! what a calibration means. It needs no clock: a transport gives up waiting by itself.

use protocol::limits::{MAX_BLOB, MAX_CHUNK};
use protocol::{
    Blob, Decoder, Envelope, FrameError, Identity, InstrumentState, Reading, Refusal, Request, Response, Sample,
    encode_request,
};
use std::convert::Infallible;
use thiserror::Error;

/// A line that carries bytes both ways and may lose them.
pub trait Transport {
    /// What this kind of line fails with, beyond repair by repetition.
    type Error: std::error::Error + 'static;

    /// Sends bytes.
    ///
    /// # Errors
    /// If the line is gone.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// The next byte; `None` once nothing came for as long as this line's patience lasts.
    ///
    /// # Errors
    /// If the line is gone.
    fn receive(&mut self) -> Result<Option<u8>, Self::Error>;
}

impl<T: Transport + ?Sized> Transport for &mut T {
    type Error = T::Error;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        (**self).send(bytes)
    }

    fn receive(&mut self) -> Result<Option<u8>, Self::Error> {
        (**self).receive()
    }
}

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
    #[error("the calibration is longer than the {MAX_BLOB} bytes that a device stores")]
    TooLong,
}

/// The host's end of a line to an instrument.
#[derive(Debug)]
pub struct Link<T> {
    transport: T,
    decoder: Decoder,
    sequence: u16,
    tries: u32,
}

/// A lossy line rarely takes more; a dead one should be called dead within seconds.
const TRIES: u32 = 5;

impl<T: Transport> Link<T> {
    /// A conversation over `transport`. Nothing is sent yet.
    pub const fn new(transport: T) -> Self {
        Self { transport, decoder: Decoder::new(), sequence: 0, tries: TRIES }
    }

    /// The same, but every request is sent up to `tries` times.
    #[must_use]
    pub const fn with_tries(mut self, tries: u32) -> Self {
        self.tries = tries;
        self
    }

    /// The line.
    pub const fn transport_mut(&mut self) -> &mut T {
        &mut self.transport
    }

    /// Asks and returns the answer, repeating what gets none. A refusal is an answer.
    ///
    /// # Errors
    /// A [`LinkError`] if no answer came or the line is gone.
    pub fn exchange(&mut self, request: Request) -> Result<Response, LinkError<T::Error>> {
        if self.sequence == 0 {
            // A greeting under number 0: the instrument forgets the numbers of an earlier conversation.
            self.ask(Request::Identify)?;
            self.sequence = 1;
        }
        let response = self.ask(request)?;
        self.sequence = self.sequence.checked_add(1).unwrap_or(1);
        Ok(response)
    }

    /// Who is there?
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn identify(&mut self) -> Result<Identity, LinkError<T::Error>> {
        match self.exchange(Request::Identify)? {
            Response::Identity(identity) => Ok(identity),
            other => Err(wrong(&other)),
        }
    }

    /// How is it?
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn state(&mut self) -> Result<InstrumentState, LinkError<T::Error>> {
        match self.exchange(Request::ReadState)? {
            Response::State(state) => Ok(state),
            other => Err(wrong(&other)),
        }
    }

    /// Measures once.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn measure(&mut self) -> Result<(Sample, Reading), LinkError<T::Error>> {
        match self.exchange(Request::Measure)? {
            Response::Measured { sample, reading } => Ok((sample, reading)),
            other => Err(wrong(&other)),
        }
    }

    /// Makes it forget the past.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn restart(&mut self) -> Result<(), LinkError<T::Error>> {
        self.command(Request::Restart)
    }

    /// What it makes of a sample that comes from here.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn replay(&mut self, sample: &Sample) -> Result<Reading, LinkError<T::Error>> {
        match self.exchange(Request::Replay(*sample))? {
            Response::Reading(reading) => Ok(reading),
            other => Err(wrong(&other)),
        }
    }

    /// Writes a stored calibration and has it used.
    ///
    /// # Errors
    /// [`LinkError::Refused`] with the instrument's reason, in which case the old one runs on; or
    /// another [`LinkError`].
    pub fn upload(&mut self, bytes: &[u8]) -> Result<(), LinkError<T::Error>> {
        let length = u16::try_from(bytes.len()).map_err(|_| LinkError::TooLong)?;
        let (mut offset, mut setbacks) = (0, 0);
        while let Some(piece) = bytes.get(usize::from(offset)..).and_then(|rest| rest.chunks(MAX_CHUNK).next()) {
            // The piece has at most MAX_CHUNK bytes, so it fits.
            let bytes = piece.try_into().unwrap_or_default();
            match self.command(Request::WriteBlob { offset, bytes }) {
                Ok(()) => offset += piece.len() as u16,
                // It lost power and what was written with it.
                Err(LinkError::Refused(Refusal::Offset(wanted))) if setbacks < self.tries => {
                    (offset, setbacks) = (wanted, setbacks + 1);
                }
                Err(error) => return Err(error),
            }
        }
        self.command(Request::CommitBlob { length })
    }

    /// Writes a calibration and has it used.
    ///
    /// # Errors
    /// As [`Link::upload`].
    pub fn upload_blob(&mut self, blob: &Blob) -> Result<(), LinkError<T::Error>> {
        let mut buffer = [0; MAX_BLOB];
        let bytes = blob.to_bytes(&mut buffer).map_err(|_| LinkError::TooLong)?;
        self.upload(bytes)
    }

    fn command(&mut self, request: Request) -> Result<(), LinkError<T::Error>> {
        match self.exchange(request)? {
            Response::Done => Ok(()),
            other => Err(wrong(&other)),
        }
    }

    fn ask(&mut self, body: Request) -> Result<Response, LinkError<T::Error>> {
        let line = encode_request(&Envelope { sequence: self.sequence, body }).map_err(LinkError::Request)?;
        for repetition in 0..self.tries {
            if repetition > 0 {
                // Ends whatever piece of a frame the instrument still holds.
                self.transport.send(&[0]).map_err(LinkError::Line)?;
            }
            self.transport.send(&line).map_err(LinkError::Line)?;
            if let Some(response) = self.listen()? {
                return Ok(response);
            }
        }
        Err(LinkError::NoAnswer { tries: self.tries })
    }

    /// The answer to the present request; `None` if it was broken or did not come.
    fn listen(&mut self) -> Result<Option<Response>, LinkError<T::Error>> {
        while let Some(byte) = self.transport.receive().map_err(LinkError::Line)? {
            match self.decoder.push(byte) {
                Some(Ok(Envelope { sequence, body })) if sequence == self.sequence => {
                    return Ok(Some(body));
                }
                Some(Err(FrameError::UnknownMessage { sequence })) if sequence == self.sequence => {
                    return Err(LinkError::UnknownAnswer);
                }
                // A late answer to an earlier request, or to a repetition of it.
                None | Some(Ok(_) | Err(FrameError::UnknownMessage { .. })) => {}
                Some(Err(_)) => return Ok(None),
            }
        }
        self.decoder = Decoder::new();
        Ok(None)
    }
}

/// The error that an answer amounts to where another was expected.
fn wrong<E>(response: &Response) -> LinkError<E> {
    match response {
        Response::Refused(refusal) => LinkError::Refused(*refusal),
        Response::Identity(_) => LinkError::Unexpected("with its identity"),
        Response::State(_) => LinkError::Unexpected("with its state"),
        Response::Measured { .. } => LinkError::Unexpected("with a measurement"),
        Response::Reading(_) => LinkError::Unexpected("with a reading"),
        Response::Done => LinkError::Unexpected("that it is done"),
        _ => LinkError::UnknownAnswer,
    }
}
