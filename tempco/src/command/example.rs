//! A diagnosis for tests: what it found, and nothing else worth a number.

use trainer::diagnose::{Diagnosis, Finding, Noise, Unexplained, Verdict};

/// These effects are missing, each as likely as the others beside it.
pub fn diagnosis(found: &[(&str, &[&str])]) -> Diagnosis {
    let finding = |(effect, others): &(&str, &[&str])| Finding {
        effect: (*effect).to_owned(),
        residual_before_ug: 9.0,
        residual_after_ug: 5.0,
        delta_bic: 100.0,
        parameters: Default::default(),
        confounded_with: others.iter().map(|other| (*other).to_owned()).collect(),
        separate_by: None,
    };
    Diagnosis {
        verdict: if found.is_empty() { Verdict::NothingMissing } else { Verdict::Missing },
        residual_ug: 9.0,
        residual_after_ug: 5.0,
        predictable_ug: 9.0,
        predictable_after_ug: 5.0,
        noise_floor_ug: 5.0,
        explainable: 1.0,
        findings: found.iter().map(finding).collect(),
        candidates: Vec::new(),
        unobservable: Vec::new(),
        unexplained: None,
        dependences: Vec::new(),
        noise: NOISE,
    }
}

/// Structure that no effect makes, and perhaps a formula for it.
pub fn unexplained(formula: Option<&str>) -> Diagnosis {
    let unexplained = Unexplained {
        depends_on: vec!["time".to_owned()],
        period_s: None,
        formula: formula.map(str::to_owned),
        residual_ug: 3.0,
    };
    Diagnosis { verdict: Verdict::Unexplained, unexplained: Some(unexplained), ..diagnosis(&[]) }
}

const NOISE: Noise = Noise {
    sample_ug: 5.0,
    flicker_ug: 0.0,
    wander_ug: 0.0,
    walk_ug_per_sqrt_h: 0.0,
    node_ug: 0.0,
    position_ug: 0.0,
    pose_ug: 0.0,
    mounting_ug: 0.0,
    turn_ug: 0.0,
    run_ug: 0.0,
};
