//! The 41 numbers of the network, and their fixed layout.

use crate::limits::{HIDDEN, WEIGHTS};
use core::fmt;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

const BYTES: usize = 4 * WEIGHTS;

/// Weights of the 2-10-1 network (Huang et al. 2022, eq. 2).
///
/// Serialised as 164 little-endian bytes in the order of [`Weights::to_array`]: a fixed layout costs
/// the device a copy where a derived deserialiser costs kilobytes of flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// From the inputs (frequency difference, temperature) to each hidden unit.
    pub input: [[f32; 2]; HIDDEN],
    /// Threshold of each hidden unit.
    pub bias: [f32; HIDDEN],
    /// From each hidden unit to the output.
    pub output: [f32; HIDDEN],
    /// Threshold of the output.
    pub output_bias: f32,
}

impl Weights {
    /// A network whose output is zero everywhere.
    pub const ZERO: Self =
        Self { input: [[0.0; 2]; HIDDEN], bias: [0.0; HIDDEN], output: [0.0; HIDDEN], output_bias: 0.0 };

    /// All weights in one row: inputs unit by unit, thresholds, outputs, output threshold.
    #[must_use]
    pub fn to_array(&self) -> [f32; WEIGHTS] {
        let mut row = [0.0; WEIGHTS];
        let values = self.input.as_flattened().iter().chain(&self.bias).chain(&self.output).chain([&self.output_bias]);
        for (slot, value) in row.iter_mut().zip(values) {
            *slot = *value;
        }
        row
    }

    /// The inverse of [`Weights::to_array`].
    #[must_use]
    pub fn from_array(row: &[f32; WEIGHTS]) -> Self {
        let mut weights = Self::ZERO;
        let Self { input, bias, output, output_bias } = &mut weights;
        let slots = input.as_flattened_mut().iter_mut().chain(bias).chain(output).chain([output_bias]);
        for (slot, value) in slots.zip(row) {
            *slot = *value;
        }
        weights
    }

    /// The fixed layout: 41 `f32`, little-endian.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; BYTES] {
        let mut bytes = [0; BYTES];
        for (slot, value) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(self.to_array()) {
            *slot = value.to_le_bytes();
        }
        bytes
    }

    /// The inverse of [`Weights::to_bytes`].
    #[must_use]
    pub fn from_bytes(bytes: &[u8; BYTES]) -> Self {
        let mut row = [0.0; WEIGHTS];
        for (slot, chunk) in row.iter_mut().zip(bytes.as_chunks::<4>().0) {
            *slot = f32::from_le_bytes(*chunk);
        }
        Self::from_array(&row)
    }
}

impl Serialize for Weights {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.to_bytes())
    }
}

impl<'de> Deserialize<'de> for Weights {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_bytes(WeightsVisitor)
    }
}

struct WeightsVisitor;

impl Visitor<'_> for WeightsVisitor {
    type Value = Weights;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("164 bytes of weights")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Weights, E> {
        <&[u8; BYTES]>::try_from(bytes).map(Weights::from_bytes).map_err(|_| E::invalid_length(bytes.len(), &self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_weight_survives_the_bytes_in_its_place() {
        let row = core::array::from_fn(|i| (i as f32).sin() * 10.0_f32.powi(i as i32 % 7 - 3));
        let weights = Weights::from_array(&row);
        assert_eq!(weights.to_array(), row);
        assert_eq!(Weights::from_bytes(&weights.to_bytes()), weights);
        assert_eq!(weights.input[3][1], row[7]);
        assert_eq!(weights.output_bias, row[40]);
    }
}
