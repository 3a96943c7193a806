//! Decimal text to integers, rounded once.
//!
//! A clock in nanoseconds has more digits than an `f64`; parsing the decimal digits themselves loses none of them,
//! and a conversion by a power of ten moves the point instead of multiplying.

/// Decimal places of a millionth.
const MICRO: i32 = 6;
/// Exponents beyond it are beyond every number that we keep; without it their sums could overflow.
const EXPONENT: i32 = 10_000;
/// The largest mantissa that can take one more digit.
const NEARLY_FULL: u64 = (u64::MAX - 9) / 10;

/// `±mantissa·10^exponent`, exactly as written (up to 19 digits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimal {
    negative: bool,
    mantissa: u64,
    exponent: i32,
}

/// Why text is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NotDecimal {
    /// Nothing there.
    Empty,
    /// NaN or infinity.
    NotFinite,
    /// Something else.
    Text,
}

impl Decimal {
    /// A whole number.
    pub(super) const fn whole(mantissa: u64) -> Self {
        Self { negative: false, mantissa, exponent: 0 }
    }

    /// Reads `12`, `-0.5`, `+.5`, `1.5e-3`.
    pub(super) fn parse(text: &[u8]) -> Result<Self, NotDecimal> {
        let (negative, unsigned) = match text {
            [] => return Err(NotDecimal::Empty),
            [b'-', rest @ ..] => (true, rest),
            [b'+', rest @ ..] => (false, rest),
            rest => (false, rest),
        };
        let (mut mantissa, mut exponent, mut length) = (0_u64, 0_i32, 0);
        let (mut any, mut point) = (false, false);
        for &byte in unsigned {
            match byte {
                b'0'..=b'9' if mantissa < NEARLY_FULL => {
                    mantissa = mantissa * 10 + u64::from(byte - b'0');
                    exponent -= i32::from(point);
                    any = true;
                }
                // Digits beyond the nineteenth move the point only: they lie far below any step we keep.
                b'0'..=b'9' => exponent += i32::from(!point),
                b'.' if !point => point = true,
                _ => break,
            }
            length += 1;
        }
        let tail = unsigned.get(length..).unwrap_or_default();
        if !any {
            return Err(if is_not_finite(unsigned) { NotDecimal::NotFinite } else { NotDecimal::Text });
        }
        let exponent = (exponent + exponent_of(tail)?).clamp(-EXPONENT, EXPONENT);
        Ok(Self { negative, mantissa, exponent })
    }

    /// The number times `10^places`, rounded half away from zero; `None` if an `i64` cannot hold it.
    fn rounded(self, places: i32) -> Option<i64> {
        let exponent = self.exponent + places;
        let power = 10_u64.checked_pow(exponent.unsigned_abs());
        let magnitude = match power {
            _ if self.mantissa == 0 => 0,
            Some(power) if exponent >= 0 => self.mantissa.checked_mul(power)?,
            Some(power) => self.mantissa / power + u64::from(self.mantissa % power >= power / 2),
            None if exponent >= 0 => return None,
            None => 0,
        };
        let magnitude = i64::try_from(magnitude).ok()?;
        Some(if self.negative { -magnitude } else { magnitude })
    }

    /// The number as a float, for conversions that no integer can do.
    pub(super) fn to_f64(self) -> f64 {
        let mantissa = self.mantissa as f64;
        let magnitude =
            if self.exponent < 0 { mantissa / ten_to(-self.exponent) } else { mantissa * ten_to(self.exponent) };
        if self.negative { -magnitude } else { magnitude }
    }

    /// The same number without trailing zeros in its mantissa.
    fn normal(mut self) -> Self {
        while self.mantissa != 0 && self.mantissa.is_multiple_of(10) {
            self.mantissa /= 10;
            self.exponent += 1;
        }
        self
    }
}

fn ten_to(exponent: i32) -> f64 {
    10_f64.powi(exponent)
}

fn is_not_finite(text: &[u8]) -> bool {
    ["nan", "inf", "infinity"].iter().any(|word| text.eq_ignore_ascii_case(word.as_bytes()))
}

fn exponent_of(tail: &[u8]) -> Result<i32, NotDecimal> {
    let digits = match tail {
        [] => return Ok(0),
        [b'e' | b'E', digits @ ..] => std::str::from_utf8(digits).map_err(|_| NotDecimal::Text)?,
        _ => return Err(NotDecimal::Text),
    };
    digits.parse::<i32>().map(|exponent| exponent.clamp(-EXPONENT, EXPONENT)).map_err(|_| NotDecimal::Text)
}

/// From the unit of a column to ours: `·factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Conversion {
    /// A power of ten and an offset of whole millionths: exact.
    Exact {
        /// The factor's power of ten.
        shift: i32,
        /// Millionths of our unit to add.
        offset_u: i64,
    },
    /// Anything else, computed as floats and rounded once.
    Linear {
        /// Our units for one of theirs.
        factor: f64,
        /// Our units to add.
        offset: f64,
    },
}

impl Conversion {
    /// The column is in our unit.
    pub(super) const NONE: Self = Self::Exact { shift: 0, offset_u: 0 };

    /// The same, times a power of ten.
    pub(super) fn scaled(self, power: i32) -> Self {
        let scale = 10_f64.powi(power);
        match self {
            Self::Exact { shift, offset_u: 0 } => Self::Exact { shift: shift + power, offset_u: 0 },
            Self::Exact { shift, offset_u } => {
                Self::Linear { factor: scale * 10_f64.powi(shift), offset: scale * offset_u as f64 * 1e-6 }
            }
            Self::Linear { factor, offset } => Self::Linear { factor: factor * scale, offset: offset * scale },
        }
    }

    /// Reads `*factor`, `/divisor`, `+offset`, `-offset`, or a factor and then an offset.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let (factor, divided, rest) = match text.strip_prefix(['*', '/']) {
            Some(scaled) => {
                let (factor, rest) = leading_number(scaled)?;
                (factor, text.starts_with('/'), rest)
            }
            None => ("1", false, text),
        };
        let offset = match rest.strip_prefix(['+', '-']) {
            Some(_) => Decimal::parse(without_blank_after_sign(rest).as_bytes()).ok()?,
            None if rest.is_empty() => Decimal::whole(0),
            None => return None,
        };
        Self::new(Decimal::parse(factor.as_bytes()).ok()?, divided, offset)
    }

    fn new(factor: Decimal, divided: bool, offset: Decimal) -> Option<Self> {
        let (factor, offset) = (factor.normal(), offset.normal());
        let whole_micro = offset.exponent >= -MICRO || offset.mantissa == 0;
        match offset.rounded(MICRO) {
            Some(offset_u) if whole_micro && factor.mantissa == 1 && !factor.negative => {
                Some(Self::Exact { shift: if divided { -factor.exponent } else { factor.exponent }, offset_u })
            }
            _ => {
                let (scale, offset) = (factor.to_f64(), offset.to_f64());
                let factor = if divided { scale.recip() } else { scale };
                (factor.is_finite() && factor != 0.0).then_some(Self::Linear { factor, offset })
            }
        }
    }

    /// The converted number in millionths of our unit; `None` if an `i64` cannot hold it.
    pub(super) fn micro(self, number: Decimal) -> Option<i64> {
        match self {
            Self::Exact { shift, offset_u } => number.rounded(MICRO + shift)?.checked_add(offset_u),
            Self::Linear { factor, offset } => whole((number.to_f64() * factor + offset) * ten_to(MICRO)),
        }
    }

    /// The converted number as a float.
    pub(super) fn real(self, number: f64) -> f64 {
        match self {
            Self::NONE => number,
            Self::Exact { shift, offset_u } => {
                let moved = if shift < 0 { number / ten_to(-shift) } else { number * ten_to(shift) };
                moved + offset_u as f64 / ten_to(MICRO)
            }
            Self::Linear { factor, offset } => number * factor + offset,
        }
    }

    /// How far the last written digit of `number` reaches, in millionths of our unit; at least one of them.
    pub(super) fn step_micro(self, number: Decimal) -> f64 {
        let factor = match self {
            Self::Exact { shift, .. } => ten_to(shift),
            Self::Linear { factor, .. } => factor.abs(),
        };
        (ten_to(number.exponent + MICRO) * factor).max(1.0)
    }
}

/// The nearest integer, if an `i64` holds it.
pub(super) fn whole(number: f64) -> Option<i64> {
    // 2⁶³ itself is a float, the largest i64 is not: the comparison is exact.
    (number.abs() < i64::MAX as f64).then(|| number.round() as i64)
}

/// The longest beginning of `text` that is a number, and the rest.
fn leading_number(text: &str) -> Option<(&str, &str)> {
    let ends = text.char_indices().map(|(start, c)| start + c.len_utf8()).rev();
    let split = ends.map(|end| text.split_at(end));
    let (number, rest) = split.into_iter().find(|(number, _)| Decimal::parse(number.trim().as_bytes()).is_ok())?;
    Some((number.trim(), rest.trim_start()))
}

fn without_blank_after_sign(offset: &str) -> String {
    let (sign, digits) = offset.split_at(1);
    format!("{sign}{}", digits.trim())
}

/// Millionths as decimal text without needless zeros.
pub(super) fn micro_text(micro: i128) -> String {
    let (whole, fraction) = (micro.unsigned_abs() / 1_000_000, micro.unsigned_abs() % 1_000_000);
    let text = format!("{}{whole}.{fraction:06}", if micro < 0 { "-" } else { "" });
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn micro(text: &str, conversion: &str) -> Option<i64> {
        Conversion::parse(conversion).expect("a conversion").micro(Decimal::parse(text.as_bytes()).expect("a number"))
    }

    #[test]
    fn decimal_text_becomes_millionths_rounded_once() {
        for (text, expected) in [
            ("0", Some(0)),
            ("-0.0", Some(0)),
            ("41238.000001", Some(41_238_000_001)),
            ("+.5", Some(500_000)),
            ("5.", Some(5_000_000)),
            ("1.5e-3", Some(1_500)),
            ("2E+2", Some(200_000_000)),
            ("0.0000005", Some(1)),
            ("-0.0000005", Some(-1)),
            ("0.00000049999999999999999999999999", Some(0)),
            ("0.1234564999999999999999", Some(123_456)),
            ("9223372036854.775807", Some(i64::MAX)),
            ("9223372036854.775808", None),
            ("1e30", None),
            ("1e-30", Some(0)),
            ("0e2000000000", Some(0)),
        ] {
            assert_eq!(micro(text, ""), expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_apart() {
        for (text, expected) in [
            ("", NotDecimal::Empty),
            ("NaN", NotDecimal::NotFinite),
            ("-inf", NotDecimal::NotFinite),
            ("Infinity", NotDecimal::NotFinite),
            ("n/a", NotDecimal::Text),
            ("1,5", NotDecimal::Text),
            ("1.2.3", NotDecimal::Text),
            ("12 V", NotDecimal::Text),
            ("1e", NotDecimal::Text),
            ("--1", NotDecimal::Text),
            (".", NotDecimal::Text),
        ] {
            assert_eq!(Decimal::parse(text.as_bytes()), Err(expected), "{text}");
        }
    }

    #[test]
    fn a_power_of_ten_loses_no_digit_of_a_nanosecond_clock() {
        assert_eq!(micro("1638974512345678901", "*1e-9"), Some(1_638_974_512_345_679));
        assert_eq!(micro("1638974512345678901", " * 1e-9 - 1638974512"), Some(345_679));
        assert_eq!(micro("1638974512345678901", "/1000000000"), Some(1_638_974_512_345_679));
        assert_eq!(micro("123456789012345678901234", "*1e-12"), Some(123_456_789_012_345_679), "more than nineteen");
    }

    #[test]
    fn a_float_is_the_nearest_to_what_is_written() {
        for (text, expected) in [("0.3", 0.3), ("-0.7", -0.7), ("3e2", 300.0), ("12", 12.0), ("1e23", 1e23)] {
            assert_eq!(Decimal::parse(text.as_bytes()).expect("a number").to_f64(), expected, "{text}");
        }
    }

    #[test]
    fn other_units_are_converted() {
        assert_eq!(micro("212", "*0.5-6"), Some(100_000_000));
        assert_eq!(micro("77", "/1.8 - 17.7777777777"), Some(25_000_000));
        assert_eq!(micro("300", "-273.15"), Some(26_850_000));
        assert_eq!(micro("1", "*-2"), Some(-2_000_000));
        for bad in ["*", "*x", "3", "*0", "/0", "+", "*2*3", "+1e-3+2"] {
            assert_eq!(Conversion::parse(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_float_is_converted_and_keeps_its_digits() {
        for (number, conversion, expected) in [
            (3.0, "*0.1", 0.3),
            (3.0, "/10", 0.3),
            (2.0, "*1e3", 2000.0),
            (2.0, "*1e3 + 0.5", 2000.5),
            (2.0, "-273.15", -271.15),
            (212.0, "*0.5-6", 100.0),
            (1.5, "", 1.5),
        ] {
            assert_eq!(Conversion::parse(conversion).expect("a conversion").real(number), expected, "{conversion}");
        }
    }

    #[test]
    fn the_last_digit_reaches_as_far_as_the_unit_lets_it() {
        for (text, conversion, expected_u) in
            [("0.12", "", 1e4), ("7", "", 1e6), ("0.12", "*-2", 2e4), ("0.12", "/1000", 10.0), ("0.1234567", "", 1.0)]
        {
            let number = Decimal::parse(text.as_bytes()).expect("a number");
            let step_u = Conversion::parse(conversion).expect("a conversion").step_micro(number);
            assert!((step_u / expected_u - 1.0).abs() < 1e-12, "{text} {conversion}: {step_u}");
        }
    }

    #[test]
    fn the_largest_whole_number_is_the_last_float_below_two_to_the_63() {
        let bound = 2.0_f64.powi(63);
        assert_eq!((whole(bound), whole(-bound), whole(2.5)), (None, None, Some(3)));
        assert_eq!(whole(bound.next_down()), Some(i64::MAX - 1023));
    }

    #[test]
    fn millionths_are_written_without_needless_zeros() {
        for (value, text) in [(0, "0"), (1_500_000, "1.5"), (-1, "-0.000001"), (20_000_000, "20")] {
            assert_eq!(micro_text(value), text);
        }
    }
}
