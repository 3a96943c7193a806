//! Campaigns, small and sound, and then spoilt.

use super::random::Random;

/// A table as bytes, the options that go with it, and what was done to it.
pub struct Spoilt {
    pub bytes: Vec<u8>,
    pub options: Vec<String>,
    pub training: Vec<String>,
    pub how: Vec<&'static str>,
}

/// Header and cells.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

const NUMBERS: [&str; 26] = [
    "NaN",
    "inf",
    "-inf",
    "1e30",
    "-1e30",
    "1e308",
    "1e-308",
    "5e-324",
    "-0",
    "0",
    "",
    " ",
    "9223372036854775807",
    "-9223372036854.775808",
    "1e18",
    "1.7e9",
    "-1",
    "85",
    "-127",
    "1e5",
    "abc",
    "1,5",
    "0x10",
    "\u{1b}[31m",
    "1e",
    "٣",
];
const HEADERS: [&str; 9] =
    ["", "time_s", "reference_g", "temperature_c", "run", "\u{1b}]0;x\u{7}", "a,b", "f1_hz", "power_on_s"];
const EFFECTS_ON: [&str; 5] = ["supply_v", "humidity_pct", "pressure_pa", "vibration_g2", "age_days"];

/// A sound campaign of few rows and many kinds.
fn sound(random: &mut Random) -> Table {
    let (runs, rows) = (2 + random.below(4), 30 + random.below(50));
    let pair = random.below(3) == 0;
    let mut header: Vec<String> = ["run", "kind", "time_s", "temperature_c", "reference_g"].map(str::to_owned).to_vec();
    header.extend(if pair { vec!["f1_hz".to_owned(), "f2_hz".to_owned()] } else { vec!["delta_f_hz".to_owned()] });
    let channels = random.below(3);
    header.extend((0..channels).map(|channel| EFFECTS_ON[channel].to_owned()));
    let kind = random.of(&["full", "zero", "ramp", "tumble", "static"]).to_owned();
    let still = random.below(6) == 0;
    let mut table = Table { header, rows: Vec::new() };
    for run in 0..runs {
        for row in 0..rows {
            let temperature_c = 20.0 + 40.0 * (row as f64 / rows as f64 * 6.3).sin();
            let reference_g = if still { 0.0 } else { [-1.0, -0.5, 0.0, 0.5, 1.0, 0.966][(row / 4) % 6] };
            let delta_hz = 76.0 + 420.0 * reference_g + 0.03 * temperature_c + 2e-3 * random.unit();
            let mut cells = vec![
                format!("{kind}-{run}"),
                kind.clone(),
                format!("{}", row * 10),
                format!("{temperature_c:.4}"),
                format!("{reference_g}"),
            ];
            match pair {
                true => cells.extend([format!("{:.6}", 40_000.0 + delta_hz), "40000.0".to_owned()]),
                false => cells.push(format!("{delta_hz:.6}")),
            }
            cells.extend((0..channels).map(|channel| format!("{:.4}", 5.0 + channel as f64 + 0.1 * random.unit())));
            table.rows.push(cells);
        }
    }
    table
}

/// Spoils a sound campaign in one to three ways, mostly such that it can still be read.
pub fn spoilt(random: &mut Random) -> Spoilt {
    let mut table = sound(random);
    let mut how = Vec::new();
    let is_harsh = random.below(4) == 0;
    for _ in 0..1 + random.below(3) {
        how.push(if is_harsh { spoil(&mut table, random) } else { distort(&mut table, random) });
    }
    let mut bytes = written(&table, random.of(&[",", ",", ",", ";", "\t"]));
    if is_harsh && random.below(3) == 0 {
        how.push(spoil_bytes(&mut bytes, random));
    }
    Spoilt { bytes, options: options(random), training: training(random), how }
}

/// What a sensor, a thermometer or a logger may do.
fn distort(table: &mut Table, random: &mut Random) -> &'static str {
    if random.below(2) == 0 { distort_column(table, random) } else { distort_rows(table, random) }
}

const TIME: usize = 2;
const TEMPERATURE: usize = 3;
const REFERENCE: usize = 4;
const SIGNAL: usize = 5;

fn distort_column(table: &mut Table, random: &mut Random) -> &'static str {
    let scale = 10_f64.powi(random.below(19) as i32 - 9);
    let deeds = [
        (REFERENCE, Deed::Times(scale), "the reference in another unit"),
        (SIGNAL, Deed::Times(scale), "the signal in another unit"),
        (REFERENCE, Deed::Times(-1.0), "the reference negated"),
        (TIME, Deed::Plus(1.7e9), "a calendar's clock"),
        (TEMPERATURE, Deed::Round, "a coarse thermometer"),
        (TEMPERATURE, Deed::Becomes(25.0), "one temperature"),
        (SIGNAL, Deed::Clip(300.0), "a clipped signal"),
    ];
    let (column, deed, how) = deeds[random.below(deeds.len())];
    change(table, column, deed);
    how
}

/// What is done to every number of a column.
#[derive(Clone, Copy)]
enum Deed {
    Times(f64),
    Plus(f64),
    Becomes(f64),
    Clip(f64),
    Round,
}

impl Deed {
    fn of(self, number: f64) -> f64 {
        match self {
            Self::Times(factor) => number * factor,
            Self::Plus(shift) => number + shift,
            Self::Becomes(value) => value,
            Self::Clip(most) => number.clamp(-most, most),
            Self::Round => number.round(),
        }
    }
}

fn distort_rows(table: &mut Table, random: &mut Random) -> &'static str {
    match random.below(5) {
        0 => {
            for _ in 0..1 + random.below(4) {
                let (row, column) = (random.below(table.rows.len()), TEMPERATURE + random.below(3));
                set(table, row, column, random.of(&["0", "85", "-127", "9.81", "-5", "1000", "1e-9", "-0.0"]));
            }
            "wrong rows"
        }
        1 => {
            let later = |row: &Vec<String>| {
                let mut row = row.clone();
                row[TIME] += ".5";
                row
            };
            table.rows = table.rows.iter().flat_map(|row| [row.clone(), later(row)]).collect();
            "every row again half a second later"
        }
        2 => {
            table.rows.iter_mut().enumerate().for_each(|(index, row)| row[0] = format!("run-{}", index / 7));
            "a run for every seven rows"
        }
        3 => {
            let factor = [-1.0, 9.806_65, 0.0][random.below(3)];
            for row in table.rows.iter_mut().filter(|row| row[0].ends_with("-1")) {
                row[REFERENCE] = format!("{:?}", row[REFERENCE].parse::<f64>().unwrap_or(0.0) * factor);
            }
            "one run's reference in another unit"
        }
        _ => {
            let prefix = random.of(&["\u{1b}[2J", "\u{202e}", "'; rm x; '", "<b>", "a b"]);
            table.rows.iter_mut().for_each(|row| row[0] = format!("{prefix}{}", row[0]));
            "strange names of runs"
        }
    }
}

fn written(table: &Table, separator: &str) -> Vec<u8> {
    let mut text = table.header.join(separator) + "\n";
    for row in &table.rows {
        text += &row.join(separator);
        text.push('\n');
    }
    text.into_bytes()
}

/// The numbers of one column; what is none stays.
fn change(table: &mut Table, column: usize, deed: Deed) {
    for row in &mut table.rows {
        if let Some(number) = row.get(column).and_then(|cell| cell.parse::<f64>().ok()) {
            row[column] = format!("{:?}", deed.of(number));
        }
    }
}

fn spoil(table: &mut Table, random: &mut Random) -> &'static str {
    match random.below(7) {
        0..=1 => spoil_cells(table, random),
        2..=4 => spoil_column(table, random),
        _ => spoil_rows(table, random),
    }
}

fn spoil_cells(table: &mut Table, random: &mut Random) -> &'static str {
    if random.below(2) == 0 {
        let (row, column) = (random.below(table.rows.len()), random.below(table.header.len()));
        set(table, row, column, random.of(&NUMBERS));
        return "one cell";
    }
    for _ in 0..5 {
        let (row, column) = (random.below(table.rows.len()), 2 + random.below(5));
        set(table, row, column, random.of(&["0", "85", "-127", "1e5", "1e30", "-1e9", "1e-30"]));
    }
    "some cells"
}

fn spoil_column(table: &mut Table, random: &mut Random) -> &'static str {
    let column = random.below(table.header.len());
    let (deed, how) = match random.below(6) {
        0 => (Deed::Times(10_f64.powi(random.below(49) as i32 - 24)), "a column scaled"),
        1 => (Deed::Times(-1.0), "a column negated"),
        2 => (Deed::Plus([1e3, 1.7e9, -1e6, 1e12, 273.15, 1e18][random.below(6)]), "a column shifted"),
        3 => (Deed::Becomes([0.0, 1.0, -1.0, 1e-9, 1e9][random.below(5)]), "a column constant"),
        4 => {
            let other = random.below(table.header.len());
            table.header.swap(column, other);
            return "two names swapped";
        }
        _ => {
            table.header[column] = random.of(&HEADERS).to_owned();
            return "a name spoilt";
        }
    };
    change(table, column, deed);
    how
}

fn spoil_rows(table: &mut Table, random: &mut Random) -> &'static str {
    let (row, other) = (random.below(table.rows.len()), random.below(table.rows.len()));
    match random.below(6) {
        0 => {
            table.rows.swap(row, other);
            "rows swapped"
        }
        1 => {
            table.rows = table.rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
            "rows doubled"
        }
        2 => {
            table.rows.truncate(row.max(1));
            "cut short"
        }
        3 => {
            table.rows.iter_mut().for_each(|row| drop(row.pop()));
            "the last column without values"
        }
        4 => {
            table.rows.iter_mut().enumerate().for_each(|(index, row)| row[0] = format!("run-{}", index / 3));
            "a run for every three rows"
        }
        _ => {
            let names = ["\u{1b}[2J", "a\rb", "\u{202e}evil", "'; rm x; '", "", "run,run", "\u{0}"];
            let name = random.of(&names);
            table.rows.iter_mut().for_each(|row| row[0] = name.to_owned());
            "a run's name spoilt"
        }
    }
}

fn set(table: &mut Table, row: usize, column: usize, value: &str) {
    if let Some(cell) = table.rows.get_mut(row).and_then(|row| row.get_mut(column)) {
        value.clone_into(cell);
    }
}

fn spoil_bytes(bytes: &mut Vec<u8>, random: &mut Random) -> &'static str {
    let at = random.below(bytes.len());
    match random.below(5) {
        0 => {
            bytes.truncate(at);
            "bytes cut off"
        }
        1 => {
            bytes.insert(at, 0);
            "a NUL"
        }
        2 => {
            bytes[at] = random.next() as u8;
            "a byte changed"
        }
        3 => {
            bytes.splice(0..0, *b"\xef\xbb\xbf# x\r\n");
            "a mark and a comment before it"
        }
        _ => {
            bytes.splice(at..at, std::iter::repeat_n(b'7', 100_000));
            "a long run of digits"
        }
    }
}

/// Options of reading, mostly none.
fn options(random: &mut Random) -> Vec<String> {
    let choices: [&[&str]; 6] = [
        &["--constant-reference", "0"],
        &["--constant-reference", "1e30"],
        &["--map", "time_s=row*1e300"],
        &["--map", "temperature_c=reference_g*1e9"],
        &["--signal", "delta_f_hz", "--signal-unit", "ppm"],
        &["--channels", "supply_v"],
    ];
    seldom(&choices, random)
}

/// Options of training, mostly none.
fn training(random: &mut Random) -> Vec<String> {
    let choices: [&[&str]; 6] = [
        &["--scale-factor", "420"],
        &["--scale-factor", "0"],
        &["--scale-factor", "-1e300"],
        &["--scale-factor", "nan"],
        &["--hold-out", "none"],
        &["--hold-out", "full-0"],
    ];
    seldom(&choices, random)
}

fn seldom(choices: &[&[&str]], random: &mut Random) -> Vec<String> {
    let chosen = random.below(8 * choices.len());
    choices.get(chosen).into_iter().copied().flatten().map(|&word| word.to_owned()).collect()
}
