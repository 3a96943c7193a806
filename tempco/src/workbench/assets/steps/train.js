// Train: which runs judge, then every restart's curve while it falls.

import { button, command, make, ug } from "../dom.js";
import { drawRungs } from "../reports.js";

export const id = "train";
export const name = "Train";
export const title = "Train a model";

const MOST_BOXES = 200;

export function summary({ models }) {
  const trained = models.find((one) => one.parent === null);
  return {
    done: Boolean(trained),
    text: trained
      ? `${ug(trained.comparison.residual_ug)} ${trained.comparison.held_out ? "held out" : "on training runs"}`
      : "",
  };
}

export function render(state, _model, context) {
  if (!state.campaign) return [make("p", { class: "empty" }, "Load a campaign first.")];
  const { words, made } = outcome(state);
  return [
    split(state, context),
    options(state, context),
    make("div", { class: "beside" }, make("div", { id: "curves", class: "curves", hidden: true }), words),
    made,
  ];
}

function split(state, context) {
  const { campaign } = state;
  const held = new Set(campaign.runs.filter((run) => run.held_out).map((run) => run.run));
  const send = (names) => context.act("split", { hold_out: names });
  const box = (run) =>
    make(
      "label",
      { class: "run-choice" },
      make("input", {
        type: "checkbox",
        id: `held-${run.run}`,
        checked: run.held_out,
        disabled: Boolean(state.job),
        onchange: ({ target }) => {
          if (target.checked) held.add(run.run);
          else held.delete(run.run);
          send([...held]);
        },
      }),
      make("span", {}, run.run),
      make("span", { class: "kind" }, run.kind),
    );
  const names = [...held];
  const shown = names.length > 8 ? `${names.slice(0, 7).join(", ")} and ${names.length - 7} more` : names.join(", ") || "none";
  return make(
    "details",
    { id: state.models.length ? "split" : "first-split", class: "split", open: !state.models.length },
    make(
      "summary",
      {},
      make("span", { class: "strong" }, `Held out: ${names.length} of ${campaign.runs.length} runs`),
      ` · ${shown}`,
    ),
    make(
      "fieldset",
      {},
      make(
        "legend",
        { class: "note" },
        "These runs judge the model: no training ever sees them. ",
        sentence(campaign.split_refused?.message ?? campaign.basis ?? ""),
      ),
      campaign.hold_out
        ? button("The usual choice", { class: "button tiny quiet", id: "usual-split", onclick: () => send(null) })
        : undefined,
      campaign.runs.length > MOST_BOXES
        ? byName(names, state, send)
        : make("div", { class: "scroll run-choices", id: "run-choices" }, campaign.runs.map(box)),
    ),
  );
}

// A page of thousands of boxes would be no choice.
function byName(names, state, send) {
  const input = make("input", { type: "text", id: "held-names", value: names.join(", "), spellcheck: "false" });
  const apply = () =>
    send(
      input.value
        .split(",")
        .map((name_) => name_.trim())
        .filter(Boolean),
    );
  return make(
    "div",
    { class: "actions" },
    make("label", { class: "field" }, "Names, separated by commas", input),
    button("Hold these out", { id: "hold-names", disabled: Boolean(state.job), onclick: apply }),
  );
}

const sentence = (text) => (text ? `${text[0].toUpperCase()}${text.slice(1)}.` : "");

function options(state, context) {
  const { typed } = context.ui;
  const field = (key, label, value, properties) =>
    make(
      "label",
      { class: "field inline" },
      label,
      make("input", {
        type: "number",
        id: `option-${key}`,
        value: typed[key] ?? value,
        oninput: ({ target }) => {
          typed[key] = target.value;
        },
        ...properties,
      }),
    );
  const methods = [
    ["second-order", "second order"],
    ["fa-bp", "FA-BP, the paper's"],
    ["ifa-bp", "IFA-BP, the paper's"],
  ];
  const method = make(
    "select",
    {
      id: "option-method",
      onchange: ({ target }) => {
        typed.method = target.value;
      },
    },
    methods.map(([value, text]) => make("option", { value, selected: (typed.method ?? "second-order") === value }, text)),
  );
  const request = () => ({
    restarts: Number(typed.restarts ?? 30),
    seed: Number(typed.seed ?? 1),
    method: typed.method ?? "second-order",
    scale_factor: typed.scale ? Number(typed.scale) : null,
  });
  return make(
    "div",
    { class: "actions" },
    button("Train", {
      class: "button primary",
      id: "train",
      disabled: Boolean(state.job),
      onclick: () => context.act("train", request()),
    }),
    make(
      "details",
      { id: "options" },
      make("summary", {}, "Options"),
      make(
        "div",
        { class: "fields" },
        field("restarts", "Restarts", 30, { min: 1, max: 1000 }),
        field("seed", "Seed", 1, { min: 0 }),
        make("label", { class: "field inline" }, "Method", method),
        field("scale", "Scale factor, Hz/g", "", { step: "any", placeholder: "measured" }),
      ),
    ),
  );
}

function outcome(state) {
  if (state.job?.step === "train") return { made: command(state.job.command) };
  const trained = state.models.findLast((one) => one.parent === null);
  if (!trained) return {};
  const { comparison, simpler } = trained;
  const where = comparison.held_out ? "on runs that the training never saw" : "on the training runs";
  const list = make("ol", { class: "ladder" });
  const noise = state.campaign.blind
    ? { effect: "noise alone, says the simulation", residual_ug: state.campaign.blind.noise_ug, tone: "quiet" }
    : { effect: "noise from sample to sample", residual_ug: comparison.noise_floor_ug, tone: "quiet" };
  const polynomial = simpler
    .filter((one) => one.model.startsWith("polynomial"))
    .map((one) => ({ effect: one.model, residual_ug: one.residual_ug, tone: "fifth" }));
  drawRungs(
    list,
    [...polynomial, { effect: "network", residual_ug: comparison.residual_ug, tone: "first" }, noise].filter(
      (rung) => rung.residual_ug !== null,
    ),
  );
  const raw = simpler.find((one) => one.model.startsWith("a line"));
  const words = make(
    "div",
    { class: "outcome" },
    make(
      "p",
      { class: "answer" },
      make("strong", {}, ug(comparison.residual_ug)),
      ` RMS ${where}`,
      raw ? `; a straight line through the raw frequency leaves ${ug(raw.residual_ug)}.` : ".",
    ),
    list,
  );
  return { words, made: command(trained.commands.made_by) };
}
