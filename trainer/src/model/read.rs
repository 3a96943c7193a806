//! A model file, read strictly: what a person mistyped is told with its line, and never taken for something else.

use super::bounds::bounds_of;
use super::{Model, ModelEffect, ModelError};
use firmware_core::effect::{self, Parameter, Role};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

impl Model {
    /// Reads a model file. What it gives can be put on a device.
    ///
    /// # Errors
    /// [`ModelError`] with the file and, where the text is wrong, the line.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| ModelError::Io { path: path.to_path_buf(), source })?;
        Self::parse(path, &text)
    }

    /// Reads the text of a model file; `path` names it in errors.
    ///
    /// # Errors
    /// As [`Model::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, ModelError> {
        let path = || path.to_path_buf();
        let syntax = |source| ModelError::Syntax { path: path(), source: Box::new(source) };
        // Another version's file may have keys that this one doesn't know: the version is the better reason.
        let stamp: Stamp = toml::from_str(text).map_err(syntax)?;
        if let Some(format) = stamp.format.filter(|format| *format.as_ref() != i64::from(Self::FORMAT)) {
            let (line, found) = (line_at(text, format.span().start), format.into_inner());
            return Err(ModelError::Format { path: path(), line, found, supported: Self::FORMAT });
        }
        let model: Self = toml::from_str(text).map_err(syntax)?;
        if let Some((index, parameter, value, bounds)) = model.beyond_bounds() {
            let effect = model.effects[index].name.clone();
            let (line, parameter) = (line_of(text, index, parameter.name), parameter.name);
            return Err(ModelError::Bound { path: path(), line, effect, parameter, value, bounds });
        }
        model.to_blob().map_err(|source| ModelError::Unusable { path: path(), source: Box::new(source) })?;
        Ok(model)
    }

    /// The first coefficient that makes no physical sense: its effect's index, what it is, its value, its bounds.
    fn beyond_bounds(&self) -> Option<(usize, &'static Parameter, f64, (f64, f64))> {
        let of = |(index, effect): (usize, &ModelEffect)| {
            let about = effect::about(&effect.name)?;
            // Where a channel counts from is measured, whatever the channel is.
            let judged = about.parameters.iter().filter(|parameter| parameter.role != Role::Origin);
            let mut values = judged.filter_map(|parameter| {
                Some((parameter, *effect.parameters.get(parameter.name)?, bounds_of(self, about, parameter)))
            });
            let beyond = |(_, value, (low, high)): &(_, f64, (f64, f64))| !(low..=high).contains(&value);
            let (parameter, value, bounds) = values.find(beyond)?;
            Some((index, parameter, value, bounds))
        };
        self.effects.iter().enumerate().find_map(of)
    }
}

/// All that every version's file has.
#[derive(Deserialize)]
struct Stamp {
    format: Option<Spanned<i64>>,
}

/// Where the coefficients stand.
#[derive(Deserialize)]
struct Places {
    effect: Vec<EffectPlaces>,
}

#[derive(Deserialize)]
struct EffectPlaces {
    parameters: BTreeMap<String, Spanned<f64>>,
}

/// The line of one coefficient.
fn line_of(text: &str, effect: usize, parameter: &str) -> usize {
    let places: Option<Places> = toml::from_str(text).ok();
    let place = places.as_ref().and_then(|places| places.effect.get(effect)?.parameters.get(parameter));
    line_at(text, place.map_or(0, |place| place.span().start))
}

fn line_at(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::super::example::model;
    use super::*;

    fn refused(text: &str) -> String {
        let error = Model::parse(Path::new("m.toml"), text).expect_err("refused");
        assert!(error.help().is_some(), "{error}");
        error.to_string()
    }

    #[test]
    fn what_is_written_is_read_again() {
        let model = model();
        let text = model.to_text();
        assert_eq!(Model::parse(Path::new("m.toml"), &text).expect("a model"), model, "{text}");
        assert!(text.contains("constant_reference = 0.5"), "{text}");
    }

    #[test]
    fn another_format_is_refused_by_its_line_whatever_else_the_file_has() {
        let text = model().to_text().replace("format = 1", "# newer\nformat = 2\nsurprise = true");
        assert_eq!(refused(&text), "m.toml:2: model format 2, this version reads 1");
        assert!(refused(&model().to_text().replace("format = 1", "format = 0")).contains("model format 0"));
        assert!(refused(&model().to_text().replace("format = 1", "")).contains("missing field `format`"));
    }

    #[test]
    fn surplus_and_missing_entries_are_refused_with_their_line() {
        let text = model().to_text();
        for (key, entries) in
            [("bias", 10), ("output", 10), ("input", 10), ("line_g", 4), ("delta_f_uhz", 2), ("temperature_uc", 2)]
        {
            let start = text.find(&format!("\n{key} = [")).expect(key) + 1;
            let end = start + text[start..].find('\n').expect("a line");
            let line = text[..start].matches('\n').count() + 1;
            let last = text[start..end].rfind(']').expect("an end") + start;
            let more = if key == "input" { ", [0.0, 0.0]" } else { ", 7" }
                .replace('7', if key.ends_with("_g") { "7.0" } else { "7" });
            let more = if key == "bias" || key == "output" { ", 7.0".to_owned() } else { more };
            let surplus = format!("{}{more}{}", &text[..last], &text[last..]);
            let told = refused(&surplus);
            assert!(told.contains(&format!("{} entries, expected {entries}", entries + 1)), "{key}: {told}");
            assert!(told.contains(&format!("line {line}")), "{key}: {told}");
        }
        assert!(refused(&text.replace("[[0.", "[[0.5, 0.")).contains("3 entries, expected 2"));
    }

    #[test]
    fn unknown_keys_are_refused_wherever_they_stand() {
        let text = model().to_text();
        for section in ["[provenance]", "[units]", "[scaling]", "[domain]", "[network]", "[[effect]]"] {
            let told = refused(&text.replacen(section, &format!("{section}\nsurprise = 1"), 1));
            assert!(told.contains("unknown field `surprise`"), "{section}: {told}");
        }
    }

    #[test]
    fn a_coefficient_beyond_its_bounds_is_refused_with_its_line() {
        let text = model().to_text();
        let line = text.lines().position(|line| line.starts_with("tau_s = ")).expect("a time constant") + 1;
        for value in ["-5.0", "0.0", "1e9", "nan"] {
            let wrong = text.replace("tau_s = 40.0", &format!("tau_s = {value}"));
            let told = refused(&wrong);
            assert!(told.starts_with(&format!("m.toml:{line}: effect `thermal-lag`: tau_s = ")), "{told}");
        }
    }

    #[test]
    fn bounds_follow_the_unit_of_the_reference() {
        let mut model = model();
        model.provenance.scale_factor_hz_per_g = None;
        let k2 = |value: f64| ModelEffect {
            name: "second-order".to_owned(),
            channel: None,
            expression: None,
            parameters: [("k2_g_per_g2".to_owned(), value)].into(),
        };
        model.effects = vec![k2(0.009)];
        let read = |model: &Model| Model::parse(Path::new("m.toml"), &model.to_text());
        assert!(read(&model).is_ok());
        model.effects = vec![k2(0.011)];
        assert!(refused(&model.to_text()).contains("k2_g_per_g2 = 0.011 is outside -0.01 to 0.01"));
        // The same instrument in mg: 1 mg per mg² is 1000 g per g².
        model.units.reference = "mg".to_owned();
        model.scaling.line_g = model.scaling.line_g.map(|value| value * 1e3);
        model.scaling.output_g *= 1e3;
        for (value, good) in [(0.009e-3, true), (0.011e-3, false)] {
            model.effects = vec![k2(value)];
            assert_eq!(read(&model).is_ok(), good, "{value}");
        }
    }

    #[test]
    fn a_model_without_a_slope_is_refused() {
        let mut model = model();
        (model.scaling.line_g, model.scaling.output_g) = ([0.3, 0.0, 0.1, 0.0], 0.0);
        let told = refused(&model.to_text());
        assert!(told.contains("slope"), "{told}");
    }

    #[test]
    fn a_model_with_another_slope_than_was_stated_is_refused() {
        // 0.0125 g per Hz · 1 is 80 Hz/g, and 420 was stated.
        let told = refused(&model().to_text().replace("scale_factor_hz_per_g = 80.0", "scale_factor_hz_per_g = 420.0"));
        assert!(told.contains("the scale factor that was stated"), "{told}");
        let turned = model().to_text().replace("scale_factor_hz_per_g = 80.0", "scale_factor_hz_per_g = -80.0");
        assert!(refused(&turned).contains("the scale factor that was stated"));
    }
}
