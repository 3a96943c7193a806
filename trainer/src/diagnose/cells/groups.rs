//! A run in fewer rows: enough for an effect that sits at a place, which follows temperature and level and remembers
//! nothing. Most candidates are such an effect at one place or another.

use crate::campaign::Row;
use crate::diagnose::thresholds::{SAME_GROUP_C, SAME_GROUP_G};
use std::ops::Range;

/// A cell's neighbours in groups, each with their mean temperature and level.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    /// The groups in order; what else was measured is the first one's.
    pub rows: Vec<Row>,
    /// Of each group, its cell and its share of the cell's samples.
    pub places: Vec<(usize, f64)>,
}

impl Groups {
    /// Of these cells, each a range of `rows`.
    pub fn new<'a>(rows: &[Row], cells: impl Iterator<Item = &'a Range<usize>>) -> Self {
        let mut groups = Self::default();
        for (index, cell) in cells.enumerate() {
            let mut rest = &rows[cell.clone()];
            while let Some(first) = rest.first() {
                let length = rest.iter().take_while(|row| is_same(first, row)).count();
                let (own, others) = rest.split_at(length);
                groups.rows.push(mean(first, own));
                groups.places.push((index, own.len() as f64 / cell.len() as f64));
                rest = others;
            }
        }
        groups
    }
}

fn is_same(first: &Row, row: &Row) -> bool {
    let away_c = f64::from(row.sample.temperature_uc.abs_diff(first.sample.temperature_uc)) * 1e-6;
    away_c < SAME_GROUP_C && (row.reference_g - first.reference_g).abs() < SAME_GROUP_G
}

fn mean(first: &Row, rows: &[Row]) -> Row {
    let temperatures_uc: i64 = rows.iter().map(|row| i64::from(row.sample.temperature_uc)).sum();
    let mut mean = *first;
    mean.sample.temperature_uc = (temperatures_uc / rows.len() as i64) as i32;
    mean.reference_g = rows.iter().map(|row| row.reference_g).sum::<f64>() / rows.len() as f64;
    mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Sample;

    #[test]
    fn groups_are_of_one_temperature_and_level_and_together_weigh_as_much_as_the_cell() {
        let row = |(temperature_uc, reference_g)| {
            let sample = Sample::from_difference(0, 0, temperature_uc);
            Row { sample, reference_g, reference_sigma_g: None }
        };
        let measured =
            [(0, 1.0), (0, 1.0), (20_000, 1.0), (40_000, 1.0), (140_000, 1.0), (150_000, 1.0), (150_000, 0.5)];
        let rows: Vec<Row> = measured.map(row).into();
        let groups = Groups::new(&rows, [0..1, 1..7].iter());
        let found: Vec<(i32, f64)> =
            groups.rows.iter().map(|row| (row.sample.temperature_uc, row.reference_g)).collect();
        assert_eq!(found, [(0, 1.0), (20_000, 1.0), (145_000, 1.0), (150_000, 0.5)]);
        assert_eq!(groups.places, [(0, 1.0), (1, 3.0 / 6.0), (1, 2.0 / 6.0), (1, 1.0 / 6.0)]);
    }
}
