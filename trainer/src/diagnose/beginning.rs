//! What effects with a memory brought along from before a run: nobody saw it, and it fades with the effect's own memory.

use super::layout::Stretch;
use firmware_core::Memory;

/// How much of what an effect brought along is still there, of each way in which it may have begun: one for a lag; for a
/// play two, as it may have begun at either end.
pub(super) type Beginning = [f64; 2];
/// No memory, or none left.
pub(super) const FORGOTTEN: Beginning = [0.0; 2];
/// So many effects' beginnings are told apart; any further ones share the last place.
pub(super) const BEGINNINGS: usize = 4;

/// Marks in each cell of a run how much is left of what this memory began with.
pub(super) fn mark(stretch: &mut Stretch, place: usize, memory: Memory<f64>) {
    match memory {
        Memory::None => {}
        Memory::Lag { tau_s } => {
            for cell in &mut stretch.cells {
                let left = &mut cell.beginnings[place][0];
                *left = left.max((-cell.time_s / tau_s).exp());
            }
        }
        Memory::Play { radius } => mark_play(stretch, place, radius),
    }
}

/// A play that began at an end of its own, less one that began in the middle.
fn mark_play(stretch: &mut Stretch, place: usize, radius: f64) {
    let temperature_c = |row: usize| f64::from(stretch.run.rows[row].sample.temperature_uc) * 1e-6;
    let mut trailing = [-radius, 0.0, radius];
    let mut last_c = stretch.cells.first().map_or(0.0, |cell| temperature_c(cell.rows.start));
    for cell in &mut stretch.cells {
        let mut sums = FORGOTTEN;
        for row in cell.rows.clone() {
            let now_c = temperature_c(row);
            trailing.iter_mut().for_each(|one| *one = (*one + now_c - last_c).clamp(-radius, radius));
            last_c = now_c;
            let [low, middle, high] = trailing;
            sums.iter_mut().zip([middle - low, high - middle]).for_each(|(sum, part)| *sum += part / radius);
        }
        for (left, sum) in cell.beginnings[place].iter_mut().zip(sums) {
            *left = left.max(sum / cell.samples);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::gathered::Gathered;
    use super::super::layout::Cell;
    use super::*;
    use crate::campaign::{Row, Run};
    use protocol::Sample;
    use std::path::PathBuf;

    /// One cell a sample, a minute apart, at these temperatures in °C.
    fn run(temperatures_c: &[i32]) -> Run {
        let row = |(index, c): (usize, &i32)| {
            let sample = Sample::from_difference(index as u64 * 60_000_000, 0, c * 1_000_000);
            Row { sample, reference_g: 0.0, reference_sigma_g: None }
        };
        let rows = temperatures_c.iter().enumerate().map(row).collect();
        Run { name: String::new(), kind: String::new(), source: PathBuf::new(), rows }
    }

    fn marked(run: &Run, memory: Memory<f64>) -> Vec<Beginning> {
        let cells = (0..run.rows.len()).map(|index| Cell::plain(index, index as f64 * 60.0, 60.0)).collect();
        let mut stretch = Stretch { run, cells, gathered: Gathered::default() };
        mark(&mut stretch, 1, memory);
        assert!(stretch.cells.iter().all(|cell| cell.beginnings[0] == FORGOTTEN));
        stretch.cells.iter().map(|cell| cell.beginnings[1]).collect()
    }

    #[test]
    fn a_lag_forgets_by_the_clock() {
        let run = run(&[20, 50, 50]);
        let left = marked(&run, Memory::Lag { tau_s: 120.0 });
        assert_eq!(left.iter().map(|both| both[0]).collect::<Vec<f64>>(), [1.0, (-0.5_f64).exp(), (-1.0_f64).exp()]);
    }

    #[test]
    fn a_play_forgets_by_the_way_that_the_temperature_has_gone() {
        // At rest it forgets nothing. On the way up, a start that trailed fades at once, one that led when the middle has
        // come to trail: after twice the way it is gone.
        let run = run(&[20, 20, 24, 30, 34, 40, 20]);
        let left = marked(&run, Memory::Play { radius: 10.0 });
        let of_end = |end: usize| left.iter().map(|both| both[end]).collect::<Vec<f64>>();
        let near = |found: Vec<f64>, worked: [f64; 7]| found.iter().zip(worked).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near(of_end(0), [1.0, 1.0, 1.0, 1.0, 0.6, 0.0, 0.0]), "{left:?}");
        assert!(near(of_end(1), [1.0, 1.0, 0.6, 0.0, 0.0, 0.0, 0.0]), "{left:?}");
    }
}
