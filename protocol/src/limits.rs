//! Every bound of the protocol, in one place.

/// Hidden units of the network.
pub const HIDDEN: usize = 10;
/// Weights of the 2-10-1 network: 2·10 inputs, 10 thresholds, 10 outputs, 1 output threshold.
pub const WEIGHTS: usize = 2 * HIDDEN + HIDDEN + HIDDEN + 1;
/// Effect terms in one calibration.
pub const MAX_TERMS: usize = 8;
/// Coefficients of one effect term.
pub const MAX_PARAMETERS: usize = 6;
/// Bytes of one effect term's program.
pub const MAX_PROGRAM: usize = 32;
/// Auxiliary channels (supply voltage, pressure, …) of one sample.
pub const MAX_CHANNELS: usize = 8;
/// Bytes of a channel's name.
pub const MAX_NAME: usize = 24;
/// Bytes of a stored calibration, envelope included.
pub const MAX_BLOB: usize = 1024;
/// Bytes of a factory signature behind a blob: a mark of four and the 64 of Ed25519.
pub const SIGNATURE: usize = 68;
/// Bytes of a stored calibration with its signature.
pub const MAX_STORED: usize = MAX_BLOB + SIGNATURE;
/// Bytes of calibration carried by one message.
pub const MAX_CHUNK: usize = 128;
/// Bytes of one frame before byte stuffing, checksum included.
pub const MAX_FRAME: usize = 256;
/// Bytes of one frame on the line: stuffed, with its final zero.
pub const MAX_LINE: usize = MAX_FRAME + MAX_FRAME / 254 + 2;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_derived_is_what_the_documents_say() {
        assert_eq!((WEIGHTS, MAX_STORED, MAX_LINE), (41, 1092, 259));
    }
}
