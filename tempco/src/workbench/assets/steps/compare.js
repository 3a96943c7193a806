// Compare: the models with each other, run by run.

import { bar, button, command, count, fixed, make, table, ug } from "../dom.js";

export const id = "compare";
export const name = "Compare";
export const title = "Compare with the measurements";

export function summary(state, model) {
  const noise = state.campaign?.blind?.noise_ug;
  if (!model) return { done: false };
  const { residual_ug: residual, noise_floor_ug: floor } = model.comparison;
  const least = noise ?? floor;
  return { done: true, text: least ? `${fixed(residual / least, 1)} times the noise` : ug(residual) };
}

export function render(state, model, context) {
  if (!model) return [make("p", { class: "empty" }, "Train a model first.")];
  const other = state.models.find((one) => one.number === context.ui.against);
  const { comparison } = model;
  return [
    headline(comparison),
    ...comparison.warnings.map((warning) => make("p", { class: "warning" }, warning)),
    state.models.length > 1 ? models(state, model, context) : undefined,
    runs(model, other),
    figures(comparison),
    command(model.commands.compare),
  ];
}

function headline({ residual_ug: residual, noise_floor_ug: noise, held_out: held, sensitivity_ppm: slope }) {
  return make(
    "p",
    { class: "answer" },
    make("strong", {}, ug(residual)),
    ` RMS ${held ? "on runs that the training never saw" : "on the training runs"}`,
    noise ? `; noise from sample to sample ${ug(noise)}.` : ".",
    slope ? ` Local slope within ${fixed(slope.worst, 0)} ppm of the measured scale factor.` : "",
  );
}

function models(state, model, context) {
  const number = (text) => ({ number: text });
  const rows = state.models.map((one) => ({
    properties: { class: one.number === model.number ? "current" : "" },
    cells: [
      `${one.number} · ${one.title}`,
      one.effect_titles.join(", ") || "none",
      ug(one.comparison.residual_ug),
      one.comparison.sensitivity_ppm ? fixed(one.comparison.sensitivity_ppm.worst, 0) : "–",
      make(
        "span",
        { class: "buttons" },
        one.number === model.number
          ? "looked at"
          : button("Look at", {
              class: "button tiny quiet",
              id: `look-${one.number}`,
              onclick: () => context.choose.model(one.number),
            }),
        one.number !== model.number &&
          button(context.ui.against === one.number ? "Compared" : "Compare", {
            class: "button tiny quiet",
            id: `against-${one.number}`,
            "aria-pressed": String(context.ui.against === one.number),
            onclick: () => context.choose.against(context.ui.against === one.number ? undefined : one.number),
          }),
      ),
    ],
  }));
  return table("Models", ["model", "effects", number("held-out residual"), number("worst slope ppm"), ""], rows);
}

function runs(model, other) {
  const all = model.comparison.runs;
  const theirs = new Map((other?.comparison.runs ?? []).map((run) => [run.run, run]));
  const highest = Math.max(...all.map((run) => run.residual_ug), ...[...theirs.values()].map((run) => run.residual_ug));
  const number = (text) => ({ number: text });
  const rows = all.map((run) => ({
    cells: [
      run.run,
      run.kind,
      run.held_out ? "held out" : "training",
      count(run.samples),
      make(
        "span",
        { class: "bars" },
        bar(run.residual_ug / highest, run.held_out || other ? "first" : "sixth"),
        theirs.has(run.run) && bar(theirs.get(run.run).residual_ug / highest, "quiet"),
      ),
      fixed(run.residual_ug),
      ...(other ? [fixed(theirs.get(run.run)?.residual_ug)] : []),
      fixed(run.mean_ug),
      fixed(run.about_mean_ug),
      String(run.flagged),
    ],
  }));
  const header = [
    "run",
    "kind",
    "seen",
    number("samples"),
    "",
    number(other ? `model ${model.number} µg` : "residual µg"),
    ...(other ? [number(`model ${other.number} µg`)] : []),
    number("mean µg"),
    number("about mean µg"),
    number("flagged"),
  ];
  return make(
    "div",
    { class: "scroll tall", id: "compare-runs", tabindex: "0", role: "region", "aria-label": "Residual run by run" },
    table("", header, rows),
  );
}

function figures({ figures: all }) {
  const number = (text) => ({ number: text });
  const still = all
    .filter((one) => one.compensated.zero_bias)
    .map(({ run, raw, compensated }) => ({
      cells: [
        run,
        ...["from_start_ug", "after_20_min_ug", "after_30_min_ug"].flatMap((key) => [
          fixed(raw.zero_bias[key], 1),
          fixed(compensated.zero_bias[key], 1),
        ]),
      ],
    }));
  const full = all
    .filter((one) => one.compensated.full_temperature)
    .map(({ run, raw, compensated }) => ({
      cells: [
        run,
        ...["scale_factor_variation_ppm", "bias_variation_ug"].flatMap((key) => [
          fixed(raw.full_temperature[key], 1),
          fixed(compensated.full_temperature[key], 1),
        ]),
      ],
    }));
  if (!still.length && !full.length) return undefined;
  return make(
    "details",
    { id: "figures" },
    make("summary", {}, "Figures of merit, raw and compensated"),
    still.length
      ? table(
          "Zero-bias stability, µg",
          [
            "run",
            number("start: raw"),
            number("comp."),
            number("20 min: raw"),
            number("comp."),
            number("30 min: raw"),
            number("comp."),
          ],
          still,
        )
      : undefined,
    full.length
      ? table(
          "Over temperature",
          ["run", number("scale factor ppm: raw"), number("comp."), number("bias µg: raw"), number("comp.")],
          full,
        )
      : undefined,
  );
}
