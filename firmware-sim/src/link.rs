//! The host's end of the conversation, over any line that carries bytes.
//!
//! Apart from the virtual instrument because a serial port or a socket speaks the same: whoever has
//! a [`Transport`] has an instrument. It knows sequence numbers, repetition and pieces, nothing of
//! what a calibration means. It needs no clock: a transport gives up waiting by itself.

mod error;
mod transport;

pub use error::LinkError;
pub use transport::Transport;

use error::wrong;
use protocol::limits::{MAX_BLOB, MAX_CHUNK};
use protocol::{
    Blob, Decoder, Envelope, FrameError, Identity, InstrumentState, Reading, Refusal, Request, Response, Sample,
    StorageState, Streamed, encode_request, unlock_answer,
};
use std::collections::VecDeque;

/// For how long a calibration that was taken is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Until another one takes its place.
    ForGood,
    /// Until power-off: the instrument could not store it.
    UntilPowerOff,
}

/// One message of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unasked {
    /// Counts from 0 on; a gap is a loss.
    pub number: u32,
    /// What it carries.
    pub content: Content,
}

/// What a message of a stream carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// Of a stream of readings.
    Reading(Reading),
    /// Of a stream of samples.
    Sample(Sample),
}

/// The host's end of a line to an instrument.
#[derive(Debug)]
pub struct Link<T> {
    transport: T,
    decoder: Decoder,
    sequence: u16,
    tries: u32,
    stream: Option<u16>,
    unasked: VecDeque<Unasked>,
}

/// A lossy line rarely takes more; a dead one should be called dead within seconds.
const TRIES: u32 = 5;
/// Erasing a sector takes as long as this many usual answers.
const TRIES_TO_STORE: u32 = 6;
/// Where even pieces of this length don't get through, nothing will.
const SHORTEST_PIECE: usize = 8;

impl<T: Transport> Link<T> {
    /// A conversation over `transport`. Nothing is sent yet.
    pub const fn new(transport: T) -> Self {
        Self { transport, decoder: Decoder::new(), sequence: 0, tries: TRIES, stream: None, unasked: VecDeque::new() }
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

    /// The line, at the end of the conversation.
    pub fn into_transport(self) -> T {
        self.transport
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
        let response = self.ask(request);
        // Also where no answer came: the request may have been carried out, and another one under its number would
        // get its answer.
        self.sequence = self.sequence.checked_add(1).unwrap_or(1);
        response
    }

    /// Forgets the conversation so far: the next request greets anew.
    pub fn begin(&mut self) {
        self.sequence = 0;
        self.stream = None;
        self.unasked.clear();
        self.decoder = Decoder::new();
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

    /// Allows one calibration to be written, or one step back.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn unlock(&mut self) -> Result<(), LinkError<T::Error>> {
        let serial = self.identify()?.serial;
        let nonce = match self.exchange(Request::Challenge)? {
            Response::Nonce { nonce } => nonce,
            other => return Err(wrong(&other)),
        };
        self.command(Request::Unlock { answer: unlock_answer(nonce, &serial) })
    }

    /// Unlocks, writes a stored calibration, signature included, and has it stored and used.
    ///
    /// # Errors
    /// [`LinkError::Refused`] with the instrument's reason, in which case the old one runs on; or
    /// another [`LinkError`].
    pub fn upload(&mut self, bytes: &[u8]) -> Result<Kept, LinkError<T::Error>> {
        let length = u16::try_from(bytes.len()).map_err(|_| LinkError::TooLong)?;
        self.unlock()?;
        let (mut offset, mut piece_length, mut setbacks) = (0_u16, MAX_CHUNK, 0);
        while let Some(piece) = bytes.get(usize::from(offset)..).and_then(|rest| rest.chunks(piece_length).next()) {
            // The piece has at most MAX_CHUNK bytes, so it fits.
            let bytes = piece.try_into().unwrap_or_default();
            match self.command(Request::WriteBlob { offset, bytes }) {
                Ok(()) => offset += piece.len() as u16,
                // A short frame passes where a long one doesn't.
                Err(LinkError::NoAnswer { .. }) if piece_length > SHORTEST_PIECE => piece_length /= 2,
                // It lost power and what was written with it.
                Err(LinkError::Refused(Refusal::Offset(wanted))) if setbacks < self.tries => {
                    (offset, setbacks) = (wanted, setbacks + 1);
                }
                Err(LinkError::Refused(Refusal::Locked)) if setbacks < self.tries => {
                    self.unlock()?;
                    (offset, setbacks) = (0, setbacks + 1);
                }
                Err(error) => return Err(error),
            }
        }
        match self.exchange(Request::CommitBlob { length })? {
            Response::Done => Ok(Kept::ForGood),
            Response::UntilPowerOff => Ok(Kept::UntilPowerOff),
            other => Err(wrong(&other)),
        }
    }

    /// Writes a calibration and has it stored and used.
    ///
    /// # Errors
    /// As [`Link::upload`].
    pub fn upload_blob(&mut self, blob: &Blob) -> Result<Kept, LinkError<T::Error>> {
        let mut buffer = [0; MAX_BLOB];
        let bytes = blob.to_bytes(&mut buffer).map_err(|_| LinkError::TooLong)?;
        self.upload(bytes)
    }

    /// The bytes of the calibration in use, signature included.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn read_calibration(&mut self) -> Result<Vec<u8>, LinkError<T::Error>> {
        let mut read = Vec::new();
        loop {
            let offset = u16::try_from(read.len()).map_err(|_| LinkError::TooLong)?;
            match self.exchange(Request::ReadBlob { offset })? {
                Response::Piece { offset: from, length, bytes } if from == offset => {
                    read.extend_from_slice(&bytes);
                    if bytes.is_empty() || read.len() >= usize::from(length) {
                        return Ok(read);
                    }
                }
                other => return Err(wrong(&other)),
            }
        }
    }

    /// What does it store?
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn storage(&mut self) -> Result<StorageState, LinkError<T::Error>> {
        match self.exchange(Request::ReadStorage)? {
            Response::Storage(state) => Ok(state),
            other => Err(wrong(&other)),
        }
    }

    /// Unlocks, and has it return to the calibration before the one in use.
    ///
    /// # Errors
    /// [`LinkError::Refused`] with the instrument's reason, or another [`LinkError`].
    pub fn roll_back(&mut self) -> Result<(), LinkError<T::Error>> {
        self.unlock()?;
        self.command(Request::RollBack)
    }

    /// Has it measure and send, unasked, until [`Link::stop`].
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn stream(&mut self, what: Streamed, period_ms: u32) -> Result<(), LinkError<T::Error>> {
        if self.sequence == 0 {
            self.identify()?;
        }
        self.unasked.clear();
        // Its messages bear the number of this request; the first ones may come before the answer.
        self.stream = Some(self.sequence);
        self.command(Request::Stream { what, period_ms })
    }

    /// The next message of the stream; `None` if none came for as long as the line's patience lasts.
    ///
    /// # Errors
    /// If the line is gone.
    pub fn next_unasked(&mut self) -> Result<Option<Unasked>, LinkError<T::Error>> {
        while self.unasked.is_empty() {
            let Some(byte) = self.transport.receive().map_err(LinkError::Line)? else { return Ok(None) };
            if let Some(Ok(message)) = self.decoder.push(byte) {
                self.keep_unasked(&message);
            }
        }
        Ok(self.unasked.pop_front())
    }

    /// Ends the stream. What still was under way is forgotten.
    ///
    /// # Errors
    /// A [`LinkError`].
    pub fn stop(&mut self) -> Result<(), LinkError<T::Error>> {
        let answer = self.command(Request::Stop);
        self.stream = None;
        self.unasked.clear();
        answer
    }

    /// Puts aside what belongs to a stream, and says whether it did.
    fn keep_unasked(&mut self, message: &Envelope<Response>) -> bool {
        let (number, content) = match &message.body {
            Response::StreamedReading { number, reading } => (*number, Content::Reading(*reading)),
            Response::StreamedSample { number, sample } => (*number, Content::Sample(*sample)),
            _ => return false,
        };
        // A stream of an earlier conversation may still be running out.
        if self.stream == Some(message.sequence) {
            self.unasked.push_back(Unasked { number, content });
        }
        true
    }

    fn command(&mut self, request: Request) -> Result<(), LinkError<T::Error>> {
        match self.exchange(request)? {
            Response::Done => Ok(()),
            other => Err(wrong(&other)),
        }
    }

    fn ask(&mut self, body: Request) -> Result<Response, LinkError<T::Error>> {
        let stores = matches!(body, Request::CommitBlob { .. } | Request::RollBack);
        let tries = if stores { self.tries.saturating_mul(TRIES_TO_STORE) } else { self.tries };
        let line = encode_request(&Envelope { sequence: self.sequence, body }).map_err(LinkError::Request)?;
        for repetition in 0..tries {
            if repetition > 0 {
                // Ends whatever piece of a frame the instrument still holds.
                self.transport.send(&[0]).map_err(LinkError::Line)?;
            }
            self.transport.send(&line).map_err(LinkError::Line)?;
            if let Some(response) = self.listen()? {
                return Ok(response);
            }
        }
        Err(LinkError::NoAnswer { tries })
    }

    /// The answer to the present request; `None` if it was broken or did not come.
    fn listen(&mut self) -> Result<Option<Response>, LinkError<T::Error>> {
        while let Some(byte) = self.transport.receive().map_err(LinkError::Line)? {
            match self.decoder.push(byte) {
                Some(Ok(message)) if self.keep_unasked(&message) => {}
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
