//! A plan as text for people: what is open in a sentence, then the recordings that would decide it.

use crate::table::Table;
use std::fmt::Write;
use trainer::diagnose::plan::{Hypothesis, Plan, Proposal, Reason, Separation};

/// The whole plan.
pub fn text(plan: &Plan) -> String {
    let mut text = sentence(plan);
    for hypothesis in &plan.hypotheses {
        text += &assumed(hypothesis);
    }
    let _ = writeln!(text, "{}", so_far(plan));
    if plan.proposals.iter().any(Proposal::is_useful) {
        let _ = writeln!(text, "{}{DEFINITION}", table(plan));
    }
    text + &never(plan)
}

/// What the figures mean.
const DEFINITION: &str = "  σ = distance in standard deviations of the noise, the campaign and the recording together, \
    after all that\n  retraining and the other effect's parameters can absorb; σ²/hour is what a recording adds, over \
    all pairs";

/// What is to be told apart.
fn sentence(plan: &Plan) -> String {
    let names: Vec<&str> = plan.hypotheses.iter().map(|one| one.effect.as_str()).collect();
    let names = match names.as_slice() {
        [all @ .., last] if !all.is_empty() => format!("{} or {last}", all.join(", ")),
        names => names.concat(),
    };
    match plan.reason {
        Reason::Ambiguous => format!("{names}: this campaign can't tell which.\n"),
        Reason::Asked if plan.hypotheses.len() == 1 => format!("Is there {names}, or not?\n"),
        Reason::Asked => format!("To be told apart: {names}.\n"),
        Reason::Unseen => format!("Nothing is ambiguous. This campaign could not show {names}.\n"),
    }
}

fn assumed(hypothesis: &Hypothesis) -> String {
    let Hypothesis { effect, parameters, fitted } = hypothesis;
    let parameters: Vec<String> = parameters.iter().map(|(name, value)| format!("{name} = {value:.3e}")).collect();
    let from = if *fitted { "fitted to the campaign" } else { "as is typical: the campaign doesn't say" };
    format!("  {effect}: {} ({from})\n", parameters.join(", "))
}

fn so_far(plan: &Plan) -> String {
    let closest = plan.so_far.iter().map(|pair| pair.sigma).fold(f64::INFINITY, f64::min);
    let farthest = plan.so_far.iter().map(|pair| pair.sigma).fold(0.0, f64::max);
    if plan.so_far.iter().all(|pair| pair.from.is_none()) {
        let enough = plan.decisive_sigma;
        return format!("So far the strongest stands out by {farthest:.1} σ; {enough:.0} σ show an effect safely.\n");
    }
    let apart = if plan.so_far.len() > 1 { format!("{closest:.1} to {farthest:.1}") } else { format!("{closest:.1}") };
    if closest >= plan.decisive_sigma {
        return format!("The campaign tells them apart already: they are {apart} σ apart.\n");
    }
    format!("So far they are {apart} σ apart; {:.0} σ tell them apart safely.\n", plan.decisive_sigma)
}

fn table(plan: &Plan) -> String {
    let mut table = Table::new(["recording", "hours", "days", "σ²/hour", "tells apart, or shows, beyond doubt"]);
    for proposal in plan.proposals.iter().filter(|proposal| proposal.is_useful()) {
        table.row([
            proposal.recording.clone(),
            format!("{:.1}", proposal.hours),
            format!("{:.1}", proposal.days),
            format!("{:.1}", proposal.sigma2_per_hour),
            decides(plan, proposal),
        ]);
    }
    table.to_string()
}

/// The pairs that a recording decides and the campaign does not.
fn decides(plan: &Plan, proposal: &Proposal) -> String {
    let is_new = |(with, without): &(&Separation, &Separation)| {
        with.sigma >= plan.decisive_sigma && without.sigma < plan.decisive_sigma
    };
    let new = proposal.separations.iter().zip(&plan.so_far).filter(is_new).map(|(with, _)| with);
    let pairs: Vec<String> = new.map(|pair| format!("{} {:.0} σ", name(pair), pair.sigma)).collect();
    if pairs.is_empty() { format!("– ({:.1} σ at most)", most(proposal)) } else { pairs.join(", ") }
}

fn most(proposal: &Proposal) -> f64 {
    proposal.separations.iter().map(|pair| pair.sigma).fold(0.0, f64::max)
}

/// Pairs that no recording decides.
fn never(plan: &Plan) -> String {
    let undecided = |index: usize| {
        let all = plan.proposals.iter().map(|proposal| &proposal.separations).chain([&plan.so_far]);
        all.filter_map(|pairs| pairs.get(index)).all(|pair| pair.sigma < plan.decisive_sigma)
    };
    let open = plan.so_far.iter().enumerate().filter(|(index, _)| undecided(*index));
    let open: Vec<String> = open.map(|(_, pair)| name(pair)).collect();
    if open.is_empty() { String::new() } else { format!("No recording here decides {}.\n", open.join(", ")) }
}

fn name(pair: &Separation) -> String {
    match &pair.from {
        Some(other) => format!("{} | {other}", pair.effect),
        None => pair.effect.clone(),
    }
}
