//! Every number that decides something, by the layer that asks for it: with its unit, and its source where it has one.
//!
//! The others were set on the blind benchmark of the twin (`tests/examples/blind_benchmark`, protocols `rich` and
//! `realistic`; `docs/benchmarks.md` has the figures), and `git log -S NAME` tells when. Changing one is a change of the
//! answers: run that benchmark, and `bench/independent`, which was made by another hand, before and after.
//!
//! Where a coefficient is at its bound is asked by the training, too, and stands in `fit/at_bound.rs`.
//! Steps of derivatives, sizes of blocks and the like stand where they are used: they decide nothing.

// Cells.

/// Correlation times of the noise's wander, s: two octaves of flicker, and what takes hours.
pub const WANDER_TAUS_S: [f64; 3] = [60.0, 600.0, 5000.0];
/// References closer than this are the same position, g.
pub const SAME_POSITION_G: f64 = 1e-3;
/// Slower changes of temperature count as rest, °C/s.
pub const REST_C_PER_S: f64 = 0.1 / 60.0;
/// A change that nobody saw is a new node beyond this, °C.
pub const NODE_STEP_C: f64 = 3.0;
/// Within a group temperatures differ by less, °C: the mean of an effect as narrow as half a degree differs from the
/// effect at the mean by curvature · width²/24, which is 0.3 %.
pub const SAME_GROUP_C: f64 = 0.1;
/// And levels by less, g.
pub const SAME_GROUP_G: f64 = 1e-3;
/// As far as a known effect may move a cell, or the sum's map may change, in units of the noise: as good as any.
pub const GENEROUS: f64 = 1e3;

// Forward model.

/// Slope of the sum of two forks of silicon near 40 kHz over temperature, 4.8 Hz/°C, where it was not measured; in
/// accelerations that move the difference as far, as nobody knows what the signal's unit is.
pub const SILICON_G_PER_C: f64 = 4.8 / 420.0;
/// Highest powers of frequency difference and temperature, and of both together, by which a retrained map may differ:
/// those of the polynomial baseline and a margin.
pub const MAP_POWERS: (usize, usize, usize) = (3, 6, 7);
/// How far a retrained map may differ from such a polynomial, as a share of the network's own size.
pub const MAP_TANGENTS: f64 = 0.1;
/// Noise of a sample is never taken to be less, µg.
pub const LEAST_SAMPLE_UG: f64 = 1e-3;
/// Below this share of its half span the frequency difference is too small for a ratio.
pub const LEAST_DELTA_F: f64 = 2e-3;

// Noise.

/// A random walk is counted per √s; this many seconds make it comparable with the others, s.
pub const WALK_S: f64 = 3600.0;
/// A first guess of the walk, as a share of the noise of a sample.
pub const FIRST_WALK: f64 = 0.3;
/// A small random walk adds this share of the sample noise in a second.
pub const SMALL_WALK: f64 = 0.01;
/// Below this share of the sample noise a part of the noise is left out of the filter.
pub const LEAST_STATE: f64 = 0.021;
/// A part of the noise is at least this share of its unit, so that the search can find it again,
pub const LEAST_COMPONENT: f64 = 0.02;
/// and at most this.
pub const MOST_COMPONENT: f64 = 1e5;
/// Factors by which a part is changed, one search after the other.
pub const COMPONENT_STEPS: [f64; 4] = [8.0, 3.0, 1.6, 1.2];
/// A gain in −2 log likelihood that is not worth another round of the search.
pub const LEAST_ROUND: f64 = 0.1;
/// How often map and noise are fitted in turn when nothing is known.
pub const FIRST_NOISE_TURNS: usize = 2;
/// Directions of the nuisance about which the data say less than this, in units of what is expected beforehand.
pub const LEAST_INFORMATION: f64 = 1e-3;

// Fits.

/// A fit of parameters ends when a step gains less than this in −2 log likelihood.
pub const LEAST_STEP_GAIN: f64 = 0.02;
/// Amplitude in the sum of the frequencies of an effect that leaves it free, in units of what it does to the difference.
pub const FREE_IN_SUM: f64 = 1e2;
/// Steps of a fit of all findings together.
pub const JOINT_STEPS: usize = 12;
/// Steps of each fit of a finalist's parameters.
pub const CONTENDER_STEPS: usize = 4;
/// How often a finalist's parameters and noise are fitted in turn.
pub const CONTENDER_TURNS: usize = 2;
/// Steps of the fit of each effect that is asked what it predicts.
pub const PREDICTIVE_STEPS: usize = 8;
/// Steps of the fit of a hypothesis.
pub const HYPOTHESIS_STEPS: usize = 12;

// The grid of candidates.

/// Amplitudes are tried at this share of their bound: formulas are linear in them.
pub const AMPLITUDE_UNIT: f64 = 1e-3;
/// And those of a user's formulas at this, g per unit.
pub const FORMULA_UNIT_G: f64 = 1e-6;
/// Shapes along one logarithmic axis.
pub const SHAPES: usize = 14;
/// Shapes along each of several axes.
pub const SHAPES_OF_SEVERAL: usize = 6;
/// How far 1 g moves a place, as shares of how far it moves one of the forks: less or more where what the fork meets
/// follows the temperature too.
pub const SHIFTS: [f64; 5] = [-1.7, -1.0, 0.0, 1.0, 1.7];
/// Most shifts to either side that are compared at one place.
pub const MOST_SHIFTS: f64 = 60.0;
/// The least level that a place is moved by, g.
pub const LEAST_LEVEL_G: f64 = 0.1;
/// Widths of an effect that sits at a place, °C.
pub const WIDTHS_C: [f64; 3] = [0.7, 2.0, 6.0];
/// Least distance between places, °C,
pub const PLACE_STEP_C: f64 = 1.5;
/// and as a share of the width.
pub const PLACE_STEP: f64 = 0.7;
/// Less of an effect than this, as a share of its amplitude, is left when the map has been retrained: then the campaign
/// can't show it.
pub const LEAST_LEFT: f64 = 0.03;
/// An effect's column below this is no excitation at all, µg RMS at a thousandth of its greatest amplitude.
pub const NOTHING_UG: f64 = 1e-9;

// Selection.

/// ΔBIC that an effect must have to be named. Kass & Raftery 1995 call 10 very strong; there are a hundred shapes to choose
/// from, and no formula is exact.
pub const LEAST_DELTA_BIC: f64 = 25.0;
/// An amplitude that differs from nothing by fewer standard uncertainties is not known to be there.
pub const SIGNIFICANT_SIGMA: f64 = 3.0;
/// An effect of which less than this is left from one sample to the next remembers nothing that the campaign could show.
pub const REMEMBERED: f64 = 0.02;
/// Effects with less are compared with structures that no effect has before they are believed.
pub const WEAK_DELTA_BIC: f64 = 400.0;
/// Most findings.
pub const MOST_FINDINGS: usize = 4;
/// ΔBIC of an effect beyond its physical bounds that tells of something unknown: formulas are not exact.
pub const SURELY_AT_BOUND: f64 = 100.0;
/// Effects whose ΔBIC differs by less are confounded (Kass & Raftery 1995);
pub const CONFOUNDED: f64 = 10.0;
/// and by less than this share, as no formula is exact.
pub const CONFOUNDED_SHARE: f64 = 0.1;
/// So many effects go from the screening into the final, as judged by the noise as estimated and by a small one.
pub const FINALISTS: [usize; 2] = [4, 3];
/// So many effects are asked what they predict.
pub const PREDICTIVE_ASKED: usize = 8;
/// What was left out must be read with this share of the error, or no more than a resemblance was found.
pub const HALVED: f64 = 0.5;
/// Or what is predictable of it must be lowered to this share.
pub const LOWERED: f64 = 0.9;
/// Nor must all of it and what is predictable both grow to this.
pub const WORSE: f64 = 1.1;
/// Heat, stress and moisture spread through a body with more than one time constant; formulas have one. Others may be so many
/// times as long,
pub const SECOND_TAUS: [f64; 4] = [0.125, 0.35, 2.8, 8.0];
/// with this share of the effect.
pub const SECOND_TAU_SHARE: f64 = 0.3;
/// Runs that training never saw must not be read worse than by this.
pub const NO_WORSE: f64 = 1.01;
/// A formula may be wrong by this share of what its effect does: an effect that does the same must be larger.
pub const INEXACT: f64 = 0.1;
/// Share of the gain in likelihood that must hold for runs that were left out.
pub const PREDICTED: f64 = 0.25;
/// What varies by less than this share of its square is part of what came before.
pub const LEAST_OF_ITS_OWN: f64 = 1e-4;
/// With fewer runs, parts of them are left out;
pub const FEW_RUNS: usize = 3;
/// so many parts in all.
pub const PARTS_OF_FEW: usize = 12;

// Lack of fit.

/// Wander within a run beyond so many times the sample noise is no noise of a resonator: something causes it.
pub const STRUCTURE: f64 = 1.0;
/// And beyond this share of what a rig does per g across the input axis, if nobody wrote down how it stood.
pub const UNSEEN_RIG: f64 = 0.5;
/// A dependence less likely by chance than this is one.
pub const LEAST_CHANCE: f64 = 1e-4;
/// ΔBIC that a structure must have; there are a hundred to choose from.
pub const LEAST_LACK_OF_FIT: f64 = 30.0;
/// And what is asked by itself: rectification, of a smooth map;
pub const LEAST_RECTIFIED: f64 = 10.0;
/// what the hottest and coldest moments left, of which a few nodes must tell: their scatter had ΔBIC of 11 and 12 in two
/// rigs of a hundred.
pub const LEAST_EXTREMUM: f64 = 15.0;
/// And its size, in units of the noise of a sample.
pub const MATTERS: f64 = 0.5;
/// So many are judged in full, by the noise as estimated and by a small one.
pub const STRUCTURES_JUDGED: usize = 3;
/// How often amplitudes and noise are fitted in turn.
pub const STRUCTURE_TURNS: usize = 2;
/// Scatters from level to level that are tried beside rectification, in units of the noise of a sample.
pub const LEVEL_SCATTERS: [f64; 9] = [0.0, 0.03, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4];
/// A network that was trained on runs with an offset each follows their mean by this share of its uncertainty.
pub const BENT: f64 = 0.5;
/// Periods of a segment of the periodogram.
pub const SEGMENT_PERIODS: f64 = 64.0;
/// Frequencies per independent one.
pub const OVERSAMPLING: f64 = 3.0;
/// Bins to the shortest period of an octave.
pub const BINS_PER_PERIOD: f64 = 8.0;
/// A segment must hold so many samples,
pub const LEAST_SEGMENT_SAMPLES: f64 = 8.0;
/// and so many of the longest periods of its octave.
pub const LEAST_SEGMENT_PERIODS: f64 = 1.5;
/// So many standard deviations above what chance gives on average are left to chance, before the best of all counts.
pub const CHANCE_SIGMA: f64 = 4.0;
/// A run that covers less than this of the scaled temperature has no course over it.
pub const LEAST_COURSE: f64 = 0.1;
/// Levels are told apart to a thousandth of 1 g,
pub const LEVELS_PER_G: f64 = 1e3;
/// or coarser where there would be more than so many.
pub const MOST_LEVELS: usize = 64;
/// A swing by the calendar must have been followed this long in all, in periods.
pub const LEAST_DAYS: f64 = 1.5;
/// Degree of the smooth functions, as polynomials of the quantity's rank.
pub const DEPENDENCE_DEGREE: usize = 6;

// Plan.

/// A smaller ΔBIC than this, and the measurements don't say how large an effect is.
pub const LEAST_SIGN: f64 = 15.0;
/// More shapes than this are not tried one by one: the slopes at the fitted one must do.
pub const MOST_SHAPES: usize = 40;
/// Recordings that gain less are no use, σ² per hour.
pub const LEAST_SIGMA2_PER_HOUR: f64 = 0.05;
/// Hypotheses so far apart are told apart even with noise that is not quite as estimated: `D < 5` is
/// indistinguishable, and the diagnosis estimates its noise anew for each hypothesis.
pub const DECISIVE_SIGMA: f64 = 10.0;
/// No recording is shorter, hours.
pub const LEAST_HOURS: f64 = 0.1;
