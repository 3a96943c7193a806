//! Campaigns and results as files, for other programs.

use crate::case::Case;
use crate::options::Options;
use crate::outcomes::rates;
use crate::record::Record;
use serde_json::{Value, json};
use std::fs::{File, create_dir_all, read_to_string, write};
use std::io::BufWriter;
use std::path::Path;

/// Writes the campaign, and its truth into `truth.json` beside it.
pub fn campaign(options: &Options, case: &Case) {
    if let Some(folder) = &options.save
        && let Err(error) = save(folder, case)
    {
        eprintln!("{}: {error}", folder.display());
    }
}

/// As `bench/peers/discover` reads it: what each hides, and the noise floor; and more about each.
fn save(folder: &Path, case: &Case) -> std::io::Result<()> {
    create_dir_all(folder)?;
    let name = format!("{}-{}-{:04}", case.protocol.name(), case.class.name(), case.index);
    case.recording.write_csv(&mut BufWriter::new(File::create(folder.join(format!("{name}.csv")))?))?;
    let path = folder.join("truth.json");
    // Several calls may fill one folder, so what is there stays.
    let mut truth: Value =
        read_to_string(&path).ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_else(|| json!({}));
    let hidden: Vec<&str> = case.hidden.iter().map(|hidden| hidden.name.as_str()).collect();
    let sigmas: Vec<f64> = case.hidden.iter().map(|hidden| case.visible_sigma(hidden)).collect();
    truth["noise_ug"] = json!(case.noise_floor_ug);
    truth["hidden"][&name] = json!(hidden);
    truth["campaigns"][&name] = json!({
        "class": case.class.name(),
        // The weakest: whether all of it can be seen.
        "visible_sigma": sigmas.iter().copied().reduce(f64::min),
        "visible_sigmas": sigmas,
        "rig": case.rig,
        "seed": case.seed,
        "sample_ug": case.sample_ug,
        "effects": case.effects,
    });
    write(path, format!("{truth:#}\n"))
}

/// Writes all results so far: whoever stops a long run keeps what there is.
pub fn results(options: &Options, records: &[Record]) {
    let Some(path) = &options.json else { return };
    let all: Vec<&Record> = records.iter().collect();
    let value = json!({ "seed": options.seed, "rates": rates(&all), "campaigns": records });
    if let Err(error) = write(path, format!("{value:#}\n")) {
        eprintln!("{}: {error}", path.display());
    }
}
