//! Fewer marks that look like all of them: the extremes stay.

/// Marks of one layer at most; more cannot be told apart on a page.
pub const MOST: usize = 3000;
/// Columns of a chart, in each of which the lowest and the highest stay.
pub const COLUMNS: usize = 300;
/// Rows of a chart; one mark of every cell stays as long as there is room.
const ROWS: usize = 200;

/// Which of the points to draw, ascending: all if there are few; otherwise the lowest and the highest of
/// each column, then one of each cell of a fine grid, spread evenly over the cells. Points are in parts of
/// the axes, 0 to 1.
#[must_use]
pub fn thin(points: &[[f64; 2]]) -> Vec<usize> {
    if points.len() <= MOST {
        return (0..points.len()).collect();
    }
    let mut kept = extremes(points);
    let cells = one_of_each_cell(points);
    let room = MOST.saturating_sub(kept.len());
    if cells.len() <= room {
        kept.extend(cells);
    } else {
        kept.extend((0..room).map(|k| cells[k * cells.len() / room]));
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

fn extremes(points: &[[f64; 2]]) -> Vec<usize> {
    let mut columns: Vec<Option<[usize; 2]>> = vec![None; COLUMNS];
    for (index, [x, y]) in points.iter().enumerate() {
        let column = &mut columns[slot(*x, COLUMNS)];
        let [low, high] = column.get_or_insert([index, index]);
        if *y < points[*low][1] {
            *low = index;
        }
        if *y > points[*high][1] {
            *high = index;
        }
    }
    let by_x = |a: &usize, b: &usize| points[*a][0].total_cmp(&points[*b][0]);
    let sides = [(0..points.len()).min_by(by_x), (0..points.len()).max_by(by_x)];
    columns.into_iter().flatten().flatten().chain(sides.into_iter().flatten()).collect()
}

fn one_of_each_cell(points: &[[f64; 2]]) -> Vec<usize> {
    let mut taken = vec![false; COLUMNS * ROWS];
    let mut first: Vec<(usize, usize)> = Vec::new();
    for (index, [x, y]) in points.iter().enumerate() {
        let cell = slot(*x, COLUMNS) * ROWS + slot(*y, ROWS);
        if !std::mem::replace(&mut taken[cell], true) {
            first.push((cell, index));
        }
    }
    first.sort_unstable();
    first.into_iter().map(|(_, index)| index).collect()
}

fn slot(part: f64, slots: usize) -> usize {
    ((part * slots as f64) as usize).min(slots - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_all_stay() {
        assert_eq!(thin(&[[0.5, 0.5], [0.5, 0.5], [0.1, 0.9]]), [0, 1, 2]);
    }

    #[test]
    fn of_many_points_the_extremes_stay() {
        let wave = |k: usize| 0.5 + 0.3 * (k as f64 * 2.399_963).sin();
        let mut points: Vec<[f64; 2]> = (0..200_000).map(|k| [k as f64 / 200_000.0, wave(k)]).collect();
        points[123_457][1] = 0.99;
        points[77][1] = 0.001;
        let kept = thin(&points);
        assert!(kept.len() <= MOST && kept.len() > MOST * 8 / 10, "{}", kept.len());
        for extreme in [123_457, 77, 0, 199_999] {
            assert!(kept.binary_search(&extreme).is_ok(), "{extreme}");
        }
    }

    #[test]
    fn where_points_pile_up_and_where_they_are_rare_both_are_seen() {
        // All but ten lie in one corner; the ten stand alone in cells of their own.
        let mut points = vec![[0.01, 0.01]; 50_000];
        points.extend((0..10).map(|k| [0.5, 0.1 + 0.08 * f64::from(k)]));
        assert_eq!(thin(&points).iter().filter(|index| **index >= 50_000).count(), 10);
    }
}
