//! What effects do in each cell.

use super::effect_set::{EffectSet, is_placed};
use crate::campaign::Row;
use crate::diagnose::cells::{Cells, RunCells};
use crate::fit::effects::{self, Contribution, mean_contribution};
use rayon::prelude::*;

/// Mean contributions of the cells, run by run.
pub type Contributions = Vec<Vec<Contribution>>;

/// What the effects do in each cell.
pub fn contributions(cells: &Cells, set: &EffectSet) -> Contributions {
    let (placed, others) = set.split(is_placed);
    let of = |run: &RunCells| {
        let course = |rows: &[Row], set: &EffectSet| {
            let some = !set.effects.is_empty();
            some.then(|| effects::contributions(rows, &set.effects, &set.coefficients, cells.max_gap_us)).flatten()
        };
        let mut all = match course(&run.run.rows, &others) {
            Some(course) => run.cells.iter().map(|cell| mean_contribution(&course[cell.rows.clone()])).collect(),
            None => vec![Contribution::default(); run.cells.len()],
        };
        if let Some(course) = course(&run.groups.rows, &placed) {
            for (&(cell, share), contribution) in run.groups.places.iter().zip(course) {
                all[cell] = all[cell].plus(&contribution.times(share));
            }
        }
        all
    };
    cells.runs.par_iter().map(of).collect()
}
