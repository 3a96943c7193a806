//! The models of the certified problems, as the head of each data file prints them.

use super::dual::Dual;
use std::f64::consts::PI;

/// Parameters and predictors to response.
pub type Model = fn(&[Dual], &[f64]) -> Dual;

/// The model of a data file.
pub fn model(name: &str) -> Model {
    match name {
        "Bennett5" => |b, x| b[0] * (b[1] + x[0]).power(-1.0 * reciprocal(b[2])),
        "BoxBOD" | "Misra1a" => |b, x| b[0] * (1.0 - (-b[1] * x[0]).exp()),
        "Chwirut1" | "Chwirut2" => |b, x| (-b[0] * x[0]).exp() / (b[1] + b[2] * x[0]),
        "DanWood" => |b, x| b[0] * Dual::from(x[0]).power(b[1]),
        "ENSO" => |b, x| {
            let year = Dual::from(12.0);
            b[0] + wave(b[1], b[2], year, x[0]) + wave(b[4], b[5], b[3], x[0]) + wave(b[7], b[8], b[6], x[0])
        },
        "Eckerle4" => |b, x| b[0] / b[1] * (-0.5 * ((x[0] - b[2]) / b[1]).square()).exp(),
        "Gauss1" | "Gauss2" | "Gauss3" => |b, x| {
            let bell = |k: usize| b[k] * (-((x[0] - b[k + 1]) / b[k + 2]).square()).exp();
            decay(b[0], b[1], x[0]) + bell(2) + bell(5)
        },
        "Hahn1" | "Thurber" => |b, x| polynomial(&b[..4], x[0]) / (1.0 + polynomial(&b[4..7], x[0]) * x[0]),
        "Kirby2" => |b, x| polynomial(&b[..3], x[0]) / (1.0 + polynomial(&b[3..5], x[0]) * x[0]),
        "Lanczos1" | "Lanczos2" | "Lanczos3" => {
            |b, x| decay(b[0], b[1], x[0]) + decay(b[2], b[3], x[0]) + decay(b[4], b[5], x[0])
        }
        "MGH09" => |b, x| b[0] * (x[0] * x[0] + x[0] * b[1]) / (x[0] * x[0] + x[0] * b[2] + b[3]),
        "MGH10" => |b, x| b[0] * (b[1] / (x[0] + b[2])).exp(),
        "MGH17" => |b, x| b[0] + decay(b[1], b[3], x[0]) + decay(b[2], b[4], x[0]),
        "Misra1b" => |b, x| b[0] * (1.0 - (1.0 + b[1] * x[0] / 2.0).powf(-2.0)),
        "Misra1c" => |b, x| b[0] * (1.0 - (1.0 + 2.0 * b[1] * x[0]).powf(-0.5)),
        "Misra1d" => |b, x| b[0] * b[1] * x[0] / (1.0 + b[1] * x[0]),
        "Nelson" => |b, x| b[0] - b[1] * x[0] * (-b[2] * x[1]).exp(),
        "Rat42" => |b, x| b[0] / (1.0 + (b[1] - b[2] * x[0]).exp()),
        "Rat43" => |b, x| b[0] / (1.0 + (b[1] - b[2] * x[0]).exp()).power(reciprocal(b[3])),
        "Roszman1" => |b, x| b[0] - b[1] * x[0] - (b[2] / (x[0] - b[3])).atan() / PI,
        unknown => panic!("{unknown}: write its model here"),
    }
}

/// a·exp(−rate·x)
fn decay(a: Dual, rate: Dual, x: f64) -> Dual {
    a * (-rate * x).exp()
}

fn wave(cosine: Dual, sine: Dual, period: Dual, x: f64) -> Dual {
    let phase = 2.0 * PI * x * reciprocal(period);
    cosine * phase.cos() + sine * phase.sin()
}

/// Horner's scheme, lowest order first.
fn polynomial(coefficients: &[Dual], x: f64) -> Dual {
    coefficients.iter().rev().fold(Dual::from(0.0), |sum, coefficient| sum * x + *coefficient)
}

fn reciprocal(value: Dual) -> Dual {
    Dual::from(1.0) / value
}
