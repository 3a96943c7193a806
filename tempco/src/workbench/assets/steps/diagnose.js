// Diagnose: which effect is missing, how sure that is, what it could be confused with, and one click to add it.

import { bar, button, command, fixed, make, table, ug } from "../dom.js";

export const id = "diagnose";
export const name = "Diagnose";
export const title = "Diagnose what is missing";

const VERDICTS = {
  missing: "Something is missing",
  ambiguous: "It could be one or the other",
  "nothing-missing": "Nothing is missing",
  unexplained: "Something is unexplained",
};

export function summary(_state, model) {
  const diagnosis = model?.diagnosis;
  if (!diagnosis) return { done: false };
  const names = diagnosis.findings.map((finding) => finding.effect);
  return { done: true, text: names.length ? `${names.join(", ")} missing` : VERDICTS[diagnosis.verdict].toLowerCase() };
}

export function render(state, model, context) {
  if (!model) return [make("p", { class: "empty" }, "Train a model first.")];
  const { diagnosis } = model;
  const ask = button(diagnosis ? "Diagnose again" : "Diagnose", {
    id: "diagnose",
    class: diagnosis ? "button quiet" : "button primary",
    disabled: Boolean(state.job),
    onclick: () => context.act("diagnose", { model: model.number }),
  });
  if (!diagnosis) {
    return [
      make("p", {}, "Every known effect is tried against what is left, each run predicted from the others."),
      make("div", { class: "actions" }, ask),
      seal(state, context),
      command(model.commands.diagnose),
    ];
  }
  return [
    make(
      "div",
      { class: `verdict ${diagnosis.verdict}` },
      make("h2", {}, VERDICTS[diagnosis.verdict]),
      ...model.verdict.split("\n").map((line) => make("p", {}, line)),
    ),
    ...diagnosis.findings.map((finding) => card(finding, state, model, context)),
    formula(diagnosis, state, model, context),
    seal(state, context),
    dependences(diagnosis),
    candidates(diagnosis),
    unobservable(diagnosis),
    make("div", { class: "actions" }, ask),
    command(model.commands.diagnose),
  ];
}

function card(finding, state, model, context) {
  const about = context.effects.effects.find((one) => one.name === finding.effect);
  const has = model.effect_titles.includes(finding.effect);
  const add =
    about?.on_device &&
    !has &&
    button(`Add ${finding.effect}`, {
      class: "button primary",
      id: `add-${finding.effect}`,
      disabled: Boolean(state.job),
      onclick: () => context.act("add", { model: model.number, effect: finding.effect }),
    });
  return make(
    "article",
    { class: "finding" },
    make("div", { class: "finding-head" }, make("h3", {}, finding.effect), add),
    about && make("p", {}, about.summary),
    about && make("p", { class: "equation" }, about.equation),
    make(
      "ol",
      { class: "ladder" },
      rung("held out without it", finding.residual_before_ug, finding.residual_before_ug, "second"),
      rung("with it", finding.residual_after_ug, finding.residual_before_ug, "third"),
    ),
    make(
      "dl",
      { class: "facts" },
      make("dt", {}, "ΔBIC"),
      make(
        "dd",
        {},
        `${fixed(finding.delta_bic, 0)} `,
        make(
          "span",
          { class: "note" },
          "twice the log likelihood ratio, less ln n for each parameter; an effect needs 25",
        ),
      ),
      Object.entries(finding.parameters).map(([key, estimate]) => [
        make("dt", {}, key),
        make("dd", {}, parameter(key, estimate, about)),
      ]),
      finding.confounded_with.length
        ? [make("dt", {}, "Would explain the same"), make("dd", {}, finding.confounded_with.join(", "))]
        : [],
      finding.separate_by ? [make("dt", {}, "To tell them apart"), make("dd", {}, finding.separate_by)] : [],
      about && !about.on_device
        ? [make("dt", {}, "On the device"), make("dd", {}, "No instrument can predict it: it can be known, not compensated.")]
        : [],
    ),
  );
}

const rung = (name_, value, highest, tone) =>
  make(
    "li",
    { class: "rung" },
    make("span", { class: "rung-name" }, name_),
    bar(value / highest, tone),
    make("span", { class: "rung-value" }, ug(value)),
  );

// Two digits of the uncertainty, as many of the value, and the unit.
function parameter(key, { value, sigma }, about) {
  const unit = about?.parameters.find((one) => one.name === key)?.unit ?? "";
  if (!(sigma > 0)) return `${value.toPrecision(4)} ${unit}`;
  const exponent = (number) => Math.floor(Math.log10(Math.abs(number)));
  const top = exponent(Math.max(Math.abs(value), sigma));
  const scale = top >= -3 && top < 6 ? 0 : top;
  const digits = Math.max(0, Math.min(12, 1 + scale - exponent(sigma)));
  const [v, s] = [value, sigma].map((number) => fixed(number * 10 ** -scale, digits));
  if (!scale) return `${v} ± ${s} ${unit}`;
  return make("span", {}, `(${v} ± ${s}) · 10`, make("sup", {}, String(scale).replace("-", "\u2212")), ` ${unit}`);
}

function formula({ unexplained }, state, model, context) {
  if (!unexplained?.formula) return undefined;
  return make(
    "article",
    { class: "finding" },
    make(
      "div",
      { class: "finding-head" },
      make("h3", {}, "A formula describes it"),
      button("Add it as an expression", {
        class: "button primary",
        id: "add-formula",
        disabled: Boolean(state.job),
        onclick: () => context.act("add", { model: model.number, expression: unexplained.formula }),
      }),
    ),
    make("p", { class: "equation" }, unexplained.formula),
  );
}

// What a practice campaign hides, once one has made up one's mind.
function seal(state, context) {
  const blind = state.campaign?.blind;
  if (!blind) return undefined;
  const { revealed } = blind;
  if (!revealed) {
    return make(
      "div",
      { class: "aside seal" },
      make(
        "p",
        {},
        make("strong", {}, "What is really hidden"),
        " is in a sealed envelope. Open it when you have made up your mind.",
      ),
      button("Open the seal", { id: "reveal", onclick: () => context.act("reveal") }),
      command(blind.command),
    );
  }
  return make(
    "div",
    { class: "aside seal open" },
    make("h3", {}, "The truth"),
    revealed.hidden.map((one) =>
      make(
        "p",
        {},
        make("strong", {}, one.effect),
        ` leaves ${ug(one.share_ug)}, ${fixed(one.times_noise, 1)} times the noise: `,
        Object.entries(one.parameters)
          .map(([key, value]) => `${key} = ${Number(value.toPrecision(4))}`)
          .join(", "),
      ),
    ),
    revealed.judgement && make("p", { class: "answer" }, revealed.judgement),
    command(blind.command),
  );
}

function dependences({ dependences: all }) {
  if (!all.length) return undefined;
  const chance = (value) => (value < 1e-4 ? "< 0.0001" : fixed(value, 4));
  const highest = Math.max(...all.map((one) => one.before_ug), 1e-9);
  const rows = all.map((one) => ({
    cells: [
      one.on,
      make("span", { class: "bars" }, bar(one.before_ug / highest, "second"), bar(one.after_ug / highest, "third")),
      fixed(one.before_ug),
      chance(one.chance_before),
      fixed(one.after_ug),
      chance(one.chance_after),
    ],
  }));
  const number = (text) => ({ number: text });
  return make(
    "details",
    { id: "dependences" },
    make("summary", {}, "What the residual follows, before and after the findings"),
    table("", ["quantity", "", number("before µg"), number("by chance"), number("after µg"), number("by chance")], rows),
  );
}

function candidates({ candidates: all }) {
  if (!all.length) return undefined;
  const number = (text) => ({ number: text });
  const rows = all.map((one) => ({
    cells: [one.effect, fixed(one.delta_bic, 0), fixed(one.held_out_ratio, 3), one.reason],
  }));
  return make(
    "details",
    { id: "candidates" },
    make("summary", {}, "Every effect that was judged, and what came of it"),
    table("", ["effect", number("ΔBIC"), number("held-out ratio"), "what came of it"], rows),
  );
}

function unobservable({ unobservable: all }) {
  if (!all.length) return undefined;
  const reasons = new Map();
  for (const { effect, why } of all) reasons.set(why, [...(reasons.get(why) ?? []), effect]);
  return make(
    "details",
    { id: "unobservable" },
    make("summary", {}, "What this campaign can’t show"),
    make(
      "ul",
      { class: "plain" },
      [...reasons].map(([why, names]) => make("li", {}, make("strong", {}, names.join(", ")), `: ${why}`)),
    ),
  );
}
