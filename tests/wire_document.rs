//! Claim: `docs/wire.md` says what the code does: its numbers, limits and example bytes are the code's.

use firmware_core::program::{Input, Step};
use protocol::limits::{self, MAX_CHANNELS};
use protocol::{
    Decoder, Envelope, FrameError, Identity, InstrumentState, Reading, Refusal, Request, Response, Sample, Source,
    Status, StorageState, Streamed, encode_frame, unlock_answer,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fmt::Debug;
use tests::workspace::text;

/// The rows of the tables below a heading, as cells without their code marks.
fn rows(heading: &str) -> Vec<Vec<String>> {
    let page = text("docs/wire.md");
    let section = page.split("\n## ").find(|section| section.starts_with(heading)).expect("the page has the heading");
    let rows = section.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |"));
    rows.map(|row| row.split(" | ").map(|cell| cell.trim().replace('`', "")).collect()).collect()
}

/// Number and name of every numbered row below a heading.
fn numbered(heading: &str) -> BTreeMap<String, u32> {
    let rows = rows(heading);
    rows.iter().filter_map(|row| Some((row.get(1)?.clone(), row.first()?.parse().ok()?))).collect()
}

/// The name of an enum's variant.
fn name(message: &impl Debug) -> String {
    format!("{message:?}").split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}

/// The number that a message has on the wire.
fn number(message: &impl Serialize) -> u32 {
    let bytes = postcard::to_slice(message, &mut [0; 512]).expect("it fits").to_vec();
    postcard::take_from_bytes(&bytes).expect("a number comes first").0
}

fn sample() -> Sample {
    let pair = Sample::from_pair(1_500_000, 41_238_000_123, 41_162_000_000, 24_998_437);
    Sample { age_s: Some(365 * 86_400), channels: [0; MAX_CHANNELS], ..pair }
}

fn reading() -> Reading {
    Reading { time_us: 1_500_000, acceleration_g: 1.5, status: Status::SETTLING }
}

fn requests() -> [Request; 14] {
    [
        Request::Identify,
        Request::ReadState,
        Request::Measure,
        Request::Restart,
        Request::Replay(sample()),
        Request::WriteBlob { offset: 128, bytes: [0xDE, 0xAD, 0x00, 0xEF].into_iter().collect() },
        Request::CommitBlob { length: 400 },
        Request::ReadBlob { offset: 128 },
        Request::ReadStorage,
        Request::Challenge,
        Request::Unlock { answer: unlock_answer(NONCE, SERIAL) },
        Request::RollBack,
        Request::Stream { what: Streamed::Samples, period_ms: 1000 },
        Request::Stop,
    ]
}

fn responses() -> [Response; 12] {
    let serial = SERIAL.try_into().expect("a short name");
    let provenance = Some(*b"exampl-1");
    [
        Response::Identity(Identity { serial, blob_layout: 2, effects: 22 }),
        Response::State(InstrumentState { provenance, readings: 2500, raised: Status::SETTLING }),
        Response::Measured { sample: sample(), reading: reading() },
        Response::Reading(reading()),
        Response::Done,
        Response::Refused(Refusal::Offset(128)),
        Response::Piece { offset: 128, length: 132, bytes: [0xDE, 0xAD, 0x00, 0xEF].into_iter().collect() },
        Response::Storage(StorageState {
            source: Source::Committed,
            sequence: 3,
            can_roll_back: true,
            erases: [1, 2],
            key: None,
        }),
        Response::Nonce { nonce: NONCE },
        Response::UntilPowerOff,
        Response::StreamedReading { number: 7, reading: reading() },
        Response::StreamedSample { number: 7, sample: sample() },
    ]
}

const SERIAL: &str = "EXAMPLE-1";
const NONCE: u64 = 0x0123_4567_89AB_CDEF;

const REFUSALS: [Refusal; 15] = [
    Refusal::Offset(0),
    Refusal::NotABlob,
    Refusal::Truncated,
    Refusal::Layout(0),
    Refusal::Checksum,
    Refusal::Unusable,
    Refusal::OtherSerial,
    Refusal::UnknownRequest,
    Refusal::Locked,
    Refusal::WrongAnswer,
    Refusal::NothingBefore,
    Refusal::StorageFailed,
    Refusal::Unsigned,
    Refusal::NoCalibration,
    Refusal::Period { shortest_ms: 10, longest_ms: 3_600_000 },
];

#[test]
fn every_message_has_the_documented_number() {
    let by_name = |numbers: Vec<(String, u32)>| numbers.into_iter().collect::<BTreeMap<_, _>>();
    let sources = [Source::Nothing, Source::Factory, Source::Committed, Source::UntilPowerOff];
    assert_eq!(by_name(sources.iter().map(|s| (name(s), number(s))).collect()), numbered("Storage"));
    assert_eq!(by_name(requests().iter().map(|r| (name(r), number(r))).collect()), numbered("Requests"));
    let mut answers: Vec<_> = responses().iter().map(|r| (name(r), number(r))).collect();
    answers.extend(REFUSALS.iter().map(|r| (name(r), number(r))));
    assert_eq!(by_name(answers), numbered("Responses"));
}

#[test]
fn every_flag_has_the_documented_bit() {
    let flags: BTreeMap<_, _> =
        Status::all().iter_names().map(|(name, flag)| (name.to_owned(), flag.bits().trailing_zeros())).collect();
    assert_eq!(flags, numbered("Sample, Reading, Status"));
}

#[test]
fn every_step_of_a_program_has_the_documented_byte() {
    let byte = |text: &str| u8::from_str_radix(text.strip_prefix("0x")?, 16).ok();
    let documented: BTreeMap<u8, String> =
        rows("Program").iter().filter_map(|row| Some((byte(row.first()?)?, row.get(1)?.clone()))).collect();
    let last =
        |step: &Step| format!("{step:?}").trim_end_matches(')').rsplit('(').next().unwrap_or_default().to_owned();
    let name = |step: Step| match step {
        Step::Constant(_) => "Constant".to_owned(),
        Step::Read(Input::Channel(_)) => "Channel".to_owned(),
        _ => last(&step),
    };
    // A channel's index is in its byte, a constant's number behind it.
    let known = |byte: &u8| Some((*byte, name(Step::next(&[*byte, 0, 0, 0, 0])?.0)));
    let known: BTreeMap<u8, String> = (0..=0x80).filter_map(|byte| known(&byte)).collect();
    assert_eq!(documented, known);
    let channels = (0x81..=0xFF).filter(|byte| Step::next(&[*byte]).is_some()).count();
    assert_eq!(channels + 1, limits::MAX_CHANNELS);
}

#[test]
fn every_limit_has_the_documented_value() {
    let table = [
        ("MAX_TERMS", limits::MAX_TERMS),
        ("MAX_PARAMETERS", limits::MAX_PARAMETERS),
        ("MAX_PROGRAM", limits::MAX_PROGRAM),
        ("MAX_CHANNELS", limits::MAX_CHANNELS),
        ("MAX_NAME", limits::MAX_NAME),
        ("MAX_BLOB", limits::MAX_BLOB),
        ("MAX_STORED", limits::MAX_STORED),
        ("MAX_CHUNK", limits::MAX_CHUNK),
        ("MAX_FRAME", limits::MAX_FRAME),
        ("MAX_LINE", limits::MAX_LINE),
    ];
    let documented: Vec<_> = rows("Limits").into_iter().filter(|row| row[0].starts_with("MAX_")).collect();
    assert_eq!(documented, table.map(|(name, value)| vec![name.to_owned(), value.to_string()]));
}

#[test]
fn the_example_bytes_are_what_is_sent_and_what_is_understood() {
    let documented: BTreeMap<String, Vec<u8>> = rows("Examples")
        .into_iter()
        .filter(|row| row[1].ends_with(" 00"))
        .map(|row| (name(&format_args!("{}", row[0])), bytes(&row[1])))
        .collect();
    assert_eq!(documented.len(), requests().len() + responses().len());
    for request in requests() {
        assert_documented(&documented, request);
    }
    for response in responses() {
        assert_documented(&documented, response);
    }
}

fn assert_documented<T>(documented: &BTreeMap<String, Vec<u8>>, body: T)
where
    T: Serialize + DeserializeOwned + Clone + PartialEq + Debug,
{
    let line = &documented[&name(&body)];
    let message = Envelope { sequence: 300, body };
    let sent = encode_frame(&message).expect("it fits");
    assert_eq!(*line, *sent, "{message:?} is {}", hex(&sent));
    let mut decoder = Decoder::new();
    let understood: Vec<Result<Envelope<T>, FrameError>> = line.iter().filter_map(|byte| decoder.push(*byte)).collect();
    assert_eq!(understood, [Ok(message)]);
}

fn bytes(hex: &str) -> Vec<u8> {
    hex.split(' ').map(|byte| u8::from_str_radix(byte, 16).expect("two hexadecimal digits")).collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x} ")).collect()
}
