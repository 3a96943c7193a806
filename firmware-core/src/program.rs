//! A formula as bytes: what a user's own effect is on a device.
//!
//! Postfix, one step a byte (a constant has four more), for a machine that has a stack and nothing else: no loop,
//! no jump, so it ends after as many steps as it has bytes. A program is checked once; after that the only thing
//! that can be missing is a value, as where it divides by zero. `docs/wire.md` lists the bytes.

use crate::real::Real;
use core::fmt;
use heapless::Vec;
use protocol::limits::MAX_PROGRAM;

/// Something measured that a program can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// The thermometer, °C.
    Temperature,
    /// Temperature minus its low-pass, °C.
    Departure,
    /// The low-passed temperature's rate, °C/s.
    Rate,
    /// Frequency difference, Hz.
    DeltaF,
    /// Acceleration, g.
    Level,
    /// Time since power-on, s.
    PowerOn,
    /// Calendar age, days.
    Age,
    /// An auxiliary channel, in its unit.
    Channel(u8),
}

/// What becomes of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum One {
    /// −a.
    Negate,
    /// |a|.
    Absolute,
    /// a².
    Square,
    /// √a; there is none of a negative one.
    SquareRoot,
    /// eᵃ.
    Exponential,
}

/// What becomes of two values, the upper one of the stack second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Two {
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a · b.
    Multiply,
    /// a / b; there is none by zero.
    Divide,
}

/// One step of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A number onto the stack.
    Constant(f32),
    /// A measured value onto the stack.
    Read(Input),
    /// The uppermost value becomes another.
    One(One),
    /// The two uppermost values become one.
    Two(Two),
}

impl Step {
    /// The first step of `code`, and what follows it.
    #[must_use]
    pub fn next(code: &[u8]) -> Option<(Self, &[u8])> {
        let (byte, rest) = code.split_first()?;
        let step = match byte {
            0x00 => {
                let (number, rest) = rest.split_first_chunk()?;
                return Some((Self::Constant(f32::from_le_bytes(*number)), rest));
            }
            0x01 => Self::Read(Input::Temperature),
            0x02 => Self::Read(Input::Departure),
            0x03 => Self::Read(Input::Rate),
            0x04 => Self::Read(Input::DeltaF),
            0x05 => Self::Read(Input::Level),
            0x06 => Self::Read(Input::PowerOn),
            0x07 => Self::Read(Input::Age),
            0x10 => Self::Two(Two::Add),
            0x11 => Self::Two(Two::Subtract),
            0x12 => Self::Two(Two::Multiply),
            0x13 => Self::Two(Two::Divide),
            0x20 => Self::One(One::Negate),
            0x21 => Self::One(One::Absolute),
            0x22 => Self::One(One::Square),
            0x23 => Self::One(One::SquareRoot),
            0x24 => Self::One(One::Exponential),
            0x80..=0x87 => Self::Read(Input::Channel(byte & 0x07)),
            _ => return None,
        };
        Some((step, rest))
    }

    /// The byte that stands for it; a constant's number follows it.
    #[must_use]
    pub fn byte(self) -> u8 {
        // The table above, read backwards, so that there is one. Never on a device.
        (1..=u8::MAX).find(|byte| Self::next(&[*byte]).is_some_and(|(step, _)| step == self)).unwrap_or(0)
    }
}

/// Why bytes are no program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ProgramError {
    /// There are more than a device stores.
    TooLong,
    /// This firmware doesn't know the step that begins at this byte, or it is cut off.
    Step(usize),
    /// A constant is infinite or not a number.
    Number,
    /// A step finds fewer values than it needs.
    Operand,
    /// It doesn't end with exactly one value.
    End,
    /// The effect takes no program.
    Surplus,
}

impl fmt::Display for ProgramError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => write!(f, "it has more than {MAX_PROGRAM} bytes"),
            Self::Step(at) => write!(f, "this firmware doesn't know the step at byte {at}"),
            Self::Number => write!(f, "a constant is not a usable number"),
            Self::Operand => write!(f, "a step has nothing to work on"),
            Self::End => write!(f, "it doesn't end with one value"),
            Self::Surplus => write!(f, "the effect takes none"),
        }
    }
}

impl core::error::Error for ProgramError {}

/// What must have been measured for a formula to have a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// The past of the temperature.
    pub past: bool,
    /// The calendar age.
    pub age: bool,
    /// Auxiliary channels, one bit each.
    pub channels: u8,
}

impl Reads {
    fn add(&mut self, input: Input) {
        match input {
            Input::Departure | Input::Rate => self.past = true,
            Input::Age => self.age = true,
            Input::Channel(channel) => self.channels |= 1_u8.checked_shl(u32::from(channel)).unwrap_or(0),
            Input::Temperature | Input::DeltaF | Input::Level | Input::PowerOn => {}
        }
    }
}

/// Operands are at least one byte each and one more than the steps that join them.
const MAX_DEPTH: usize = MAX_PROGRAM.div_ceil(2);

/// A program that was checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    code: Vec<u8, MAX_PROGRAM>,
    reads: Reads,
}

impl Program {
    /// That of an effect which has a formula of its own.
    pub const NONE: Self = Self { code: Vec::new(), reads: Reads { past: false, age: false, channels: 0 } };

    /// Checks that `code` can be run.
    ///
    /// # Errors
    /// [`ProgramError`] says why it can't.
    pub fn new(code: &[u8]) -> Result<Self, ProgramError> {
        let mut reads = Reads::default();
        let (mut depth, mut rest) = (0_usize, code);
        while !rest.is_empty() {
            let at = code.len().saturating_sub(rest.len());
            let (step, next) = Step::next(rest).ok_or(ProgramError::Step(at))?;
            depth = match step {
                Step::Constant(value) if !value.is_finite() => return Err(ProgramError::Number),
                Step::Constant(_) => depth + 1,
                Step::Read(input) => {
                    reads.add(input);
                    depth + 1
                }
                Step::One(_) => depth.checked_sub(1).ok_or(ProgramError::Operand)? + 1,
                Step::Two(_) => depth.checked_sub(2).ok_or(ProgramError::Operand)? + 1,
            };
            rest = next;
        }
        let code = Vec::from_slice(code).map_err(|_| ProgramError::TooLong)?;
        if depth == 1 { Ok(Self { code, reads }) } else { Err(ProgramError::End) }
    }

    /// What it reads.
    #[must_use]
    pub const fn reads(&self) -> Reads {
        self.reads
    }

    /// Its value, or `None` where it has no finite one. No step ever computes with a NaN or makes one.
    pub fn evaluate<R: Real>(&self, read: impl Fn(Input) -> R) -> Option<R> {
        let mut stack: Vec<R, MAX_DEPTH> = Vec::new();
        let mut rest = self.code.as_slice();
        while let Some((step, next)) = Step::next(rest) {
            let value = match step {
                Step::Constant(value) => R::from_f32(value),
                Step::Read(input) => read(input),
                Step::One(one) => one.of(stack.pop()?)?,
                Step::Two(two) => {
                    let b = stack.pop()?;
                    two.of(stack.pop()?, b)?
                }
            };
            if !value.is_finite() {
                return None;
            }
            stack.push(value).ok()?;
            rest = next;
        }
        stack.pop()
    }
}

impl One {
    fn of<R: Real>(self, a: R) -> Option<R> {
        match self {
            Self::Negate => Some(-a),
            Self::Absolute => Some(if a < R::ZERO { -a } else { a }),
            Self::Square => Some(a * a),
            Self::SquareRoot => (a >= R::ZERO).then(|| a.sqrt()),
            Self::Exponential => Some(a.exp()),
        }
    }
}

impl Two {
    fn of<R: Real>(self, a: R, b: R) -> Option<R> {
        match self {
            Self::Add => Some(a + b),
            Self::Subtract => Some(a - b),
            Self::Multiply => Some(a * b),
            Self::Divide => (b != R::ZERO).then(|| a / b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: [u8; 5] = [0x00, 0x00, 0x00, 0x00, 0x3F];
    const INFINITE: [u8; 5] = [0x00, 0x00, 0x00, 0x80, 0x7F];

    fn read(input: Input) -> f32 {
        match input {
            Input::Temperature => -4.0,
            Input::Departure => 0.0,
            Input::Rate => f32::INFINITY,
            Input::DeltaF => 1e38,
            Input::Level => 3.0,
            Input::PowerOn => 1e30,
            Input::Age => 9.0,
            Input::Channel(channel) => f32::from(channel) + 2.0,
        }
    }

    #[test]
    fn every_step_has_its_value() {
        let table: [(&[u8], Option<f32>); 20] = [
            (&HALF, Some(0.5)),
            (&[0x01], Some(-4.0)),
            (&[0x02], Some(0.0)),
            (&[0x05], Some(3.0)),
            (&[0x07], Some(9.0)),
            (&[0x87], Some(9.0)),
            (&[0x80, 0x81, 0x10], Some(5.0)),
            (&[0x80, 0x81, 0x11], Some(-1.0)),
            (&[0x80, 0x81, 0x12], Some(6.0)),
            (&[0x82, 0x80, 0x13], Some(2.0)),
            (&[0x05, 0x20], Some(-3.0)),
            (&[0x01, 0x21], Some(4.0)),
            (&[0x01, 0x22], Some(16.0)),
            (&[0x07, 0x23], Some(3.0)),
            (&[0x02, 0x24], Some(1.0)),
            // Nothing that is no number goes on: an input, a division by zero, an overflow, a root.
            (&[0x03, 0x20], None),
            (&[0x05, 0x02, 0x13], None),
            (&[0x04, 0x22], None),
            (&[0x06, 0x24], None),
            (&[0x01, 0x23], None),
        ];
        for (code, value) in table {
            let program = Program::new(code).expect("it is sound");
            assert_eq!(program.evaluate(read), value, "{code:02x?}");
        }
    }

    #[test]
    fn the_absolute_value_of_zero_is_zero_without_a_sign() {
        assert_eq!(One::Absolute.of(0.0_f32).map(f32::to_bits), Some(0));
    }

    #[test]
    fn what_cannot_be_run_is_refused_with_its_reason() {
        let table: [(&[u8], ProgramError); 10] = [
            (&[], ProgramError::End),
            (&[0x05, 0x05], ProgramError::End),
            (&[0x20], ProgramError::Operand),
            (&[0x05, 0x10], ProgramError::Operand),
            (&[0x08], ProgramError::Step(0)),
            (&[0x05, 0x88], ProgramError::Step(1)),
            (&[0x05, 0x20, 0x00, 0x00, 0x00], ProgramError::Step(2)),
            (&INFINITE, ProgramError::Number),
            (&[0x20; MAX_PROGRAM + 1], ProgramError::Operand),
            (&[0x05; MAX_PROGRAM + 1], ProgramError::TooLong),
        ];
        for (code, error) in table {
            assert_eq!(Program::new(code), Err(error), "{code:02x?}");
        }
    }

    #[test]
    fn a_program_says_what_it_reads() {
        let reads = |code: &[u8]| Program::new(code).expect("it is sound").reads();
        assert_eq!(reads(&[0x01, 0x05, 0x12]), Reads::default());
        assert_eq!(reads(&[0x80, 0x87, 0x12]), Reads { channels: 0b1000_0001, ..Reads::default() });
        assert_eq!(reads(&[0x03, 0x07, 0x12]), Reads { past: true, age: true, channels: 0 });
        assert!(reads(&[0x02]).past);
    }

    #[test]
    fn the_deepest_stack_that_a_program_can_need_is_there() {
        let mut code = [0x05; MAX_PROGRAM - 1];
        code[MAX_DEPTH..].fill(0x10);
        assert_eq!(Program::new(&code).expect("it is sound").evaluate(read), Some(48.0));
    }

    #[test]
    fn every_byte_is_that_of_the_step_it_stands_for() {
        for byte in 1..=u8::MAX {
            if let Some((step, _)) = Step::next(&[byte]) {
                assert_eq!(step.byte(), byte);
            }
        }
    }

    /// Whatever the bytes: refused, or a program that runs and needs no more than its bytes say.
    #[test]
    fn random_bytes_are_refused_or_run() {
        const BYTES: [u8; 24] = [
            0x00, 0x3F, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x80, 0x81, 0x87, 0x10, 0x10, 0x11, 0x12, 0x12, 0x13,
            0x20, 0x21, 0x22, 0x23, 0x24, 0x99,
        ];
        let mut state = 1_u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize
        };
        let mut sound = 0;
        for _ in 0..200_000 {
            let mut code = [0; MAX_PROGRAM + 2];
            let length = next() % if next() % 2 == 0 { 8 } else { code.len() + 1 };
            code.iter_mut().for_each(|byte| *byte = BYTES[next() % BYTES.len()]);
            if let Ok(program) = Program::new(&code[..length]) {
                sound += 1;
                assert!(program.evaluate(read).is_none_or(f32::is_finite), "{:02x?}", &code[..length]);
            }
        }
        assert!(sound > 1000, "{sound}");
    }
}
