//! Claim: over a line that flips, loses, repeats and reorders bytes, every conversation completes or fails cleanly.
//!
//! Cleanly: the instrument then holds the old or the new calibration, gives its bits, and no step was done twice.

use firmware_core::Compensator;
use firmware_sim::link::{Content, Kept, Link, LinkError, Transport};
use firmware_sim::virtual_faulty_line::{FaultyLine, LineFaults};
use firmware_sim::virtual_line::VirtualLine;
use protocol::{Blob, Envelope, Refusal, Request, Response, Sample, Streamed, encode_request};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use tests::example;

const ONE_IN_A_HUNDRED: u32 = 10_000;

fn other() -> Blob {
    Blob { provenance: *b"exampl-2", ..example::with_expression() }
}

fn assert_bits<T: Transport>(link: &mut Link<T>, samples: &[Sample], blob: &Blob) {
    let mut host = Compensator::load(blob).expect("the example is sound");
    for sample in samples {
        let found = link.replay(sample).expect("it gets through");
        assert!(found.same_bits(&host.compensate(sample)), "{sample:?}");
    }
}

#[test]
fn a_bad_line_changes_no_bit_and_repeats_no_step() {
    let samples = example::samples(500);
    for seed in 0..4 {
        let line = FaultyLine::new(VirtualLine::new(example::SERIAL), LineFaults::each(1000), seed);
        let mut link = Link::new(line).with_tries(50);
        link.upload_blob(&example::blob()).expect("repetition gets it through");
        assert_bits(&mut link, &samples, &example::blob());
        assert_eq!(link.state().expect("repetition gets it through").readings, samples.len() as u32);
    }
}

/// How often each conversation came to its end.
#[derive(Debug, Default)]
struct Completed {
    uploads: u32,
    replays: u32,
    steps_back: u32,
}

/// A calibrated instrument, then a whole conversation over a bad line, then a look over a good one.
fn converse(faults: LineFaults, seed: u64, completed: &mut Completed) {
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    link.upload_blob(&example::blob()).expect("a perfect line");
    let mut bad = Link::new(FaultyLine::new(link.into_transport(), faults, seed)).with_tries(10);
    let uploaded = bad.upload_blob(&other());
    assert!(matches!(uploaded, Ok(Kept::ForGood) | Err(LinkError::NoAnswer { .. })), "{uploaded:?}");
    completed.uploads += u32::from(uploaded.is_ok());
    let sample = example::samples(2)[1];
    if let Ok(reading) = bad.replay(&sample) {
        let of = [example::blob(), other()]
            .map(|blob| Compensator::load(&blob).expect("the example is sound").compensate(&sample));
        assert!(of.iter().any(|host| host.same_bits(&reading)), "{reading:?}");
        completed.replays += 1;
    }
    let back = bad.roll_back();
    assert!(
        matches!(back, Ok(()) | Err(LinkError::NoAnswer { .. } | LinkError::Refused(Refusal::NothingBefore))),
        "{back:?}"
    );
    completed.steps_back += u32::from(back.is_ok());
    let mut good = Link::new(bad.into_transport().into_line());
    let held = good.read_calibration().expect("never none");
    let blobs = [example::blob(), other()];
    let blob = blobs.iter().find(|blob| example::stored(blob) == held).expect("the old or the new one, to the byte");
    assert!(uploaded.is_err() || back.is_err() || *blob == blobs[0], "uploaded and taken back");
    good.restart().expect("a perfect line");
    assert_bits(&mut good, &example::samples(50), blob);
}

#[test]
fn at_one_in_a_hundred_conversations_complete_or_fail_cleanly() {
    let alone = LineFaults::default();
    let table = [
        ("flips", LineFaults { flip_ppm: ONE_IN_A_HUNDRED, ..alone }),
        ("loss", LineFaults { loss_ppm: ONE_IN_A_HUNDRED, ..alone }),
        ("duplication", LineFaults { duplication_ppm: ONE_IN_A_HUNDRED, ..alone }),
        ("reordering", LineFaults { reordering_ppm: ONE_IN_A_HUNDRED, ..alone }),
        ("all of them", LineFaults::each(ONE_IN_A_HUNDRED)),
    ];
    for (what, faults) in table {
        let mut completed = Completed::default();
        (0..100).for_each(|seed| converse(faults, seed, &mut completed));
        // The test would prove nothing if hardly anything got through.
        let Completed { uploads, replays, steps_back } = completed;
        assert!(uploads > 30 && replays > 30 && steps_back > 30, "{what}: {completed:?}");
    }
}

#[test]
fn a_stream_over_a_bad_line_loses_messages_visibly_and_changes_none() {
    let line = FaultyLine::new(VirtualLine::new(example::SERIAL), LineFaults::each(1000), 7);
    let mut link = Link::new(line).with_tries(50);
    link.upload_blob(&example::blob()).expect("repetition gets it through");
    link.stream(Streamed::Samples, 1000).expect("repetition gets it through");
    let (mut came, mut last) = (0, None);
    for second in 0..2000_u64 {
        let line = link.transport_mut().line_mut();
        line.set_time_us(second * 1_000_000);
        line.counter_mut().finish_gate(41_238_000_000, 41_162_000_000 + second);
        line.thermometer_mut().convert(25_000_000);
        while let Some(message) = link.next_unasked().expect("this line can't fail") {
            let Content::Sample(sample) = message.content else { panic!("{message:?}") };
            assert_eq!(sample.time_us, u64::from(message.number) * 1_000_000);
            assert!(last.is_none_or(|last| message.number > last), "{last:?}, then {message:?}");
            (came, last) = (came + 1, Some(message.number));
        }
    }
    assert!((1000..2000).contains(&came), "{came} of 2000 came");
    link.stop().expect("repetition gets it through");
}

#[test]
fn what_was_said_once_and_comes_again_writes_nothing() {
    let mut line = Recorder { line: VirtualLine::new(example::SERIAL), sent: Vec::new() };
    let mut link = Link::new(&mut line);
    link.upload_blob(&example::blob()).expect("a perfect line");
    let first = std::mem::take(&mut link.transport_mut().sent);
    link.upload_blob(&other()).expect("a perfect line");
    // The whole first conversation once more, at another time: greeting, challenge, answer, pieces, commit.
    line.line.set_time_us(1_000_000);
    for _ in 0..3 {
        let Ok(()) = line.line.send(&first);
    }
    while line.line.receive().expect("this line can't fail").is_some() {}
    assert_eq!(Link::new(&mut line).state().expect("a perfect line").provenance, Some(other().provenance));
}

#[test]
fn without_an_unlock_of_its_own_nothing_is_written() {
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    let piece = Request::WriteBlob { offset: 0, bytes: [1, 2, 3].into_iter().collect() };
    let locked = Ok(Response::Refused(Refusal::Locked));
    for request in [piece.clone(), Request::CommitBlob { length: 3 }, Request::RollBack] {
        assert_eq!(link.exchange(request), locked);
    }
    assert_eq!(link.exchange(Request::Unlock { answer: 0 }), Ok(Response::Refused(Refusal::WrongAnswer)));
    link.upload_blob(&example::blob()).expect("a perfect line");
    assert_eq!(link.exchange(piece.clone()), locked, "the commit closed it");
    link.unlock().expect("a perfect line");
    link.transport_mut().set_time_us(299_999_999);
    assert_eq!(link.exchange(piece.clone()), Ok(Response::Done));
    link.transport_mut().set_time_us(300_000_000);
    assert_eq!(link.exchange(piece), locked, "time closed it");
}

#[test]
fn a_million_bytes_of_noise_change_nothing() {
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    link.upload_blob(&example::blob()).expect("a perfect line");
    let mut line = link.into_transport();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let requests = [Request::Challenge, Request::CommitBlob { length: 200 }, Request::RollBack, Request::Stop];
    for round in 0..2000_u16 {
        // Noise, and amid it requests that nobody asked for.
        let noise: Vec<u8> =
            (0..500).map(|_| random.next_u64() as u8 & if round % 2 == 0 { 0xFF } else { 7 }).collect();
        let body = requests[usize::from(round) % requests.len()].clone();
        let stray = encode_request(&Envelope { sequence: round, body }).expect("it fits");
        line.set_time_us(u64::from(round) * 1000);
        let Ok(()) = line.send(&[&noise[..], &[0], &stray, &noise].concat());
    }
    while line.receive().expect("this line can't fail").is_some() {}
    let mut link = Link::new(line);
    assert_eq!(link.read_calibration(), Ok(example::blob_bytes()));
    assert_eq!(link.storage().expect("a perfect line").erases, [0, 1]);
    assert_bits(&mut link, &example::samples(50), &example::blob());
}

/// Keeps what was sent.
struct Recorder {
    line: VirtualLine,
    sent: Vec<u8>,
}

impl Transport for Recorder {
    type Error = std::convert::Infallible;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        self.sent.extend(bytes);
        self.line.send(bytes)
    }

    fn receive(&mut self) -> Result<Option<u8>, Self::Error> {
        self.line.receive()
    }
}
