//! The instrument beside its model, and a host that talks to both.

use crate::Dice;
use crate::pool::Pool;
use crate::reference::{Kept, Lock, Reference};
use firmware_core::{IdentityRecord, storage};
use firmware_sim::virtual_flash::{EraseOrder, VirtualFlash};
use firmware_sim::virtual_line::VirtualLine;
use protocol::limits::MAX_CHUNK;
use protocol::{
    Decoder, Envelope, Refusal, Request, Response, Sample, Streamed, encode_frame, encode_response, unlock_answer,
};
use std::collections::BTreeMap;
use tests::example;

/// What happened, and how often.
pub type Seen = BTreeMap<&'static str, u64>;

pub struct Talk<'a> {
    pool: &'a Pool,
    line: VirtualLine,
    reference: Reference<'a>,
    time_us: u64,
    /// The number of the request before, and what was answered.
    answered: u16,
    answer: Vec<u8>,
    /// The calibration that the host wants to write.
    goal: usize,
    samples: Vec<Sample>,
    /// For whoever must find out what went wrong.
    seed: u64,
    steps: usize,
}

impl<'a> Talk<'a> {
    /// A new instrument; some have been programmed, a few of these wrongly.
    pub fn new(pool: &'a Pool, seed: u64, dice: &mut Dice) -> Self {
        let programmed = dice.percent(40).then(|| pool.sent[dice.roll(pool.sent.len() as u64) as usize].clone());
        let orders =
            [EraseOrder::FrontToBack, EraseOrder::BackToFront, EraseOrder::ZerosFirst, EraseOrder::Scattered(seed)];
        let flash = VirtualFlash::holding(programmed.as_deref().unwrap_or_default()).erasing(dice.pick(&orders));
        let identity = IdentityRecord { key: pool.key.clone(), ..IdentityRecord::new(example::SERIAL) };
        Self {
            pool,
            line: VirtualLine::with(identity, flash),
            reference: Reference::powered(
                pool,
                [programmed.map(|bytes| Kept { bytes, sequence: 0 }), None],
                [0, 0],
                false,
            ),
            time_us: dice.roll(1_000_000),
            answered: 0,
            answer: Vec::new(),
            goal: dice.roll(pool.sent.len() as u64) as usize,
            samples: example::samples(40),
            seed,
            steps: 0,
        }
    }

    /// One thing happens.
    pub fn step(&mut self, dice: &mut Dice, seen: &mut Seen) {
        self.steps += 1;
        let usual_us = [0, 1, 1_000, 20_000, 1_000_000];
        let rare_us = [59_000_000, 61_000_000, 301_000_000];
        self.time_us += if dice.percent(97) { dice.pick(&usual_us) } else { dice.pick(&rare_us) };
        match dice.roll(100) {
            0..60 => self.towards_the_goal(dice, seen),
            60..80 => self.ask(&self.any_request(dice), dice, seen),
            80..84 => self.poll(seen),
            84..88 => self.let_sensors_see_something(dice),
            88..92 => self.spoilt_frame(dice, seen),
            92..94 => self.power_cycle(seen),
            94 => self.time_us = self.time_us.saturating_sub(dice.roll(100_000_000)),
            95..97 => {
                self.reference.read_only = !self.reference.read_only;
                self.line.flash_mut().read_only = self.reference.read_only;
                *seen.entry("flash takes nothing").or_default() += 1;
            }
            _ => self.request_from_the_future(seen),
        }
        let wake = self.reference.stream.map(|_| 5_000);
        assert_eq!(self.line.device_mut().wake_every_us(), wake, "{}", self.place());
    }

    /// Asks for everything that can be seen.
    pub fn look_at_everything(&mut self, seen: &mut Seen) {
        for offset in (0..1200).step_by(MAX_CHUNK) {
            self.exchange(self.next_number(), &Request::ReadBlob { offset }, seen);
        }
        for request in [Request::ReadState, Request::ReadStorage, Request::Identify] {
            self.exchange(self.next_number(), &request, seen);
        }
    }

    /// The next request of a host that writes its calibration.
    fn towards_the_goal(&mut self, dice: &mut Dice, seen: &mut Seen) {
        let wanted = &self.pool.sent[self.goal];
        let written = self.reference.incoming.len();
        let request = match self.reference.lock {
            Lock::Locked => Request::Challenge,
            Lock::Challenged { nonce, .. } => Request::Unlock { answer: unlock_answer(nonce, example::SERIAL) },
            Lock::Open { .. } if self.reference.incoming == *wanted => {
                self.goal = dice.roll(self.pool.sent.len() as u64) as usize;
                if dice.percent(15) && !self.reference.read_only {
                    return self.power_fails_at_a_commit(written as u16, dice, seen);
                }
                if dice.percent(25) { Request::RollBack } else { Request::CommitBlob { length: written as u16 } }
            }
            Lock::Open { .. } => {
                let offset = if wanted.starts_with(&self.reference.incoming) { written } else { 0 };
                let rest = &wanted[offset..];
                let piece = &rest[..rest.len().min(MAX_CHUNK)];
                Request::WriteBlob { offset: offset as u16, bytes: piece.try_into().expect("a piece") }
            }
        };
        self.ask(&request, dice, seen);
    }

    fn any_request(&self, dice: &mut Dice) -> Request {
        let written = self.reference.incoming.len() as u16;
        match dice.roll(17) {
            0 => Request::Identify,
            1 => Request::ReadState,
            2 => Request::Measure,
            3 => Request::Restart,
            4..7 => Request::Replay(dice.pick(&self.samples)),
            7 => {
                let bytes = (0..dice.roll(MAX_CHUNK as u64 + 1)).map(|byte| byte as u8).collect();
                let offset = dice.pick(&[0, written, written / 2, written.saturating_add(1), 1_000, 1_092, u16::MAX]);
                Request::WriteBlob { offset, bytes }
            }
            8 => {
                let length =
                    dice.pick(&[0, 8, written, written.saturating_sub(1), written.saturating_add(1), u16::MAX]);
                Request::CommitBlob { length }
            }
            9 => Request::ReadBlob { offset: dice.pick(&[0, 1, 128, 300, 420, 600, 1_092, u16::MAX]) },
            10 => Request::ReadStorage,
            11 => Request::Challenge,
            12 => Request::Unlock { answer: dice.roll(1 << 32) as u32 },
            13 => Request::RollBack,
            14 | 15 => {
                let what = dice.pick(&[Streamed::Readings, Streamed::Samples]);
                Request::Stream { what, period_ms: dice.pick(&[0, 9, 10, 20, 1_000, 3_600_000, 3_600_001, u32::MAX]) }
            }
            _ => Request::Stop,
        }
    }

    /// Asks under a number that usually is the next one.
    fn ask(&mut self, request: &Request, dice: &mut Dice, seen: &mut Seen) {
        let number = match dice.roll(100) {
            0..93 => self.next_number(),
            93..96 => self.answered,
            96..98 => 0,
            _ => dice.roll(1 << 16) as u16,
        };
        self.exchange(number, request, seen);
    }

    fn next_number(&self) -> u16 {
        self.answered.checked_add(1).unwrap_or(1)
    }

    fn exchange(&mut self, sequence: u16, request: &Request, seen: &mut Seen) {
        let frame = encode_frame(&Envelope { sequence, body: request.clone() }).expect("it fits");
        let answer = self.sent(&frame).unwrap_or_else(|| panic!("no answer to {request:?}, {}", self.place()));
        if sequence != 0 && sequence == self.answered {
            *seen.entry("repeated").or_default() += 1;
            assert_eq!(answer, self.answer, "a repetition, {}", self.place());
            return;
        }
        let given = decoded(&answer);
        assert_eq!(given.sequence, sequence);
        if sequence == 0 {
            self.reference.stream = None;
        }
        let body = self.reference.answer(request, sequence, self.time_us, &given.body);
        *seen.entry(name(request, &body)).or_default() += 1;
        let expected = encode_response(&Envelope { sequence, body: body.clone() }).expect("it fits");
        let place = self.place();
        assert!(answer == expected[..], "{request:?}, {place}\nanswered {:?}\nexpected {body:?}", given.body);
        (self.answered, self.answer) = (sequence, answer);
    }

    /// What comes back for these bytes.
    fn sent(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        let device = self.line.device_mut();
        let mut answers = bytes.iter().filter_map(|byte| device.receive(*byte, self.time_us).map(<[u8]>::to_vec));
        let answer = answers.next();
        assert_eq!(answers.next(), None, "one answer to one frame");
        answer
    }

    fn request_from_the_future(&mut self, seen: &mut Seen) {
        let sequence = self.next_number();
        let answer = self.sent(&encode_frame(&Envelope { sequence, body: (99_u8, 1_u8) }).expect("it fits"));
        let body = Response::Refused(Refusal::UnknownRequest);
        let expected = encode_response(&Envelope { sequence, body }).expect("it fits").to_vec();
        assert_eq!(answer, Some(expected.clone()), "{}", self.place());
        (self.answered, self.answer) = (sequence, expected);
        *seen.entry("UnknownRequest").or_default() += 1;
    }

    /// A frame that is cut, or of which one bit is turned over: no answer, nothing happens.
    fn spoilt_frame(&mut self, dice: &mut Dice, seen: &mut Seen) {
        let body = self.any_request(dice);
        let mut frame = encode_frame(&Envelope { sequence: self.next_number(), body }).expect("it fits").to_vec();
        let at = dice.roll(frame.len() as u64 - 1) as usize;
        if dice.percent(50) {
            frame[at] ^= 1 << dice.roll(8);
        } else {
            frame.remove(at);
        }
        frame.push(0);
        assert_eq!(self.sent(&frame), None, "{}", self.place());
        *seen.entry("spoilt").or_default() += 1;
    }

    fn power_cycle(&mut self, seen: &mut Seen) {
        self.line.power_cycle();
        self.reference.power_cycled();
        (self.answered, self.answer) = (0, Vec::new());
        *seen.entry("power cycle").or_default() += 1;
    }

    /// Power fails in the course of a commit. The old or the new one is there then; which, the instrument knows.
    fn power_fails_at_a_commit(&mut self, length: u16, dice: &mut Dice, seen: &mut Seen) {
        let before = (self.reference.slots.clone(), self.reference.erases);
        let steps = self.line.flash_mut().steps();
        self.line.flash_mut().fail_power_at(steps + dice.roll(800));
        let sequence = self.next_number();
        let commit = encode_frame(&Envelope { sequence, body: Request::CommitBlob { length } }).expect("it fits");
        let given = decoded(&self.sent(&commit).expect("an answer"));
        self.reference.answer(&Request::CommitBlob { length }, sequence, self.time_us, &given.body);
        let after = (self.reference.slots.clone(), self.reference.erases);
        if given.body != Response::Done {
            (self.reference.slots, self.reference.erases) = before;
        }
        self.power_cycle(seen);
        match given.body {
            Response::Done => *seen.entry("power fails at a commit: new").or_default() += 1,
            Response::UntilPowerOff => {
                self.learn_what_is_left(after);
                *seen.entry("power fails at a commit: old").or_default() += 1;
            }
            _ => {}
        }
        self.look_at_everything(seen);
    }

    /// What a cut leaves of the slot that was not in use, and of the count of its erases, is the instrument's to say.
    fn learn_what_is_left(&mut self, after: ([Option<Kept>; 2], [u32; 2])) {
        let sequence = self.next_number();
        let ask = encode_frame(&Envelope { sequence, body: Request::ReadStorage }).expect("it fits");
        let answer = self.sent(&ask).expect("an answer");
        let Response::Storage(state) = decoded(&answer).body else { panic!("no state") };
        (self.answered, self.answer) = (sequence, answer);
        let target = self.reference.stored.map_or(1, |slot| 1 - slot);
        if after.0[target].as_ref().is_some_and(|new| new.sequence == state.sequence) {
            // The last bit was written and the instrument did not live to see it.
            (self.reference.slots, self.reference.erases) = after;
            self.reference.power_cycled();
            return;
        }
        // A cut between an erase and its mark hides what only the erased slot knew.
        let known = self.reference.erases;
        assert!(state.erases[target] <= known[target] + 1, "{}", self.place());
        assert_eq!(state.erases[1 - target], known[1 - target], "{}", self.place());
        self.reference.erases = state.erases;
        let slot = &mut self.reference.slots[target];
        *slot = slot.take().filter(|_| state.can_roll_back);
        // Without its record a calibration in the first slot is as if a programmer had put it there.
        let record_at = storage::SLOT_USED as usize - 48;
        if let (0, Some(kept)) = (target, slot)
            && self.line.flash_mut().bytes()[record_at..record_at + 48].iter().all(|byte| *byte == 0xFF)
        {
            kept.sequence = 0;
        }
    }

    fn let_sensors_see_something(&mut self, dice: &mut Dice) {
        let f_uhz = 41_000_000_000 + dice.roll(300_000_000);
        self.line.counter_mut().finish_gate(f_uhz, 41_162_000_000);
        self.line.thermometer_mut().convert(dice.roll(140_000_000) as i32 - 50_000_000);
    }

    fn poll(&mut self, seen: &mut Seen) {
        let (time_us, place) = (self.time_us, self.place());
        let device = self.line.device_mut();
        // What a message does not carry: the sample that its reading was made of.
        let sample = device.sensors_mut().clone().sample(time_us);
        let unasked = device.poll(time_us).map(<[u8]>::to_vec);
        let Some(stream) = self.reference.stream.as_mut() else {
            assert_eq!(unasked, None, "nobody asked for a stream, {place}");
            return;
        };
        let last_us = stream.last_us.unwrap_or(stream.began_us.wrapping_sub(stream.period_us));
        let Some(unasked) = unasked else {
            // A clock that was set back may stand before the message before.
            let passed_us = time_us.wrapping_sub(last_us).cast_signed();
            assert!(passed_us < (stream.period_us * 3 / 2).cast_signed(), "silent for {passed_us} µs, {place}");
            return;
        };
        let message = decoded(&unasked);
        assert_eq!(message.sequence, stream.sequence, "{place}");
        let number = stream.next;
        stream.next += 1;
        stream.last_us = Some(time_us);
        let what = stream.what;
        let reading = self.reference.reading(&sample);
        let (body, name) = match what {
            Streamed::Readings => (Response::StreamedReading { number, reading }, "StreamedReading"),
            Streamed::Samples => (Response::StreamedSample { number, sample }, "StreamedSample"),
        };
        let expected = encode_response(&Envelope { sequence: message.sequence, body }).expect("it fits");
        assert!(unasked == expected[..], "{place}: streamed {message:?}");
        *seen.entry(name).or_default() += 1;
    }

    fn place(&self) -> String {
        format!("conversation {}, step {}", self.seed, self.steps)
    }
}

fn decoded(answer: &[u8]) -> Envelope<Response> {
    let mut decoder = Decoder::new();
    answer.iter().find_map(|byte| decoder.push(*byte)).expect("a whole frame").expect("a sound one")
}

/// What an exchange counts as.
fn name(request: &Request, body: &Response) -> &'static str {
    match (request, body) {
        (Request::CommitBlob { .. }, Response::Done) => "committed",
        (Request::RollBack, Response::Done) => "rolled back",
        (_, Response::Identity(_)) => "Identity",
        (_, Response::State(_)) => "State",
        (_, Response::Measured { .. }) => "Measured",
        (_, Response::Reading(_)) => "Reading",
        (_, Response::Done) => "Done",
        (_, Response::Piece { .. }) => "Piece",
        (_, Response::Storage(_)) => "Storage",
        (_, Response::Nonce { .. }) => "Nonce",
        (_, Response::UntilPowerOff) => "UntilPowerOff",
        (_, Response::Refused(refusal)) => refused(*refusal),
        _ => "other",
    }
}

const fn refused(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::Offset(_) => "Offset",
        Refusal::NotABlob => "NotABlob",
        Refusal::Truncated => "Truncated",
        Refusal::Unusable => "Unusable",
        Refusal::OtherSerial => "OtherSerial",
        Refusal::Locked => "Locked",
        Refusal::WrongAnswer => "WrongAnswer",
        Refusal::NothingBefore => "NothingBefore",
        Refusal::StorageFailed => "StorageFailed",
        Refusal::Unsigned => "Unsigned",
        Refusal::NoCalibration => "NoCalibration",
        Refusal::Period { .. } => "Period",
        _ => "another refusal",
    }
}
