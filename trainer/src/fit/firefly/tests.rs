//! How the searches behave, whatever they find.

use super::*;
use crate::fit::random::stream;
use crate::fit::test_functions::{RASTRIGIN, SCHAFFER};

fn watch(_: usize, _: &Generation) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn square(half_width: f64) -> Domain {
    Domain::cube(2, &(-half_width..=half_width)).unwrap()
}

fn run_standard(settings: &StandardSettings, seed: u64) -> Swarm {
    standard(RASTRIGIN.cost, &square(2.0), settings, &mut stream(seed, 0), watch).unwrap()
}

fn run_improved(settings: &ImprovedSettings, seed: u64) -> Swarm {
    improved(RASTRIGIN.cost, &square(2.0), settings, &mut stream(seed, 0), watch).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    for settings in [StandardSettings::paper(), StandardSettings::recommended()] {
        assert_eq!(run_standard(&settings, 1), run_standard(&settings, 1));
        assert_ne!(run_standard(&settings, 1).best, run_standard(&settings, 2).best);
    }
    for settings in [ImprovedSettings::paper(), ImprovedSettings::recommended()] {
        assert_eq!(run_improved(&settings, 1), run_improved(&settings, 1));
        assert_ne!(run_improved(&settings, 1).best, run_improved(&settings, 2).best);
    }
}

#[test]
fn the_step_of_eq_6_collapses_only_when_read_as_a_recursion() {
    let table = [
        (StepDecay::Constant, 10, 1.0),
        (StepDecay::Recursive, 10, 0.356),
        (StepDecay::Recursive, 20, 5.46e-3),
        (StepDecay::Recursive, 25, 1.05e-4),
        (StepDecay::Recursive, 40, 1.88e-17),
        (StepDecay::NonRecursive, 10, 0.779),
        (StepDecay::NonRecursive, 20, 0.513),
        (StepDecay::NonRecursive, 25, 0.368),
        (StepDecay::NonRecursive, 40, 0.0183),
    ];
    for (decay, n, expected) in table {
        let factor = decay.factor(1.0, n, 50);
        assert!((factor / expected - 1.0).abs() < 0.01, "{decay:?} at {n}: {factor}, not {expected}");
    }
}

#[test]
fn the_step_of_eq_6_is_zero_where_the_equation_divides_by_zero() {
    for decay in [StepDecay::Recursive, StepDecay::NonRecursive] {
        assert_eq!(decay.factor(1.3, 60, 50), 0.0);
    }
    assert_eq!(StepDecay::NonRecursive.factor(1.3, 50, 50), 0.0);
    assert_eq!(StepDecay::Recursive.factor(2.0, 1, 50), 2.0, "k enters once a generation");
    assert_eq!(StepDecay::NonRecursive.factor(2.0, 0, 50), 2.0);
}

/// Mean r² between random weights is 41·2²/6 as printed and 1/6 in units of the domain.
#[test]
fn between_a_networks_weights_only_scaled_distances_attract() {
    const PAIRS: u64 = 400;
    let domain = Domain::cube(41, &(-1.0..=1.0)).unwrap();
    let mean_log_beta = |distance| {
        let sum: f64 = (0..PAIRS)
            .map(|pair| {
                let rng = &mut stream(9, pair);
                let (from, to) = (domain.scatter(rng), domain.scatter(rng));
                Attraction::unit(distance).strength(&domain, &from, &to).ln()
            })
            .sum();
        sum / PAIRS as f64
    };
    let table = [
        (DistanceScale::Raw, 41.0 * 4.0 / 6.0),
        (DistanceScale::Width, 41.0 / 6.0),
        (DistanceScale::Domain, 1.0 / 6.0),
    ];
    for (distance, r2) in table {
        let ratio = -mean_log_beta(distance) / r2;
        assert!((ratio - 1.0).abs() < 0.03, "{distance:?}: {ratio}");
    }
}

#[test]
fn attraction_knows_each_dimensions_width() {
    let domain = Domain::new(&[-1.0..=1.0, 0.0..=1000.0]).unwrap();
    let attraction = Attraction { beta0: 0.5, gamma: 2.0, distance: DistanceScale::Domain };
    let beta = attraction.strength(&domain, &[0.0, 100.0], &[1.0, 600.0]);
    assert!((beta - 0.5 * f64::exp(-2.0 * (0.25 + 0.25) / 2.0)).abs() < 1e-15);
}

/// Everything the objective is asked about lies inside, unless clamping is off.
#[test]
fn clamping_keeps_every_firefly_inside() {
    let outside = std::cell::Cell::new(0);
    let objective = |x: &[f64]| {
        outside.set(outside.get() + usize::from(x.iter().any(|v| v.abs() > 1.0)));
        (SCHAFFER.cost)(x)
    };
    let wide = StandardSettings { alpha0: 3.0, ..StandardSettings::paper() };
    standard(objective, &square(1.0), &wide, &mut stream(3, 0), watch).unwrap();
    assert_eq!(outside.get(), 0);
    let wide = ImprovedSettings { alpha0: 3.0, ..ImprovedSettings::paper() };
    improved(objective, &square(1.0), &wide, &mut stream(3, 0), watch).unwrap();
    assert_eq!(outside.get(), 0);
    let free = StandardSettings { alpha0: 3.0, clamp: false, ..StandardSettings::paper() };
    standard(objective, &square(1.0), &free, &mut stream(3, 0), watch).unwrap();
    assert!(outside.get() > 100);
}

fn rises(swarm: &Swarm) -> usize {
    swarm.history.windows(2).filter(|pair| pair[1].best > pair[0].best).count()
}

#[test]
fn with_the_archive_the_best_never_gets_worse() {
    let hot = ImprovedSettings { epsilon: Epsilon::Absolute(1.0), ..ImprovedSettings::paper() };
    let kept = ImprovedSettings { archive: true, ..hot };
    for seed in 0..20 {
        let (lost, kept) = (run_improved(&hot, seed), run_improved(&kept, seed));
        assert!(rises(&lost) > 0, "without it, the Metropolis criterion gives the best away");
        assert_eq!(rises(&kept), 0);
        let lowest = lost.history.iter().map(|generation| generation.best).fold(f64::INFINITY, f64::min);
        assert!(kept.best_cost <= lowest, "the archive watches the same search");
        assert_eq!((RASTRIGIN.cost)(&kept.best), kept.best_cost);
    }
}

#[test]
fn the_brightest_of_the_standard_algorithm_stays() {
    for seed in 0..20 {
        assert_eq!(rises(&run_standard(&StandardSettings::paper(), seed)), 0);
    }
}

#[test]
fn evaluations_are_counted_and_within_one_per_firefly_and_generation() {
    let mut calls = 0;
    let objective = |x: &[f64]| {
        calls += 1;
        (RASTRIGIN.cost)(x)
    };
    let settings = ImprovedSettings::recommended();
    let swarm = improved(objective, &square(2.0), &settings, &mut stream(5, 0), watch).unwrap();
    assert_eq!(swarm.evaluations, calls);
    assert!(swarm.evaluations <= settings.population * (settings.generations + 1));
    assert_eq!(swarm.history.len(), settings.generations + 1);
    assert_eq!(swarm.termination, Termination::Completed);
}

/// A cost that only rises, and a temperature at which everything is accepted: the perturbed firefly is at
/// once the darker one of two, and must not fly to the other in the same generation.
#[test]
fn the_perturbed_firefly_does_not_move_twice() {
    let mut calls = 0.0;
    let rising = |_: &[f64]| {
        calls += 1.0;
        calls
    };
    let settings = ImprovedSettings { population: 2, epsilon: Epsilon::Absolute(1e18), ..ImprovedSettings::paper() };
    let swarm = improved(rising, &square(1.0), &settings, &mut stream(5, 0), watch).unwrap();
    assert_eq!(swarm.evaluations, 2 + settings.generations);
}

#[test]
fn the_observer_stops_the_search_and_the_result_is_that_generations() {
    let full = run_improved(&ImprovedSettings::recommended(), 6);
    for last in [0, 7] {
        let stop = |n, _: &Generation| {
            if n == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let settings = ImprovedSettings::recommended();
        let swarm = improved(RASTRIGIN.cost, &square(2.0), &settings, &mut stream(6, 0), stop).unwrap();
        assert_eq!(swarm.termination, Termination::Cancelled);
        assert_eq!(swarm.history, full.history[..=last]);
        assert_eq!(swarm.best_cost, full.history[last].best);
    }
}

#[test]
fn what_is_not_a_number_is_avoided() {
    let half = |x: &[f64]| {
        if x[0] < 0.0 { f64::NAN } else { (RASTRIGIN.cost)(x) }
    };
    for seed in 0..20 {
        let rng = &mut stream(7, seed);
        let swarm = improved(half, &square(2.0), &ImprovedSettings::recommended(), rng, watch).unwrap();
        assert!(swarm.best[0] >= 0.0 && swarm.best_cost.is_finite());
    }
    let nowhere = |_: &[f64]| f64::NAN;
    let swarm = improved(nowhere, &square(2.0), &ImprovedSettings::paper(), &mut stream(7, 0), watch).unwrap();
    assert_eq!((swarm.best.len(), swarm.best_cost), (2, f64::INFINITY));
}

#[test]
fn settings_without_sense_are_refused_by_name() {
    let refusal = |change: fn(&mut ImprovedSettings)| {
        let mut settings = ImprovedSettings::paper();
        change(&mut settings);
        let rng = &mut stream(8, 0);
        let refused = improved(RASTRIGIN.cost, &square(1.0), &settings, rng, watch);
        refused.unwrap_err().to_string()
    };
    let negative = "must be finite and not negative";
    let zero = "is 0; it must be at least 1";
    assert_eq!(refusal(|s| s.population = 1), "the population is 1; a swarm needs at least 2 fireflies");
    assert_eq!(refusal(|s| s.selected = 0), format!("selected {zero}"));
    assert_eq!(refusal(|s| s.perturbed = Perturbed::UpTo(0)), format!("perturbed {zero}"));
    assert_eq!(refusal(|s| s.k = -1.0), format!("k is -1; it {negative}"));
    assert_eq!(refusal(|s| s.epsilon = Epsilon::OfInitialBest(f64::NAN)), format!("epsilon is NaN; it {negative}"));
    let blind = StandardSettings { alpha0: f64::INFINITY, ..StandardSettings::paper() };
    let rng = &mut stream(8, 0);
    let refused = standard(RASTRIGIN.cost, &square(1.0), &blind, rng, watch);
    assert_eq!(refused.unwrap_err().to_string(), format!("alpha0 is inf; it {negative}"));
}

#[test]
fn domains_without_width_are_refused_with_their_place() {
    assert_eq!(Domain::new(&[]), Err(FireflyError::NoDimensions));
    for bound in [1.0..=1.0, 1.0..=-1.0, 0.0..=f64::NAN, f64::MIN..=f64::MAX] {
        let refused = Domain::new(&[0.0..=1.0, bound]);
        assert!(matches!(refused, Err(FireflyError::Bounds { dimension: 1, .. })), "{refused:?}");
    }
}
