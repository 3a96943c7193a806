//! Circles among what stands in one folder.

use crate::house::{Arrow, File, House};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// As many lines show why one part needs another.
const SHOWN: usize = 3;

/// Of each part the parts that it needs, and the arrows that show it.
type Needs<'a> = BTreeMap<String, BTreeMap<String, Vec<&'a Arrow>>>;

/// A folder of modules and its circles.
pub struct Circle<'a> {
    /// The module whose children they are; empty for the crate.
    pub folder: Vec<String>,
    /// The parts that need each other, in the order of the circle; the folder's own file has the folder's name.
    parts: Vec<String>,
    /// For each part, arrows that lead from it to the next.
    arrows: Vec<Vec<&'a Arrow>>,
}

/// Of every folder, the shortest circle of each knot.
pub fn circles(house: &House) -> Vec<Circle<'_>> {
    let arrows: Vec<&Arrow> = house.arrows.iter().collect();
    let folders: BTreeSet<&[String]> =
        house.files.iter().flat_map(|file| (0..file.module.len()).map(|depth| &file.module[..depth])).collect();
    folders.into_iter().flat_map(|folder| circles_in(house, folder, &arrows)).collect()
}

/// The part of `folder` in which a module stands: a child with all below it, or the folder's own file.
fn part(file: &File, folder: &[String]) -> Option<String> {
    let below = file.module.strip_prefix(folder)?;
    below.first().cloned().or_else(|| Some(file.name.file_name()?.to_string_lossy().into_owned()))
}

fn circles_in<'a>(house: &House, folder: &[String], arrows: &[&'a Arrow]) -> Vec<Circle<'a>> {
    let mut needs: Needs = BTreeMap::new();
    for &arrow in arrows {
        let ends = [arrow.from, arrow.to].map(|file| part(&house.files[file], folder));
        if let [Some(from), Some(to)] = ends
            && from != to
        {
            needs.entry(from).or_default().entry(to).or_default().push(arrow);
        }
    }
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for start in needs.keys() {
        if seen.contains(start) {
            continue;
        }
        if let Some(parts) = shortest_circle(&needs, start) {
            seen.extend(parts.iter().cloned());
            found.push(parts);
        }
    }
    let mut step =
        |from: &str, to: &str| needs.get_mut(from).and_then(|to_others| to_others.remove(to)).unwrap_or_default();
    let circle = |parts: Vec<String>| {
        let next = parts.iter().cycle().skip(1);
        let arrows = parts.iter().zip(next).map(|(from, to)| step(from, to)).collect();
        Circle { folder: folder.to_vec(), parts, arrows }
    };
    found.into_iter().map(circle).collect()
}

/// The shortest way from `start` back to it.
fn shortest_circle(needs: &Needs, start: &str) -> Option<Vec<String>> {
    let mut ways = vec![vec![start.to_owned()]];
    let mut reached = BTreeSet::new();
    while !ways.is_empty() {
        let mut longer = Vec::new();
        for way in ways {
            let last = way.last().expect("a way begins somewhere");
            for next in needs.get(last).into_iter().flat_map(BTreeMap::keys) {
                if next == start {
                    return Some(way);
                }
                if reached.insert(next.clone()) {
                    longer.push([way.as_slice(), std::slice::from_ref(next)].concat());
                }
            }
        }
        ways = longer;
    }
    None
}

impl Circle<'_> {
    /// The files and lines that form it.
    pub fn told(&self, house: &House) -> String {
        let mut told = format!("{}\n", [self.parts.as_slice(), &self.parts[..1]].concat().join(" → "));
        for arrow in self.arrows.iter().flat_map(|arrows| arrows.iter().take(SHOWN)) {
            let [from, to] = [arrow.from, arrow.to].map(|file| house.files[file].name.display());
            let _ = writeln!(told, "  {from}:{} names {}, which {to} defines", arrow.line, arrow.name);
        }
        told
    }
}
