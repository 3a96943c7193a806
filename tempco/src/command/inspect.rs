//! `tempco inspect FILE`

use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::hex::first_piece;
use crate::table::Table;
use crate::terminal::say;
use clap::Args;
use firmware_core::Compensator;
use firmware_core::effect::ALL;
use protocol::{Blob, Signed};
use serde::Serialize;
use trainer::campaign::{Campaign, Run};
use trainer::expression::print;
use trainer::metrics::levels::level_width;
use trainer::model::Model;

/// Shows what a blob, an Intel HEX file, a model or a campaign contains, and whether a device would take it.
#[derive(Args)]
#[command(after_help = "Example:  tempco inspect calibration.bin")]
pub struct Inspect {
    #[command(flatten)]
    data: Data,
}

impl Inspect {
    pub fn run(&self) -> Result<Answer, Failure> {
        let file = self.data.files.first().ok_or_else(|| Failure::new("name a file"))?;
        match file.extension().and_then(|extension| extension.to_str()) {
            Some("bin") => blob(&std::fs::read(file).map_err(|error| Failure::io(file, &error))?),
            Some("hex") => blob(&first_piece(file)?),
            Some("toml") => {
                let model = Model::read(file)?;
                say!("{}", model.to_text())?;
                blob(&model.to_bytes()?)
            }
            _ => {
                campaign(&self.data.read()?)?;
                Ok(Answer::Yes)
            }
        }
    }
}

fn blob(bytes: &[u8]) -> Result<Answer, Failure> {
    let blob = match Blob::from_bytes(bytes) {
        Ok(blob) => blob,
        Err(error) => {
            say!("A device would refuse this: {error}.")?;
            return Ok(Answer::No);
        }
    };
    let hex: String = blob.provenance.iter().map(|byte| format!("{byte:02x}")).collect();
    let serial = if blob.serial.is_empty() { "any sensor" } else { blob.serial.as_str() };
    let ((f_low, f_high), (t_low, t_high)) = (blob.domain.delta_f_uhz, blob.domain.temperature_uc);
    say!("Calibration {hex} for {serial}, layout {}, {} bytes", Blob::LAYOUT, bytes.len())?;
    say!(
        "  calibrated from {:.3} to {:.3} Hz and from {:.2} to {:.2} °C",
        f_low as f64 * 1e-6,
        f_high as f64 * 1e-6,
        f64::from(t_low) * 1e-6,
        f64::from(t_high) * 1e-6
    )?;
    if Signed::split(bytes).is_some_and(|signed| signed.signature.is_some()) {
        say!("  signed")?;
    }
    for term in &blob.terms {
        let name = ALL.iter().find(|about| about.id == term.effect).map_or("unknown effect", |about| about.name);
        let text = print(&term.program, &blob.channels).map(|text| format!(" {text}")).unwrap_or_default();
        say!("  effect {name}{text} {:?}", term.parameters.as_slice())?;
    }
    Ok(match Compensator::load(&blob) {
        Ok(_) => {
            say!("A device would take it.")?;
            Answer::Yes
        }
        Err(error) => {
            say!("A device would refuse this: {error}.")?;
            Answer::No
        }
    })
}

/// What one run is.
#[derive(Clone, Debug, Serialize)]
pub struct RunSummary {
    pub run: String,
    kind: String,
    samples: usize,
    interval_s: Option<f64>,
    hours: f64,
    from_c: f64,
    to_c: f64,
    levels: usize,
}

impl RunSummary {
    pub fn of(campaign: &Campaign, run: &Run) -> Self {
        let references: Vec<f64> = run.rows.iter().map(|row| row.reference_g).collect();
        let temperatures = || run.rows.iter().map(|row| f64::from(row.sample.temperature_uc) * 1e-6);
        let alone = Campaign::new(vec![run.clone()], campaign.channels.clone(), campaign.quantity.clone());
        Self {
            run: run.name.clone(),
            kind: run.kind.clone(),
            samples: run.rows.len(),
            interval_s: run.sample_interval_s(),
            hours: run.duration_s() / 3600.0,
            from_c: temperatures().fold(f64::MAX, f64::min),
            to_c: temperatures().fold(f64::MIN, f64::max),
            levels: alone.levels(level_width(&references)).len(),
        }
    }
}

fn campaign(campaign: &Campaign) -> Result<(), Failure> {
    let mut table = Table::new(["run", "kind", "samples", "every s", "hours", "from °C", "to °C", "levels"]);
    for run in campaign.runs.iter().map(|run| RunSummary::of(campaign, run)) {
        table.row([
            run.run,
            run.kind,
            run.samples.to_string(),
            run.interval_s.map_or_else(|| "–".to_owned(), |interval| format!("{interval:.2}")),
            format!("{:.2}", run.hours),
            format!("{:.1}", run.from_c),
            format!("{:.1}", run.to_c),
            run.levels.to_string(),
        ]);
    }
    say!("{}", table.to_string().trim_end())?;
    if campaign.runs.iter().any(|run| run.has_calendar_time() && run.begins_with_power_on()) {
        say!(
            "time_s is a calendar's clock: time since power-on is counted from the first row of each run \
             (a column power_on_s states another)."
        )?;
    }
    if !campaign.channels.is_empty() {
        say!("Auxiliary channels: {}", campaign.channels.join(", "))?;
    }
    Ok(())
}
