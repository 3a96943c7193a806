//! From a checked calibration and samples to readings.

use crate::effect::Disturbance;
use crate::load_error::LoadError;
use crate::log;
use crate::network::Network;
use crate::observe::{Observation, Scale};
use crate::real::Real;
use crate::slope;
use crate::terms::Terms;
use protocol::{Blob, Domain, Reading, Sample, Scaling, Status, Term};

/// A calibration that was checked and is being run.
///
/// In `f32` this is the one evaluator of a deployed model, on the device and on the host. In `f64`
/// the trainer differentiates the same formulas.
///
/// A program of one's own reads the bytes that `tempco export` wrote, and gives it what was measured. A channel that
/// nobody wrote into the sample counts as not measured: the effect that needs it is left out, and the reading says so.
///
/// ```
/// use firmware_core::Compensator;
/// use protocol::{Blob, Sample, Status};
///
/// # use firmware_core::Network;
/// # use protocol::{Domain, Scaling, Term, Timing, Weights};
/// # let weights = Weights::from_array(&[0.0; 41]);
/// # let parameters = [20e-6, 20.0, 40.0].into_iter().collect();
/// # let humidity = 15;
/// # let exported = Blob {
/// #     serial: heapless::String::new(),
/// #     provenance: [0; 8],
/// #     proof: Network::<f32>::new(&weights).proof().unwrap(),
/// #     scaling: Scaling {
/// #         delta_f_zero_uhz: 76_000_000,
/// #         delta_f_gain_per_hz: 0.01,
/// #         temperature_zero_uc: 25_000_000,
/// #         temperature_gain_per_c: 0.02,
/// #         line_g: [0.0, 0.25, 0.0, 0.0],
/// #         output_g: 0.0,
/// #     },
/// #     weights,
/// #     domain: Domain { delta_f_uhz: (0, 152_000_000), temperature_uc: (-40_000_000, 85_000_000) },
/// #     timing: Timing { max_gap_us: u32::MAX },
/// #     channels: [heapless::String::try_from("humidity_pct").unwrap()].into_iter().collect(),
/// #     terms: [Term { effect: humidity, channel: 0, parameters, program: heapless::Vec::new() }].into_iter().collect(),
/// # };
/// # let mut buffer = [0; protocol::limits::MAX_BLOB];
/// # let bytes = exported.to_bytes(&mut buffer).unwrap();
/// let blob = Blob::from_bytes(bytes)?; // made with a humidity effect of 20 µg for each per cent away from 40 %
/// let mut compensator = Compensator::load(&blob)?;
///
/// let (f1_uhz, f2_uhz, temperature_uc) = (41_238_000_000, 41_162_000_000, 25_000_000);
/// let mut sample = Sample::from_pair(1_000_000, f1_uhz, f2_uhz, temperature_uc);
/// let reading = compensator.compensate(&sample);
/// assert!(reading.acceleration_g == 0.0 && reading.status.contains(Status::CHANNEL_MISSING));
///
/// sample.time_us += 1_000_000;
/// sample.channels[0] = 50_000_000; // 50 %, in the order of `blob.channels`
/// let reading = compensator.compensate(&sample);
/// assert!((reading.acceleration_g + 200e-6).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Compensator<R: Real = f32> {
    scaling: Scaling,
    scale: Scale<R>,
    network: Network<R>,
    domain: Domain,
    terms: Terms<R>,
}

/// What the compensator made of one sample, before it is rounded into a [`Reading`].
#[derive(Clone, Copy, Debug)]
pub struct Output<R> {
    /// Inputs of the network after the effects' share was taken out.
    pub inputs: [R; 2],
    /// What the static model reads at those inputs, g.
    pub level_g: R,
    /// What the effects add to the level, g; the acceleration is the level without it.
    pub bias_g: R,
    /// What stands between the reading and full trust.
    pub status: Status,
}

impl Compensator<f32> {
    /// Checks a calibration and makes it ready to run.
    ///
    /// # Errors
    /// A [`LoadError`] that says why this firmware can't run it.
    pub fn load(blob: &Blob) -> Result<Self, LoadError> {
        Self::proven(blob).inspect_err(log::unusable)
    }

    fn proven(blob: &Blob) -> Result<Self, LoadError> {
        let compensator = Self::assemble(blob)?;
        let computed = compensator.network.proof().ok_or(LoadError::Number)?;
        compensator.check_slope()?;
        if computed != blob.proof {
            return Err(LoadError::Proof { computed, stored: blob.proof });
        }
        Ok(compensator)
    }

    /// The reading of the next sample. Never panics, never computes with a NaN.
    pub fn compensate(&mut self, sample: &Sample) -> Reading {
        if sample.faults.intersects(Status::FATAL) {
            // Memories must not see the impossible values; the gap tells them later.
            return Reading::none(sample.time_us, sample.faults);
        }
        let output = self.evaluate(sample);
        let acceleration_g = output.level_g - output.bias_g;
        if acceleration_g.is_finite() {
            Reading { time_us: sample.time_us, acceleration_g, status: output.status }
        } else {
            Reading::none(sample.time_us, output.status | Status::UNCALIBRATED)
        }
    }
}

impl<R: Real> Compensator<R> {
    /// The compensator of a blob in any arithmetic, checked except for the proof.
    ///
    /// # Errors
    /// A [`LoadError`] that says what is wrong with the blob.
    pub fn assemble(blob: &Blob) -> Result<Self, LoadError> {
        check_numbers(blob)?;
        let domain = blob.domain;
        if domain.delta_f_uhz.0 >= domain.delta_f_uhz.1 || domain.temperature_uc.0 >= domain.temperature_uc.1 {
            return Err(LoadError::Domain);
        }
        let mut terms = Terms::new(blob.timing.max_gap_us);
        for Term { effect, channel, parameters, program } in &blob.terms {
            let parameters = parameters.iter().copied().map(R::from_f32);
            terms.push(*effect, usize::from(*channel), blob.channels.len(), parameters, program)?;
        }
        Ok(Self {
            scaling: blob.scaling,
            scale: Scale::new(&blob.scaling),
            network: Network::new(&blob.weights),
            domain,
            terms,
        })
    }

    /// Forgets the past, as at power-on after a long soak.
    pub fn restart(&mut self) {
        self.terms.restart();
    }

    /// Observes the sample, advances the memories, evaluates network and effects.
    pub fn evaluate(&mut self, sample: &Sample) -> Output<R> {
        let now = Observation::new(sample, &self.scaling);
        let (inputs, apparent_g) = self.level(&now, &Disturbance::NONE);
        let status = sample.faults | self.outside(sample) | self.terms.advance(sample, apparent_g);
        if self.terms.is_empty() {
            return Output { inputs, level_g: apparent_g, bias_g: R::ZERO, status };
        }
        let (inputs, level_g) = self.level(&now, &self.terms.disturbance(&now, apparent_g));
        // What an effect adds depends on the acceleration, and the level is not that yet. A second round
        // leaves bias · slope² of it instead of bias · slope.
        let nearly_g = self.terms.bias_g(&now, level_g);
        Output { inputs, level_g, bias_g: self.terms.bias_g(&now, level_g - nearly_g), status }
    }

    /// Network inputs and static reading once the disturbance of the resonators is taken out.
    fn level(&self, now: &Observation<R>, disturbance: &Disturbance<R>) -> ([R; 2], R) {
        let [x, t] = self.scale.inputs(
            now.delta_f_offset_hz - disturbance.delta_f_hz,
            now.temperature_offset_c + disturbance.temperature_c,
        );
        ([x, t], self.scale.reading_g(x, t, self.network.evaluate(x, t)))
    }

    fn outside(&self, sample: &Sample) -> Status {
        let within = |value: i64, (low, high): (i64, i64)| (low..=high).contains(&value);
        let (low, high) = self.domain.temperature_uc;
        let mut status = Status::empty();
        status.set(
            Status::TEMPERATURE_OUTSIDE,
            !within(i64::from(sample.temperature_uc), (i64::from(low), i64::from(high))),
        );
        status.set(Status::FREQUENCY_OUTSIDE, !within(sample.delta_f_uhz, self.domain.delta_f_uhz));
        status
    }
}

impl Compensator<f32> {
    fn check_slope(&self) -> Result<(), LoadError> {
        let Domain { delta_f_uhz: (f_low, f_high), temperature_uc: (t_low, t_high) } = self.domain;
        let corner = |delta_f_uhz, temperature_uc| {
            let now = Observation::<f32>::new(&Sample::from_difference(0, delta_f_uhz, temperature_uc), &self.scaling);
            self.scale.inputs(now.delta_f_offset_hz, now.temperature_offset_c)
        };
        let ([x_low, t_low_in], [x_high, t_high_in]) = (corner(f_low, t_low), corner(f_high, t_high));
        let Some([i, j]) = slope::fault(&self.network, &self.scale, [x_low, x_high], [t_low_in, t_high_in]) else {
            return Ok(());
        };
        let between =
            |low: i64, high: i64, part: f32| low.saturating_add((high.saturating_sub(low) as f32 * part) as i64);
        let temperature_uc = between(i64::from(t_low), i64::from(t_high), j);
        Err(LoadError::Slope {
            delta_f_uhz: between(f_low, f_high, i),
            temperature_uc: i32::try_from(temperature_uc).unwrap_or(t_high),
        })
    }
}

fn check_numbers(blob: &Blob) -> Result<(), LoadError> {
    let scaling = &blob.scaling;
    let gains = [scaling.delta_f_gain_per_hz, scaling.temperature_gain_per_c];
    let mut numbers = blob
        .weights
        .to_array()
        .into_iter()
        .chain(gains)
        .chain(scaling.line_g)
        .chain([scaling.output_g])
        .chain(blob.terms.iter().flat_map(|term| term.parameters.iter().copied()));
    if numbers.all(f32::is_finite) && gains.iter().all(|gain| *gain > 0.0) { Ok(()) } else { Err(LoadError::Number) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use heapless::{String, Vec};
    use protocol::{Timing, Weights};

    const HZ: i64 = 1_000_000;

    /// 1 g per Hz and 0.5 g per °C, a network that is zero, and these effects with their first coefficients.
    fn blob(terms: &[(u16, f32)]) -> Blob {
        let term = |&(effect, value): &(u16, f32)| Term {
            effect,
            channel: 0,
            parameters: Vec::from_slice(&[value]).expect("one"),
            program: Vec::new(),
        };
        Blob {
            serial: String::new(),
            provenance: [0; 8],
            proof: Network::new(&Weights::ZERO).proof().expect("zeros"),
            scaling: Scaling {
                delta_f_zero_uhz: 0,
                delta_f_gain_per_hz: 1.0,
                temperature_zero_uc: 0,
                temperature_gain_per_c: 1.0,
                line_g: [0.0, 1.0, 0.5, 0.0],
                output_g: 1.0,
            },
            weights: Weights::ZERO,
            domain: Domain { delta_f_uhz: (-4 * HZ, 4 * HZ), temperature_uc: (-20_000_000, 20_000_000) },
            timing: Timing { max_gap_us: u32::MAX },
            channels: Vec::new(),
            terms: terms.iter().map(term).collect(),
        }
    }

    fn ready(terms: &[(u16, f32)]) -> Compensator<f32> {
        Compensator::load(&blob(terms)).expect("a sound one")
    }

    fn sample(second: u64, delta_f_uhz: i64, temperature_uc: i32) -> Sample {
        Sample::from_difference(second * 1_000_000, delta_f_uhz, temperature_uc)
    }

    fn read(compensator: &mut Compensator<f32>, sample: &Sample) -> (f32, Status) {
        let Reading { acceleration_g, status, .. } = compensator.compensate(sample);
        (acceleration_g, status)
    }

    #[test]
    fn the_line_is_read_and_every_flag_passed_on() {
        let mut compensator = ready(&[]);
        assert_eq!(read(&mut compensator, &sample(0, 2 * HZ, 1_000_000)), (2.5, Status::empty()));
        let stale = Sample { faults: Status::STALE, ..sample(1, 5 * HZ, 0) };
        assert_eq!(read(&mut compensator, &stale), (5.0, Status::STALE | Status::FREQUENCY_OUTSIDE));
        // A flag that is raised twice is raised.
        let stale = Sample { faults: Status::STALE | Status::FREQUENCY_OUTSIDE, ..stale };
        let reversed = read(&mut compensator, &stale).1;
        assert_eq!(reversed, Status::STALE | Status::FREQUENCY_OUTSIDE | Status::TIME_REVERSED);
    }

    #[test]
    fn a_result_beyond_every_number_is_none_and_says_why() {
        let mut blob = blob(&[]);
        blob.scaling.line_g[1] = f32::MAX;
        let mut compensator = Compensator::load(&blob).expect("finite numbers");
        let stale = Sample { faults: Status::STALE, ..sample(0, 4 * HZ, 0) };
        let none = Reading::none(0, Status::STALE | Status::UNCALIBRATED);
        assert!(compensator.compensate(&stale).same_bits(&none));
    }

    #[test]
    fn the_ends_of_the_domain_belong_to_it() {
        let (frequency, temperature) = (Status::FREQUENCY_OUTSIDE, Status::TEMPERATURE_OUTSIDE);
        for (delta_f_uhz, temperature_uc, status) in [
            (4 * HZ, 20_000_000, Status::empty()),
            (-4 * HZ, -20_000_000, Status::empty()),
            (4 * HZ + 1, 0, frequency),
            (-4 * HZ - 1, 0, frequency),
            (0, 20_000_001, temperature),
            (0, -20_000_001, temperature),
        ] {
            let reading = ready(&[]).compensate(&sample(0, delta_f_uhz, temperature_uc));
            assert_eq!(reading.status, status, "{delta_f_uhz} µHz, {temperature_uc} µ°C");
        }
    }

    #[test]
    fn a_bias_is_subtracted_as_it_is_at_the_acceleration_that_it_leaves() {
        // 1/8 g per g² of 2 g: first 1/2 g; of the remaining 1.5 g: 9/32 g.
        assert_eq!(read(&mut ready(&[(5, 0.125)]), &sample(0, 2 * HZ, 0)).0, 2.0 - 0.281_25);
    }

    #[test]
    fn a_disturbance_is_taken_out_of_what_was_measured() {
        // A tenth of a day with a clock that gains 1e6 ppm a day: the difference was seen by a tenth too small.
        let aged = Sample { age_s: Some(8640), ..sample(0, 2 * HZ, 0) };
        let (reading_g, _) = read(&mut ready(&[(20, 1e6)]), &aged);
        assert!((reading_g - 2.2).abs() < 1e-6, "{reading_g}");
        // The resonators have not yet followed the thermometer.
        let mut lagging = ready(&[(1, 3600.0)]);
        lagging.compensate(&sample(0, 0, 0));
        let (reading_g, status) = read(&mut lagging, &sample(1, 0, 10_000_000));
        assert!(reading_g.abs() < 0.001, "{reading_g}");
        assert_eq!(status, Status::SETTLING);
        lagging.restart();
        assert_eq!(read(&mut lagging, &sample(2, 0, 10_000_000)).0, 5.0, "as at power-on after a long soak");
    }

    #[test]
    fn a_memory_has_settled_after_five_time_constants_and_says_so() {
        let mut lagging = ready(&[(1, 4.0)]);
        let settling: usize =
            (0..60).filter(|&second| !lagging.compensate(&sample(second, 0, 0)).status.is_empty()).count();
        assert_eq!(settling, 20, "a second each, from the first on");
    }

    #[test]
    fn impossible_calibrations_are_refused_by_what_is_wrong() {
        let refused = |spoil: fn(&mut Blob)| {
            let mut blob = blob(&[]);
            spoil(&mut blob);
            Compensator::load(&blob).err()
        };
        assert_eq!(refused(|_| ()), None);
        for spoil in [
            (|b| b.domain.delta_f_uhz = (1, 1)) as fn(&mut Blob),
            |b| b.domain.delta_f_uhz = (1, 0),
            |b| b.domain.temperature_uc = (1, 1),
            |b| b.domain.temperature_uc = (1, 0),
        ] {
            assert_eq!(refused(spoil), Some(LoadError::Domain));
        }
        for spoil in [
            (|b| b.scaling.delta_f_gain_per_hz = 0.0) as fn(&mut Blob),
            |b| b.scaling.temperature_gain_per_c = 0.0,
            |b| b.scaling.temperature_gain_per_c = -1.0,
            |b| b.scaling.output_g = f32::NAN,
        ] {
            assert_eq!(refused(spoil), Some(LoadError::Number));
        }
        assert!(matches!(refused(|b| b.proof ^= 1), Some(LoadError::Proof { .. })));
        // The slope falls to zero towards the hot end: all along it, and the first place is told.
        let Some(LoadError::Slope { delta_f_uhz, temperature_uc }) = refused(|b| b.scaling.line_g[3] = -0.05) else {
            panic!("a calibration that can't measure");
        };
        assert!((-4 * HZ..-3 * HZ).contains(&delta_f_uhz), "{delta_f_uhz} µHz");
        assert!((19_000_000..20_000_000).contains(&temperature_uc), "{temperature_uc} µ°C");
    }
}
