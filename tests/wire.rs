//! Claim: the bytes on the line are the documented ones, and no bytes whatever disturb the decoder for long.

use proptest::prelude::*;
use protocol::limits::{MAX_CHUNK, MAX_FRAME, MAX_LINE};
use protocol::{
    Decoder, Envelope, FrameError, Identity, InstrumentState, Reading, Refusal, Request, Response, Sample, Source,
    Status, StorageState, Streamed, crc32, encode_frame, encode_request, encode_response,
};
use serde::{Serialize, de::DeserializeOwned};

/// A message body of any length that a frame can carry.
type Raw = heapless::Vec<u8, MAX_FRAME>;

/// The longest raw body: two bytes of sequence number and two of length are the most that stand before it.
const LONGEST_RAW: usize = MAX_FRAME - 4 - 4;

fn decode<T: DeserializeOwned>(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Result<Envelope<T>, FrameError>> {
    bytes.iter().filter_map(|byte| decoder.push(*byte)).collect()
}

fn assert_round_trip<T>(message: &Envelope<T>, line: &[u8])
where
    T: Serialize + DeserializeOwned + PartialEq + Clone + std::fmt::Debug,
{
    let (last, stuffed) = line.split_last().expect("a frame has bytes");
    assert!(*last == 0 && !stuffed.contains(&0) && line.len() <= MAX_LINE);
    assert_eq!(decode(&mut Decoder::new(), line), [Ok(message.clone())]);
    // A decoder written from the textbook finds the same body, closed by its checksum.
    let body = unstuff(stuffed);
    let (message, checksum) = body.split_last_chunk::<4>().expect("a checksum");
    assert_eq!(crc32(message).to_le_bytes(), *checksum);
}

/// Consistent overhead byte stuffing as Cheshire and Baker describe its reversal.
fn unstuff(mut stuffed: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    while let Some((code, rest)) = stuffed.split_first() {
        let (data, rest) = rest.split_at(usize::from(*code) - 1);
        body.extend_from_slice(data);
        if *code != 0xFF && !rest.is_empty() {
            body.push(0);
        }
        stuffed = rest;
    }
    body
}

fn any_status() -> impl Strategy<Value = Status> {
    any::<u16>().prop_map(Status::from_bits_retain)
}

prop_compose! {
    fn any_sample()(
        (time_us, power_on_us, age_s) in any::<(u64, u64, Option<u32>)>(),
        (delta_f_uhz, sum_f_uhz, temperature_uc) in any::<(i64, Option<u64>, i32)>(),
        channels in any::<[i64; 8]>(),
        faults in any_status(),
    ) -> Sample {
        Sample { time_us, power_on_us, age_s, delta_f_uhz, sum_f_uhz, temperature_uc, channels, faults }
    }
}

prop_compose! {
    // Not NaN, whose equality proves nothing; its bits have a test of their own.
    fn any_reading()(
        time_us in any::<u64>(), acceleration_g in any::<f32>(), status in any_status(),
    ) -> Reading {
        Reading { time_us, acceleration_g, status }
    }
}

fn any_streamed() -> impl Strategy<Value = Streamed> {
    prop_oneof![Just(Streamed::Readings), Just(Streamed::Samples)]
}

fn any_request() -> impl Strategy<Value = Request> {
    let bytes = proptest::collection::vec(any::<u8>(), 0..=MAX_CHUNK);
    prop_oneof![
        Just(Request::Identify),
        Just(Request::ReadState),
        Just(Request::Measure),
        Just(Request::Restart),
        any_sample().prop_map(Request::Replay),
        (any::<u16>(), bytes)
            .prop_map(|(offset, bytes)| Request::WriteBlob { offset, bytes: bytes.into_iter().collect() }),
        any::<u16>().prop_map(|length| Request::CommitBlob { length }),
        any::<u16>().prop_map(|offset| Request::ReadBlob { offset }),
        Just(Request::ReadStorage),
        Just(Request::Challenge),
        any::<u32>().prop_map(|answer| Request::Unlock { answer }),
        Just(Request::RollBack),
        (any_streamed(), any::<u32>()).prop_map(|(what, period_ms)| Request::Stream { what, period_ms }),
        Just(Request::Stop),
    ]
}

fn any_refusal() -> impl Strategy<Value = Refusal> {
    prop_oneof![
        any::<u16>().prop_map(Refusal::Offset),
        Just(Refusal::NotABlob),
        Just(Refusal::Truncated),
        any::<u16>().prop_map(Refusal::Layout),
        Just(Refusal::Checksum),
        Just(Refusal::Unusable),
        Just(Refusal::OtherSerial),
        Just(Refusal::UnknownRequest),
        Just(Refusal::Locked),
        Just(Refusal::WrongAnswer),
        Just(Refusal::NothingBefore),
        Just(Refusal::StorageFailed),
        Just(Refusal::Unsigned),
        Just(Refusal::NoCalibration),
        any::<(u32, u32)>().prop_map(|(shortest_ms, longest_ms)| Refusal::Period { shortest_ms, longest_ms }),
    ]
}

fn any_storage() -> impl Strategy<Value = StorageState> {
    let source =
        prop_oneof![Just(Source::Nothing), Just(Source::Factory), Just(Source::Committed), Just(Source::UntilPowerOff)];
    (source, any::<(u32, bool, [u32; 2], Option<[u8; 8]>)>()).prop_map(
        |(source, (sequence, can_roll_back, erases, key))| StorageState {
            source,
            sequence,
            can_roll_back,
            erases,
            key,
        },
    )
}

fn any_response() -> impl Strategy<Value = Response> {
    let identity = ("[ -~]{0,24}", any::<(u16, u16)>()).prop_map(|(serial, (blob_layout, effects))| {
        let serial = serial.as_str().try_into().expect("at most 24 bytes");
        Response::Identity(Identity { serial, blob_layout, effects })
    });
    let state = (any::<(Option<[u8; 8]>, u32)>(), any_status())
        .prop_map(|((provenance, readings), raised)| Response::State(InstrumentState { provenance, readings, raised }));
    prop_oneof![
        identity,
        state,
        (any_sample(), any_reading()).prop_map(|(sample, reading)| Response::Measured { sample, reading }),
        any_reading().prop_map(Response::Reading),
        Just(Response::Done),
        any_refusal().prop_map(Response::Refused),
        (any::<(u16, u16)>(), proptest::collection::vec(any::<u8>(), 0..=MAX_CHUNK)).prop_map(
            |((offset, length), bytes)| Response::Piece { offset, length, bytes: bytes.into_iter().collect() }
        ),
        any_storage().prop_map(Response::Storage),
        any::<u64>().prop_map(|nonce| Response::Nonce { nonce }),
        Just(Response::UntilPowerOff),
        (any::<u32>(), any_reading()).prop_map(|(number, reading)| Response::StreamedReading { number, reading }),
        (any::<u32>(), any_sample()).prop_map(|(number, sample)| Response::StreamedSample { number, sample }),
    ]
}

proptest! {
    #[test]
    fn every_request_survives_the_line(sequence in any::<u16>(), body in any_request()) {
        let message = Envelope { sequence, body };
        assert_round_trip(&message, &encode_request(&message).expect("a request fits a frame"));
    }

    #[test]
    fn every_response_survives_the_line(sequence in any::<u16>(), body in any_response()) {
        let message = Envelope { sequence, body };
        assert_round_trip(&message, &encode_response(&message).expect("a response fits a frame"));
    }

    #[test]
    fn zeros_anywhere_survive_the_line(
        bytes in proptest::collection::vec(prop_oneof![Just(0_u8), any::<u8>()], 0..=LONGEST_RAW),
    ) {
        let message = Envelope { sequence: 1, body: bytes.into_iter().collect::<Raw>() };
        assert_round_trip(&message, &encode_frame(&message).expect("it fits"));
    }

    #[test]
    fn after_any_garbage_and_one_zero_the_next_frame_is_understood(
        garbage in proptest::collection::vec(any::<u8>(), 0..2000),
        sequence in any::<u16>(),
        body in any_request(),
    ) {
        let mut decoder = Decoder::new();
        // Whatever these are called, decoding them must not panic.
        let _ = decode::<Request>(&mut decoder, &garbage);
        let _ = decode::<Request>(&mut decoder, &[0]);
        let message = Envelope { sequence, body };
        let line = encode_request(&message).expect("it fits");
        prop_assert_eq!(decode(&mut decoder, &line), [Ok(message)]);
    }

    #[test]
    fn one_changed_lost_or_added_byte_is_never_taken_for_a_message(
        sequence in any::<u16>(), body in any_request(), place in any::<prop::sample::Index>(), change in 1..=255_u8,
    ) {
        let line = encode_request(&Envelope { sequence, body }).expect("it fits");
        let at = place.index(line.len() - 1);
        let (mut changed, mut lost, mut added) = (line.to_vec(), line.to_vec(), line.to_vec());
        changed[at] ^= change;
        lost.remove(at);
        added.insert(at, change);
        for damaged in [changed, lost, added] {
            // A zero in the middle makes two frames of one; neither may pass.
            let decoded = decode::<Request>(&mut Decoder::new(), &damaged);
            prop_assert!(decoded.iter().all(Result::is_err), "{decoded:?}");
        }
    }
}

#[test]
fn every_length_survives_the_line_whatever_it_is_made_of() {
    for fill in [0x00, 0x01, 0xFE, 0xFF] {
        for length in 0..=LONGEST_RAW {
            let body = std::iter::repeat_n(fill, length).collect::<Raw>();
            let message = Envelope { sequence: 0xFFFF, body };
            // 0xFFFF takes three bytes, so the longest one does not fit any more.
            match encode_frame(&message) {
                Ok(line) => assert_round_trip(&message, &line),
                Err(error) => assert_eq!((error, length), (FrameError::TooLong, LONGEST_RAW)),
            }
        }
    }
}

#[test]
fn runs_of_254_bytes_without_a_zero_survive_the_line() {
    // The checksum can't be chosen, so runs of every length are placed before a zero.
    for run in 240..=LONGEST_RAW {
        let body = (0..LONGEST_RAW).map(|i| u8::from(i != run)).collect::<Raw>();
        let message = Envelope { sequence: 1, body };
        assert_round_trip(&message, &encode_frame(&message).expect("it fits"));
    }
}

#[test]
fn the_bits_of_the_one_nan_survive_the_line() {
    let body = Response::Reading(Reading::none(1, Status::UNCALIBRATED));
    let line = encode_response(&Envelope { sequence: 1, body }).expect("it fits");
    match &decode(&mut Decoder::new(), &line)[..] {
        [Ok(Envelope { body: Response::Reading(reading), .. })] => {
            assert_eq!(reading.acceleration_g.to_bits(), 0x7FC0_0000);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_wrong_with_a_frame_is_said() {
    let table: [(&str, Vec<u8>, FrameError); 5] = [
        ("fewer bytes than a checksum", vec![3, 1, 1, 0], FrameError::Malformed),
        ("a code that promises more bytes", vec![9, 1, 1, 0], FrameError::Malformed),
        ("a wrong checksum", vec![7, 1, 1, 1, 1, 1, 1, 0], FrameError::Checksum),
        ("more bytes than a frame has", [vec![2; 2 * MAX_LINE], vec![0]].concat(), FrameError::TooLong),
        (
            "a message of no known number",
            encode_frame(&Envelope { sequence: 5, body: 99_u8 }).expect("it fits").to_vec(),
            FrameError::UnknownMessage { sequence: 5 },
        ),
    ];
    for (what, bytes, expected) in table {
        assert_eq!(decode::<Request>(&mut Decoder::new(), &bytes), [Err(expected)], "{what}");
    }
}

#[test]
fn idle_zeros_are_not_frames() {
    assert!(decode::<Request>(&mut Decoder::new(), &[0; 1000]).is_empty());
}

#[test]
fn the_longest_messages_fit_a_frame() {
    let sample = Sample {
        time_us: u64::MAX,
        power_on_us: u64::MAX,
        age_s: Some(u32::MAX),
        delta_f_uhz: i64::MIN,
        sum_f_uhz: Some(u64::MAX),
        temperature_uc: i32::MIN,
        channels: [i64::MIN; 8],
        faults: Status::from_bits_retain(u16::MAX),
    };
    let reading = Reading { time_us: u64::MAX, acceleration_g: f32::MAX, status: sample.faults };
    let bytes = [0xFF; MAX_CHUNK].into_iter().collect();
    let write = Request::WriteBlob { offset: u16::MAX, bytes };
    let piece = Response::Piece { offset: u16::MAX, length: u16::MAX, bytes: [0xFF; MAX_CHUNK].into_iter().collect() };
    assert!(encode_response(&Envelope { sequence: u16::MAX, body: piece }).is_ok());
    let streamed = Response::StreamedSample { number: u32::MAX, sample };
    assert!(encode_response(&Envelope { sequence: u16::MAX, body: streamed }).is_ok());
    assert!(encode_response(&Envelope { sequence: u16::MAX, body: Response::Measured { sample, reading } }).is_ok());
    assert!(encode_request(&Envelope { sequence: u16::MAX, body: Request::Replay(sample) }).is_ok());
    assert!(encode_request(&Envelope { sequence: u16::MAX, body: write }).is_ok());
}
