//! Residuals against everything that they might depend on.

use super::chart::{Axis, AxisName, Chart, Layer, Tone};
use super::samples::{RunName, Sample};
use super::thin::{COLUMNS, thin};

/// Slower than this is still, °C per minute: two minutes of a thermometer's noise.
const STILL_C_PER_MIN: f64 = 0.02;
/// Bins of a line of means.
const BINS: usize = 40;
/// Fewer samples than this have no mean worth drawing.
const BIN_LEAST: usize = 10;
/// Earlier than this after power-on is drawn here, min: a logarithm has no zero.
const EARLIEST_MIN: f64 = 0.1;

/// One class of samples: a name, a tone, and who belongs to it.
struct Class<'a> {
    name: &'a str,
    tone: Tone,
    holds: &'a dyn Fn(&Sample) -> bool,
}

/// What residuals are drawn against.
struct Against {
    id: &'static str,
    title: &'static str,
    look_for: &'static str,
    axis: fn(Vec<f64>) -> Axis,
    value: fn(&Sample) -> Option<f64>,
}

const AGAINST: [Against; 5] = [
    Against {
        id: "residual-rate",
        title: "Residual against the rate of temperature",
        look_for: "A straight line is a bias from temperature gradients, or a lag of the thermometer.",
        axis: |values| Axis::linear("temperature rate", "°C/min", values),
        value: |sample| sample.rate_c_per_min,
    },
    Against {
        id: "residual-power-on",
        title: "Residual against time since power-on",
        look_for: "A curve that levels off is warming up or electronics that settle.",
        axis: |values| Axis::log("time since power-on", "min", values),
        value: |sample| Some(sample.power_on_min.max(EARLIEST_MIN)),
    },
    Against {
        id: "residual-age",
        title: "Residual against calendar age",
        look_for: "A slope is ageing of the bias; a step is a shock or a new mounting.",
        axis: |values| Axis::linear("calendar age", "days", values),
        value: |sample| sample.age_days,
    },
    Against {
        id: "residual-level",
        title: "Residual against applied acceleration",
        look_for: "A slope is an error of the scale factor, a curve one of second or third order.",
        axis: |values| Axis::linear("reference", "g", values),
        value: |sample| Some(sample.level_g),
    },
    Against {
        id: "residual-delta-f",
        title: "Residual against the frequency difference",
        look_for: "A bump in one place is a crossing of modes; a dead band about Δf = 0 is lock-in.",
        axis: |values| Axis::linear("frequency difference Δf", "Hz", values),
        value: |sample| Some(sample.delta_f_hz),
    },
];

/// The charts. Where runs were held out, they stand in front and the training in grey behind them.
#[must_use]
pub fn residual_charts(runs: &[RunName], samples: &[Sample]) -> Vec<Chart> {
    let held_out = |sample: &Sample| runs.get(usize::from(sample.run)).is_some_and(|run| run.held_out);
    let training = |sample: &Sample| !held_out(sample);
    let classes = [
        Class { name: "training", tone: Tone::Quiet, holds: &training },
        Class { name: "held out", tone: Tone::First, holds: &held_out },
    ];
    let mut charts = vec![against_temperature(runs, samples)];
    charts.extend(AGAINST.iter().filter_map(|against| chart(against, samples, &classes)));
    charts
}

/// Coloured by the sign of the rate: a loop is a memory.
fn against_temperature(runs: &[RunName], samples: &[Sample]) -> Chart {
    let any_held_out = runs.iter().any(|run| run.held_out);
    let shown = |sample: &Sample| !any_held_out || runs.get(usize::from(sample.run)).is_some_and(|run| run.held_out);
    let rate = |sample: &Sample| sample.rate_c_per_min.unwrap_or_default();
    let still = |sample: &Sample| shown(sample) && rate(sample).abs() <= STILL_C_PER_MIN;
    let falling = |sample: &Sample| shown(sample) && rate(sample) < -STILL_C_PER_MIN;
    let rising = |sample: &Sample| shown(sample) && rate(sample) > STILL_C_PER_MIN;
    let classes = [
        Class { name: "temperature still", tone: Tone::Quiet, holds: &still },
        Class { name: "falling", tone: Tone::First, holds: &falling },
        Class { name: "rising", tone: Tone::Second, holds: &rising },
    ];
    let which = if any_held_out { "Held-out runs only. " } else { "" };
    let against = Against {
        id: "residual-temperature",
        title: "Residual against temperature",
        look_for: "Rising and falling apart is a memory: lag, hysteresis, stress that relaxes.",
        axis: |values| Axis::linear("temperature", "°C", values),
        value: |sample| Some(sample.temperature_c),
    };
    let mut chart = chart(&against, samples, &classes).unwrap_or_else(|| nothing(&against));
    chart.caption = format!("{which}{} Still means slower than {STILL_C_PER_MIN} °C/min.", chart.caption);
    chart
}

fn nothing(against: &Against) -> Chart {
    Chart {
        id: against.id.to_owned(),
        title: against.title.to_owned(),
        caption: "No samples.".to_owned(),
        x: (against.axis)(Vec::new()),
        y: residual_axis([]),
        layers: Vec::new(),
    }
}

/// The residual's own axis.
pub fn residual_axis(values: impl IntoIterator<Item = f64>) -> Axis {
    Axis::linear("residual", "µg", values)
}

/// `None` where the quantity is unknown or never varies.
fn chart(against: &Against, samples: &[Sample], classes: &[Class]) -> Option<Chart> {
    let known = |sample: &Sample| (against.value)(sample).filter(|_| classes.iter().any(|class| (class.holds)(sample)));
    let places: Vec<f64> = samples.iter().filter_map(known).collect();
    let first = places.first()?;
    if places.iter().all(|place| place == first) {
        return None;
    }
    let x = (against.axis)(places);
    let drawn = samples.iter().filter(|sample| known(sample).is_some());
    let y = residual_axis(drawn.map(|sample| sample.residual_ug));
    let mut layers = Vec::new();
    let mut lines = Vec::new();
    let mut thinned = Thinned::default();
    for class in classes {
        let members: Vec<(f64, &Sample)> = samples
            .iter()
            .filter(|sample| (class.holds)(sample))
            .filter_map(|sample| Some(((against.value)(sample)?, sample)))
            .collect();
        if members.is_empty() {
            continue;
        }
        layers.push(dots(class, &members, &x, &y, &mut thinned));
        lines.extend(means(class, &members, &x, &y));
    }
    layers.extend(lines);
    if x.range[0] < 0.0 && x.range[1] > 0.0 && against.id == "residual-delta-f" {
        layers.push(Layer::Rule { name: "Δf = 0".to_owned(), axis: AxisName::X, at: 0.0 });
    }
    let caption = format!("{}{}", against.look_for, thinned.sentence());
    Some(Chart { id: against.id.to_owned(), title: against.title.to_owned(), caption, x, y, layers })
}

/// How many of the samples are drawn.
#[derive(Default)]
struct Thinned {
    drawn: usize,
    of: usize,
}

impl Thinned {
    fn sentence(&self) -> String {
        if self.drawn == self.of {
            return String::new();
        }
        format!(
            " {} of {} samples are drawn, among them the lowest and the highest of each of {COLUMNS} columns; the lines \
             are means of all.",
            self.drawn, self.of
        )
    }
}

fn dots(class: &Class, members: &[(f64, &Sample)], x: &Axis, y: &Axis, thinned: &mut Thinned) -> Layer {
    let parts: Vec<[f64; 2]> =
        members.iter().map(|(place, sample)| [x.part(*place), y.part(sample.residual_ug)]).collect();
    let kept = thin(&parts);
    thinned.drawn += kept.len();
    thinned.of += members.len();
    Layer::Dots {
        name: class.name.to_owned(),
        tone: class.tone,
        x: x.all_rounded(kept.iter().map(|&index| members[index].0)),
        y: y.all_rounded(kept.iter().map(|&index| members[index].1.residual_ug)),
        run: kept.iter().map(|&index| members[index].1.run).collect(),
    }
}

/// The mean of each bin along x that holds enough samples.
fn means(class: &Class, members: &[(f64, &Sample)], x: &Axis, y: &Axis) -> Option<Layer> {
    let mut bins = vec![(0_usize, 0.0, 0.0); BINS];
    for (place, sample) in members {
        let slot = ((x.part(*place) * BINS as f64) as usize).min(BINS - 1);
        let (count, places, residuals) = &mut bins[slot];
        *count += 1;
        *places += place;
        *residuals += sample.residual_ug;
    }
    let means: Vec<[f64; 2]> = bins
        .into_iter()
        .filter(|(count, ..)| *count >= BIN_LEAST)
        .map(|(count, places, residuals)| [places / count as f64, residuals / count as f64])
        .collect();
    (means.len() > 1).then(|| Layer::Line {
        name: format!("mean, {}", class.name),
        tone: class.tone,
        x: x.all_rounded(means.iter().map(|mean| mean[0])),
        y: y.all_rounded(means.iter().map(|mean| mean[1])),
        dashed: false,
    })
}
