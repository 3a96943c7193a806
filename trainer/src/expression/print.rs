//! From program to text, for calibrations whose model file is not at hand.

use super::vocabulary::{FUNCTIONS, NAMES, steps};
use firmware_core::program::{Input, One, Step, Two};

/// How firmly a text holds together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Bond {
    Sum,
    Product,
    Sign,
    Atom,
}

/// The expression of a program; `None` if it is not one.
#[must_use]
pub fn print(code: &[u8], channels: &[impl AsRef<str>]) -> Option<String> {
    let mut stack: Vec<(String, Bond)> = Vec::new();
    for step in steps(code) {
        let text = match step {
            Step::Constant(number) if number < 0.0 => (format!("{number}"), Bond::Sign),
            Step::Constant(number) => (format!("{number}"), Bond::Atom),
            Step::Read(input) => (name(input, channels)?, Bond::Atom),
            Step::One(one) => applied(one, stack.pop()?),
            Step::Two(two) => {
                let b = stack.pop()?;
                joined(two, stack.pop()?, b)
            }
        };
        stack.push(text);
    }
    match stack.as_slice() {
        [(text, _)] => Some(text.clone()),
        _ => None,
    }
}

fn name(input: Input, channels: &[impl AsRef<str>]) -> Option<String> {
    if let Input::Channel(channel) = input {
        return channels.get(usize::from(channel)).map(|name| name.as_ref().to_owned());
    }
    NAMES.iter().find(|(_, _, known)| *known == input).map(|(name, _, _)| (*name).to_owned())
}

fn applied(one: One, a: (String, Bond)) -> (String, Bond) {
    match (one, FUNCTIONS.iter().find(|(_, known)| *known == one)) {
        (_, Some((name, _))) => (format!("{name}({})", a.0), Bond::Atom),
        (One::Negate, _) => (format!("-{}", at_least(Bond::Sign, a)), Bond::Sign),
        // A square binds like a sign, because a square of it needs parentheses.
        _ => (format!("{}^2", at_least(Bond::Atom, a)), Bond::Sign),
    }
}

fn joined(two: Two, a: (String, Bond), b: (String, Bond)) -> (String, Bond) {
    let (sign, bond, right) = match two {
        Two::Add => ('+', Bond::Sum, Bond::Product),
        Two::Subtract => ('-', Bond::Sum, Bond::Product),
        Two::Multiply => ('*', Bond::Product, Bond::Sign),
        Two::Divide => ('/', Bond::Product, Bond::Sign),
    };
    (format!("{} {sign} {}", at_least(bond, a), at_least(right, b)), bond)
}

fn at_least(bond: Bond, (text, found): (String, Bond)) -> String {
    if found >= bond { text } else { format!("({text})") }
}
