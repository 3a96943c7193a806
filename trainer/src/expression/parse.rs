//! From text to program: recursive descent, which meets operands and operators in the order of a postfix program.
//!
//! ```text
//! sum     = product { (+ | -) product }
//! product = sign { (* | /) sign }
//! sign    = - sign | power
//! power   = atom [ ^ 2 ]
//! atom    = number | name | function ( sum ) | ( sum )
//! ```

use super::error::ExpressionError;
use super::vocabulary::{FUNCTIONS, NAMES};
use crate::campaign::nearest;
use firmware_core::program::{Input, One, Step, Two};
use protocol::limits::MAX_PROGRAM;

type Code = heapless::Vec<u8, MAX_PROGRAM>;

/// A device's program is much shorter, and what is nested deeper than this is no expression but an accident.
const MOST_LETTERS: usize = 1000;

pub(super) fn parse(text: &str, channels: &[String]) -> Result<Code, ExpressionError> {
    let letters: Vec<char> = text.chars().collect();
    let mut parser = Parser { text, letters: &letters, at: 0, channels, code: Code::new(), last: None };
    if letters.len() > MOST_LETTERS {
        let expected = format!("at most {MOST_LETTERS}");
        return Err(parser.wrong(MOST_LETTERS, format!("{} letters", letters.len()), expected));
    }
    parser.sum()?;
    match parser.peek() {
        None => Ok(parser.code),
        Some(_) => Err(parser.unexpected("an operator (+ - * / ^2) or the end")),
    }
}

struct Parser<'a> {
    text: &'a str,
    letters: &'a [char],
    at: usize,
    channels: &'a [String],
    code: Code,
    /// The step that was written last, and where.
    last: Option<(Step, usize)>,
}

impl Parser<'_> {
    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        while let Some((two, at)) = self.operator(&[('+', Two::Add), ('-', Two::Subtract)]) {
            self.product()?;
            self.write(Step::Two(two), at)?;
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), ExpressionError> {
        self.sign()?;
        while let Some((two, at)) = self.operator(&[('*', Two::Multiply), ('/', Two::Divide)]) {
            self.sign()?;
            self.write(Step::Two(two), at)?;
        }
        Ok(())
    }

    fn sign(&mut self) -> Result<(), ExpressionError> {
        let Some((one, at)) = self.operator(&[('-', One::Negate)]) else { return self.power() };
        self.sign()?;
        match self.last {
            // A negative number is a number; a step of its own would be a byte more.
            Some((Step::Constant(number), place)) => {
                self.code.truncate(place);
                self.write(Step::Constant(-number), at)
            }
            _ => self.write(Step::One(one), at),
        }
    }

    fn power(&mut self) -> Result<(), ExpressionError> {
        self.atom()?;
        let Some((one, at)) = self.operator(&[('^', One::Square)]) else { return Ok(()) };
        self.peek();
        let (start, word) = (self.at, self.word());
        if word != "2" {
            self.at = start;
            return Err(self.unexpected("2: other powers are written as products and sqrt()"));
        }
        self.write(Step::One(one), at)
    }

    fn atom(&mut self) -> Result<(), ExpressionError> {
        let Some(first) = self.peek() else { return Err(self.unexpected(OPERAND)) };
        let start = self.at;
        if first == '(' {
            return self.parenthesis();
        }
        let word = self.word();
        if first.is_ascii_digit() || first == '.' {
            let number = word.parse().ok().filter(|number: &f32| number.is_finite());
            let number = number.ok_or_else(|| self.wrong(start, quoted(&word), "a number below 3.4e38"))?;
            return self.write(Step::Constant(number), start);
        }
        if word.is_empty() {
            return Err(self.unexpected(OPERAND));
        }
        if let Some((_, one)) = FUNCTIONS.iter().find(|(name, _)| *name == word) {
            self.parenthesis()?;
            return self.write(Step::One(*one), start);
        }
        let input = self.input(&word).ok_or_else(|| self.unknown(start, &word))?;
        self.write(Step::Read(input), start)
    }

    fn parenthesis(&mut self) -> Result<(), ExpressionError> {
        self.operator(&[('(', ())]).ok_or_else(|| self.unexpected("`(`"))?;
        self.sum()?;
        self.operator(&[(')', ())]).ok_or_else(|| self.unexpected("an operator (+ - * / ^2) or `)`"))?;
        Ok(())
    }

    fn input(&self, name: &str) -> Option<Input> {
        let built_in = NAMES.iter().find(|(known, _, _)| *known == name).map(|(_, _, input)| *input);
        let channel = || self.channels.iter().position(|channel| channel == name);
        built_in.or_else(|| u8::try_from(channel()?).ok().map(Input::Channel))
    }

    /// One of these signs, if it comes next, and where it stands.
    fn operator<T: Copy>(&mut self, signs: &[(char, T)]) -> Option<(T, usize)> {
        let next = self.peek()?;
        let (_, meaning) = signs.iter().find(|(sign, _)| *sign == next)?;
        self.at += 1;
        Some((*meaning, self.at - 1))
    }

    /// The next letter that is no blank.
    fn peek(&mut self) -> Option<char> {
        while self.letters.get(self.at).is_some_and(|letter| letter.is_whitespace()) {
            self.at += 1;
        }
        self.letters.get(self.at).copied()
    }

    /// A name or a number; empty if neither comes next.
    fn word(&mut self) -> String {
        let start = self.at;
        let numeric = self.letters.get(start).is_some_and(|letter| letter.is_ascii_digit() || *letter == '.');
        while let Some(letter) = self.letters.get(self.at) {
            let before = self.at.checked_sub(1).filter(|before| *before > start).and_then(|at| self.letters.get(at));
            let exponent = numeric && matches!(letter, '+' | '-') && matches!(before, Some('e' | 'E'));
            if !(letter.is_alphanumeric() || *letter == '_' || exponent || numeric && *letter == '.') {
                break;
            }
            self.at += 1;
        }
        self.letters.get(start..self.at).unwrap_or_default().iter().collect()
    }

    fn write(&mut self, step: Step, at: usize) -> Result<(), ExpressionError> {
        self.last = Some((step, self.code.len()));
        let number = if let Step::Constant(number) = step { Some(number.to_le_bytes()) } else { None };
        let bytes = std::iter::once(step.byte()).chain(number.into_iter().flatten());
        for byte in bytes {
            self.code.push(byte).map_err(|_| {
                let expected = "a shorter expression; a number takes 5 bytes, everything else 1";
                self.wrong(at, format!("the end of the {MAX_PROGRAM} bytes that a device has for it"), expected)
            })?;
        }
        Ok(())
    }

    fn unknown(&self, at: usize, word: &str) -> ExpressionError {
        let functions = FUNCTIONS.iter().map(|(name, _)| (*name).to_owned());
        let names = NAMES.iter().map(|(name, _, _)| (*name).to_owned()).chain(self.channels.iter().cloned());
        let known: Vec<String> = names.chain(functions).collect();
        let expected = format!("a number, `(` or one of {}", known.join(", "));
        ExpressionError { nearest: nearest(word, &known), ..self.wrong(at, quoted(word), expected) }
    }

    /// What stands at the present place should not.
    fn unexpected(&mut self, expected: &str) -> ExpressionError {
        let next = self.peek();
        let start = self.at;
        let word = self.word();
        let found = match next {
            None => "the end".to_owned(),
            Some(sign) if word.is_empty() => quoted(&sign.to_string()),
            Some(_) => quoted(&word),
        };
        self.wrong(start, found, expected)
    }

    fn wrong(&self, at: usize, found: impl Into<String>, expected: impl Into<String>) -> ExpressionError {
        let (text, found, expected) = (self.text.to_owned(), found.into(), expected.into());
        ExpressionError { text, column: at + 1, found, expected, nearest: None }
    }
}

const OPERAND: &str = "a name, a number or `(`";

fn quoted(word: &str) -> String {
    format!("`{word}`")
}
