//! Unknown initial states: what effects with a memory brought along from before a run. Nobody saw it, and it fades with
//! the effect's own memory.

use crate::diagnose::cells::{Cells, RunCells};
use crate::diagnose::forward::EffectSet;
use firmware_core::Memory;

/// How much of an effect's initial state is still there, of each way in which it may have begun: one for a lag; for a play
/// two, as it may have begun at either end.
pub type Share = [f64; 2];
/// No memory, or none left.
pub const FORGOTTEN: Share = [0.0; 2];
/// So many effects' initial states are told apart; any further ones share the last place.
pub const PLACES: usize = 4;
/// A share for each place.
pub type Shares = [Share; PLACES];

/// How much of what effects brought along from before each run is still there, cell by cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialStates {
    /// Run by run; empty where nothing is remembered.
    runs: Vec<Vec<Shares>>,
    /// Place and way of those that are there in any cell.
    present: Vec<(usize, usize)>,
}

impl InitialStates {
    /// Those of these effects in these cells.
    pub fn of(cells: &Cells, set: &EffectSet) -> Self {
        let memories: Vec<_> = set.memories().filter(|memory| *memory != Memory::None).collect();
        if memories.is_empty() {
            return Self::default();
        }
        let shares = |run: &RunCells| {
            let mut shares = vec![[FORGOTTEN; PLACES]; run.cells.len()];
            for (at, memory) in memories.iter().enumerate() {
                mark(run, &mut shares, at.min(PLACES - 1), *memory);
            }
            shares
        };
        let runs: Vec<Vec<Shares>> = cells.runs.iter().map(shares).collect();
        let is_there = |(place, way): &(usize, usize)| runs.iter().flatten().any(|cell| cell[*place][*way] > 0.0);
        let all = (0..PLACES).flat_map(|place| (0..FORGOTTEN.len()).map(move |way| (place, way)));
        let present = all.filter(is_there).collect();
        Self { runs, present }
    }

    /// Place and way of those that are there in any cell.
    pub fn present(&self) -> &[(usize, usize)] {
        &self.present
    }

    /// Whether anything is left of this effect's in any cell.
    pub fn remembers(&self, place: usize) -> bool {
        self.present.iter().any(|(other, _)| *other == place)
    }

    /// Of a run, cell by cell; nothing where nothing is remembered.
    pub fn of_run(&self, run: usize) -> &[Shares] {
        self.runs.get(run).map_or(&[], Vec::as_slice)
    }
}

/// What a run has in a cell of which nothing is remembered.
pub const NOTHING: Shares = [FORGOTTEN; PLACES];

/// Marks in each cell of a run how much is left of what this memory began with.
fn mark(run: &RunCells, shares: &mut [Shares], place: usize, memory: Memory<f64>) {
    match memory {
        Memory::None => {}
        Memory::Lag { tau_s } => {
            for (cell, shares) in run.cells.iter().zip(shares) {
                shares[place][0] = shares[place][0].max((-cell.time_s / tau_s).exp());
            }
        }
        Memory::Play { radius } => mark_play(run, shares, place, radius),
    }
}

/// A play that began at an end of its own, less one that began in the middle.
fn mark_play(run: &RunCells, shares: &mut [Shares], place: usize, radius: f64) {
    let temperature_c = |row: usize| f64::from(run.run.rows[row].sample.temperature_uc) * 1e-6;
    let mut trailing = [-radius, 0.0, radius];
    let mut last_c = run.cells.first().map_or(0.0, |cell| temperature_c(cell.rows.start));
    for (cell, shares) in run.cells.iter().zip(shares) {
        let mut sums = FORGOTTEN;
        for row in cell.rows.clone() {
            let now_c = temperature_c(row);
            trailing.iter_mut().for_each(|one| *one = (*one + now_c - last_c).clamp(-radius, radius));
            last_c = now_c;
            let [low, middle, high] = trailing;
            sums.iter_mut().zip([middle - low, high - middle]).for_each(|(sum, part)| *sum += part / radius);
        }
        for (share, sum) in shares[place].iter_mut().zip(sums) {
            *share = share.max(sum / cell.samples);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{Row, Run};
    use crate::diagnose::cells::{Cell, Groups};
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

    fn marked(run: &Run, memory: Memory<f64>) -> Vec<Share> {
        let cells = (0..run.rows.len()).map(|index| Cell::plain(index, index as f64 * 60.0, 60.0)).collect();
        let mut shares = vec![NOTHING; run.rows.len()];
        mark(&RunCells { run, cells, groups: Groups::default() }, &mut shares, 1, memory);
        assert!(shares.iter().all(|cell| cell[0] == FORGOTTEN));
        shares.iter().map(|cell| cell[1]).collect()
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
