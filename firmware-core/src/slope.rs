//! Is it an accelerometer? The slope of the static model keeps its sign all over the calibrated domain.
//!
//! A model whose slope vanishes reads the same whatever is applied; where its sign turns, two accelerations have one
//! reading. Both may leave no residual on the campaign that they were trained on.

use crate::network::{Network, ordered};
use crate::observe::Scale;
use crate::real::Real;

/// No slope may be less than this share of the slope in the middle of the domain.
const LEAST_SHARE: f32 = 0.01;
/// Halvings of the domain along each input before a slope counts as unproven: cells of 1/64 of it.
const DEEPEST: u32 = 6;

/// Where within the domain the slope is not proven to keep its sign, as shares of the way from its lowest corner to its
/// highest; `None` if it keeps it everywhere.
///
/// The domain is divided into quarters, and these again, until interval arithmetic decides. A sound calibration is
/// decided in a few cells, the worst one in some 5,000; there is no recursion.
pub fn fault<R: Real>(network: &Network<R>, scale: &Scale<R>, x: [R; 2], t: [R; 2]) -> Option<[R; 2]> {
    let half = R::from_f32(0.5);
    let at = |[low, high]: [R; 2], part: R| low + (high - low) * part;
    let [middle, _] = scale.slope_within(network, [at(x, half); 2], [at(t, half); 2]);
    let least = R::from_f32(LEAST_SHARE);
    if !middle.is_finite() || middle == R::ZERO {
        return Some([half; 2]);
    }
    // A path into a quarter tree: two bits of `path` a level, the last level last.
    let (mut depth, mut path) = (0, 0_u32);
    loop {
        let cells = R::from_i64(1 << depth);
        let [i, j] = [column(path), column(path >> 1)].map(|index| R::from_i64(i64::from(index)));
        let within = |ends, index: R| [at(ends, index / cells), at(ends, (index + R::ONE) / cells)];
        let bounds = scale.slope_within(network, within(x, i), within(t, j));
        let [lowest, highest] = ordered(bounds.map(|slope| slope / middle));
        if lowest > least {
            while depth > 0 && path & 3 == 3 {
                (depth, path) = (depth - 1, path >> 2);
            }
            if depth == 0 {
                return None;
            }
            path += 1;
        } else if depth == DEEPEST || highest <= least {
            return Some([(i + half) / cells, (j + half) / cells]);
        } else {
            (depth, path) = (depth + 1, path << 2);
        }
    }
}

/// Every other bit of a path.
fn column(path: u32) -> u32 {
    (0..DEEPEST).map(|level| (path >> (2 * level) & 1) << level).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::{Scaling, Weights};

    /// line[1]·x plus one unit of this weight, threshold and output.
    fn fault_of(line_g: [f32; 4], unit: [f32; 4]) -> Option<[f64; 2]> {
        let mut weights = Weights::ZERO;
        let [x, t, bias, output] = unit;
        (weights.input[3], weights.bias[3], weights.output[3]) = ([x, t], bias, output);
        let scaling = Scaling {
            delta_f_zero_uhz: 0,
            delta_f_gain_per_hz: 1.0,
            temperature_zero_uc: 0,
            temperature_gain_per_c: 1.0,
            line_g,
            output_g: 1.0,
        };
        fault(&Network::<f64>::new(&weights), &Scale::new(&scaling), [-1.0, 1.0], [-1.0, 1.0])
    }

    #[test]
    fn a_slope_of_either_sign_that_stays_is_no_fault() {
        assert_eq!(fault_of([0.0, 1.0, 0.0, 0.0], [0.0; 4]), None);
        assert_eq!(fault_of([5.0, -1e-6, 3.0, 0.0], [0.0; 4]), None);
        // Down to a fiftieth in one corner: not nice, and still a slope.
        assert_eq!(fault_of([0.0, 1.0, 0.0, 0.98], [0.0; 4]), None);
        // A step that the line's slope carries everywhere.
        assert_eq!(fault_of([0.0, 1.0, 0.0, 0.0], [40.0, 3.0, 1.0, -0.02]), None);
        // The network alone: σ(x) from 1 down to a fifth.
        assert_eq!(fault_of([0.0; 4], [1.5, 0.0, 0.0, 1.0]), None);
    }

    #[test]
    fn no_slope_at_all_is_found_in_the_middle() {
        assert_eq!(fault_of([0.3, 0.0, 0.1, 0.0], [0.0; 4]), Some([0.5, 0.5]));
        assert_eq!(fault_of([0.0, f32::INFINITY, 0.0, 0.0], [0.0; 4]), Some([0.5, 0.5]));
    }

    #[test]
    fn where_it_vanishes_or_turns_is_found() {
        let near = |fault: Option<[f64; 2]>, x: f64, t: f64| {
            let [i, j] = fault.expect("a fault");
            assert!((i - x).abs() < 0.02 && (j - t).abs() < 0.02, "{i}, {j}");
        };
        // Vanishes at the hot end only.
        near(fault_of([0.0, 1.0, 0.0, -1.0], [0.0; 4]), 0.01, 0.99);
        // A slope of −1 + 1·40·σ' somewhere within a fortieth of the domain at x = 0.6 only.
        near(fault_of([0.0, 1.0, 0.0, 0.0], [40.0, 0.0, -24.0, -0.026]), 0.8, 0.01);
        // Saturates: no slope beyond |x| = 0.5. Whole quarters are at fault, the first of them is told.
        near(fault_of([0.0; 4], [6.0, 0.0, 0.0, 1.0]), 0.125, 0.125);
    }

    #[test]
    fn what_needs_a_closer_look_in_one_part_is_looked_at_in_all_others() {
        // A dip of −1 at t = −0.7 where the line's slope is 1.35: only a closer look tells the two from −1 and 0.5.
        let dip = [1.0, 20.0, 14.0, -1.0];
        assert_eq!(fault_of([0.0, 1.0, 0.0, -0.5], dip), None);
        // The same where the slope vanishes at the hot end, which comes last.
        let [_, hot] = fault_of([0.0, 1.0, 0.0, -0.999], dip).expect("no slope at t = 1");
        assert!(hot > 0.98, "{hot}");
        // And a dip at the end of both: the last part of all.
        let [x, t] = fault_of([0.0, 1.0, 0.0, -0.5], [20.0, 20.0, -40.0, -0.03]).expect("−0.1 in the corner");
        assert!(x > 0.9 && t > 0.9, "{x}, {t}");
    }

    #[test]
    fn every_cell_of_a_level_is_visited() {
        let mut seen = [[false; 8]; 8];
        for path in 0..64 {
            seen[column(path) as usize][column(path >> 1) as usize] = true;
        }
        assert!(seen.as_flattened().iter().all(|seen| *seen));
    }
}
