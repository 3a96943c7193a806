//! Where a method is above the paper's numbers, and whether the sensor's own static map is too.

use super::evolution::Quartiles;
use super::judgement::Judgement;
use super::paper::{PaperRow, ROWS};

/// A cell of the tables above the paper's IFA-BP.
#[derive(Clone, Debug)]
pub struct Shortfall {
    /// The cell.
    pub row: PaperRow,
    /// What the method leaves.
    pub found: f64,
    /// What the perfect static map leaves in the same recording.
    pub perfect: f64,
    /// The same over campaigns that differ in their seed only.
    pub campaigns: Quartiles,
    /// What to take out of the laboratory so that the perfect static map leaves least, and what it leaves then.
    pub without: Option<(String, f64)>,
}

/// Perfect static maps, each judged on a campaign of its own.
#[derive(Clone, Debug)]
pub struct Perfection {
    /// On the campaign itself.
    pub here: Judgement,
    /// On campaigns with other seeds.
    pub elsewhere: Vec<Judgement>,
    /// On the campaign with one imperfection of the laboratory or the sensor taken out, by its name.
    pub without: Vec<(String, Judgement)>,
}

/// The cells in which `judgement` is above the paper's IFA-BP.
#[must_use]
pub fn shortfalls(judgement: &Judgement, perfection: &Perfection) -> Vec<Shortfall> {
    let shortfall = |index: usize| {
        let row = ROWS[index];
        let found = judgement.cells[index].filter(|found| *found > row.ifa_bp)?;
        let cell = |judgement: &Judgement| judgement.cells[index];
        let without = perfection.without.iter().filter_map(|(name, left)| Some((name.clone(), cell(left)?)));
        Some(Shortfall {
            row,
            found,
            perfect: cell(&perfection.here)?,
            campaigns: Quartiles::of(perfection.elsewhere.iter().filter_map(cell).collect())?,
            without: without.min_by(|a, b| a.1.total_cmp(&b.1)),
        })
    };
    (0..ROWS.len()).filter_map(shortfall).collect()
}

impl Shortfall {
    /// Whether the sensor itself does it: even its perfect static map is above the paper's number here, or would be in
    /// half of all campaigns.
    #[must_use]
    pub fn even_the_perfect_map_is_above(&self) -> bool {
        self.perfect > self.row.ifa_bp || self.campaigns.median > self.row.ifa_bp
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::sweep::Sweep;

    fn judgement(bias_variation: f64) -> Judgement {
        let mut cells = ROWS.map(|row| Some(row.ifa_bp));
        cells[7] = Some(bias_variation);
        let sweep = Sweep { curves: Vec::new() };
        Judgement { name: String::new(), cells, residual_ug: 0.0, sweep, restarts_ug: Vec::new() }
    }

    #[test]
    fn what_is_above_the_paper_is_explained_by_what_the_perfect_map_leaves() {
        let perfection = Perfection {
            here: judgement(50.0),
            elsewhere: [30.0, 40.0, 50.0].map(judgement).to_vec(),
            without: vec![("warm-up".to_owned(), judgement(49.0)), ("rig".to_owned(), judgement(3.0))],
        };
        let found = shortfalls(&judgement(60.0), &perfection);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].row.ifa_bp, found[0].found, found[0].campaigns.median), (32.967, 60.0, 40.0));
        assert_eq!(found[0].without, Some(("rig".to_owned(), 3.0)));
        assert!(found[0].even_the_perfect_map_is_above());
        assert!(shortfalls(&judgement(20.0), &perfection).is_empty());
    }
}
