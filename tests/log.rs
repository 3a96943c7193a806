//! Claim: the image that logs says when power came, which calibration it uses or why it refuses one, and what fails.

use defmt_decoder::{DecodeError, Table};
use firmware_sim::link::Link;
use protocol::Blob;
use std::time::Duration;
use tests::example;
use tests::qemu::{Microcontroller, image};

const PATIENCE: Duration = Duration::from_secs(10);

/// The lines of a log, as a debugger's console shows them.
fn lines(log: &[u8]) -> Vec<String> {
    let elf = std::fs::read(image("firmware-logging")).expect("a readable image");
    let table = Table::parse(&elf).expect("a sound image").expect("an image with log strings");
    let mut decoder = table.new_stream_decoder();
    decoder.received(log);
    let mut lines = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => lines.push(frame.display_message().to_string()),
            Err(DecodeError::UnexpectedEof) => return lines,
            Err(DecodeError::Malformed) => panic!("not a log after {lines:?}"),
        }
    }
}

/// What is logged from power-on with this stored calibration until it has measured twice.
fn logged(identity: &str, calibration: &[u8]) -> Vec<String> {
    let mut microcontroller = Microcontroller::start_logging(identity.as_bytes(), calibration, PATIENCE);
    let mut link = Link::new(&mut microcontroller);
    for _ in 0..2 {
        link.measure().expect("an answer");
    }
    lines(&microcontroller.end())
}

/// The example, spoilt and sealed again.
fn spoilt(spoil: fn(&mut Blob)) -> Vec<u8> {
    let mut blob = example::blob();
    spoil(&mut blob);
    example::stored(&blob)
}

#[test]
fn power_calibration_and_faults_are_logged_once_each() {
    let in_use = "calibration [65, 78, 61, 6d, 70, 6c, 2d, 31] in use";
    let table = [
        (example::blob_bytes(), in_use),
        (vec![], "no stored calibration can be used"),
        (example::blob_bytes()[..100].to_vec(), "no stored calibration can be used"),
        (spoilt(|blob| blob.terms[0].effect = 999), "calibration refused: UnknownEffect(999)"),
        (spoilt(|blob| blob.proof ^= 1), "calibration refused: Proof"),
        (spoilt(|blob| blob.serial.push('2').expect("room")), "calibration refused: it belongs to another sensor"),
    ];
    for (calibration, verdict) in table {
        let found = logged(example::SERIAL, &calibration);
        assert_eq!(found[0], "power on");
        assert!(found[1].starts_with(verdict), "{found:?}, expected {verdict}");
        let raised =
            |name: &str| found.iter().filter(|line| **line == format!("raised for the first time: {name}")).count();
        // The board that QEMU emulates has no sensors.
        assert_eq!((raised("THERMOMETER_FAULT"), raised("RESONATOR_FAULT")), (1, 1), "{found:?}");
        assert_eq!(raised("UNCALIBRATED"), usize::from(verdict != in_use), "{found:?}");
    }
}
