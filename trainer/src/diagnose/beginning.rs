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
