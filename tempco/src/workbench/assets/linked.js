// The linked plots: one residual against everything that it may depend on. What is brushed in one is lit in all.

import { answer, bytes } from "./api.js";
import { count, fixed, make, ug, visible } from "./dom.js";
import { Scatter } from "./scatter.js";

const AXES = [
  { column: "temperature_c", title: "temperature", unit: "°C" },
  { column: "rate_c_per_min", title: "rate of temperature", unit: "°C/min" },
  { column: "power_on_min", title: "time since power-on", unit: "min", log: true },
  { column: "age_days", title: "calendar age", unit: "days" },
  { column: "level_g", title: "applied acceleration", unit: "g" },
  { column: "delta_f_hz", title: "frequency difference Δf", unit: "Hz" },
  { column: "time_h", title: "time, run after run", unit: "h", wide: true },
];
// Slower than this is still, °C per minute: two minutes of a thermometer's noise.
const STILL = 0.02;
const SETTLE_MS = 150;
const NAMED_RUNS = 4;

const section = document.querySelector("#linked");
const plots = AXES.map((axis) => new Scatter(axis, brushed));
const words = make("p", { class: "chosen", role: "status", "aria-live": "polite" });
const controls = make("div", { class: "controls" });
const decimated = make("p", { class: "note" });
const legend = make("ul", { class: "keys", "aria-hidden": "true" });
let shown = { key: undefined };
let brush;
let pending;

section.append(
  make("div", { class: "section-head" }, make("h2", { id: "linked-title" }, "Residuals"), controls),
  make("div", { class: "section-line" }, legend, words),
  make(
    "p",
    { id: "brush-help", class: "visually-hidden" },
    "Drag over samples to choose them, or press Enter and use the arrow keys; Shift and arrow widen, Escape ends.",
  ),
  make(
    "div",
    { class: "scatters" },
    plots.map((plot) => plot.figure),
  ),
  decimated,
);

export const linked = { update, brushOf: () => brush };

// Shows the model that is looked at, and another one with it where one is chosen.
async function update(state, ui, choose) {
  const model = state.models.find((one) => one.number === state.current);
  section.hidden = !model;
  if (!model) {
    shown = { key: undefined };
    return;
  }
  drawControls(state, ui, model, choose);
  const models = [model.number, ui.against].filter(Boolean);
  // No two models ever share a file.
  const files = state.models.filter((one) => models.includes(one.number)).map((one) => one.file);
  const key = `${files}|${models}|${ui.runs ?? "all"}`;
  if (key === shown.key) return;
  shown = { key };
  const data = unpack(await bytes(`/api/samples?models=${models}`));
  if (shown.key !== key) return;
  shown = { key, models, data, runs: ui.runs, ...seen(data, ui.runs) };
  draw();
  clear();
}

// u32 length of a JSON header, the header, then columns of f32.
function unpack(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const column = () => {
    const values = new Float32Array(buffer, at, head.kept);
    at += 4 * head.kept;
    return values;
  };
  const columns = Object.fromEntries(head.columns.map((name) => [name, column()]));
  return { ...head, columns, residuals: head.models.map(column) };
}

// The samples of the runs that are asked for.
function seen(data, runs) {
  const wanted = (k) => !runs || data.runs[data.columns.run[k]].held_out === (runs === "held-out");
  const rows = [];
  for (let k = 0; k < data.kept; k += 1) if (wanted(k)) rows.push(k);
  const pick = (values) => Float32Array.from(rows, (k) => values[k]);
  const columns = Object.fromEntries(Object.entries(data.columns).map(([name, values]) => [name, pick(values)]));
  return { columns, residuals: data.residuals.map(pick) };
}

function draw() {
  const { columns, residuals, data } = shown;
  const both = residuals.length > 1;
  const classes = Uint8Array.from(columns.rate_c_per_min, (rate) => (rate > STILL ? 2 : rate < -STILL ? 1 : 0));
  const series = both
    ? [
        { ys: residuals[1], classes: new Uint8Array(classes.length) },
        { ys: residuals[0], classes: new Uint8Array(classes.length).fill(1) },
      ]
    : [{ ys: residuals[0], classes }];
  const palette = ["quiet", "first", "second"].map(colour);
  const yRange = span(residuals);
  for (const plot of plots) {
    const bands =
      plot.axis.column === "time_h"
        ? data.runs.map(({ name, from_h: from, to_h: to, held_out: held }) => ({ name, from, to, held }))
        : [];
    plot.show({ xs: columns[plot.axis.column], series, yRange, palette, bands });
  }
  drawLegend(both);
  decimated.textContent =
    data.kept < data.rows
      ? `${count(data.kept)} of ${count(data.rows)} samples are drawn: of each ${data.stride} that follow each other the lowest and the highest. Figures are of all.`
      : "";
}

function span(residuals) {
  let [low, high] = [0, 0];
  for (const values of residuals) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  const room = (high - low) * 0.05 || 1;
  return [low - room, high + room];
}

function colour(name) {
  const probe = make("span", { class: `probe tone-${name}` });
  section.append(probe);
  const parts = getComputedStyle(probe).color.match(/\d+/g).slice(0, 3).map(Number);
  probe.remove();
  return parts;
}

function drawLegend(both) {
  const entry = (tone, text) => make("li", {}, make("span", { class: `key-dot tone-${tone}` }), text);
  const [first, second] = shown.models;
  legend.replaceChildren(
    ...(both
      ? [entry("first", `model ${first}`), entry("quiet", `model ${second}`)]
      : [entry("second", "temperature rising"), entry("first", "falling"), entry("quiet", "still")]),
    make("li", {}, make("span", { class: "key-held" }), "held out"),
  );
}

function brushed(plot, region, since) {
  brush = region && { plot, ...region };
  for (const one of plots) one.setBrush(one === plot ? region : undefined);
  const rows = region && chosen(plot.axis, region);
  for (const one of plots) one.light(rows);
  performance.measure("brush", { start: since, end: performance.now() });
  clearTimeout(pending);
  if (region) pending = setTimeout(tell, SETTLE_MS);
  else clear();
  if (region) document.dispatchEvent(new CustomEvent("brushed"));
}

function chosen({ column, log }, { x, y }) {
  const {
    columns,
    residuals: [residual],
  } = shown;
  const values = columns[column];
  const rows = [];
  for (let k = 0; k < residual.length; k += 1) {
    const value = log ? Math.max(0.1, values[k]) : values[k];
    if (value >= x[0] && value <= x[1] && residual[k] >= y[0] && residual[k] <= y[1]) rows.push(k);
  }
  return rows;
}

// What the chosen samples amount to is computed from all of them, drawn or not.
async function tell() {
  const { plot, x, y } = brush;
  const column = plot.axis.column;
  // What is drawn at the edge of a logarithm lies beyond it.
  const low = plot.axis.log && x[0] <= plot.xRange[0] * 1.001 ? null : x[0];
  const request = {
    models: shown.models,
    held_out: shown.runs ? shown.runs === "held-out" : null,
    ranges: [
      { column, low, high: x[1] },
      { column: "residual_ug", low: y[0], high: y[1] },
    ],
  };
  const found = await answer("chosen", request).catch(() => undefined);
  if (!found || !brush || brush.plot !== plot || brush.x !== x) return;
  const each = found.models.map(
    ({ rms_ug: rms, mean_ug: mean }, k) =>
      `${found.models.length > 1 ? `model ${shown.models[k]}: ` : ""}${ug(rms)} RMS, mean ${mean > 0 ? "+" : ""}${ug(mean)}`,
  );
  const named = found.runs.slice(0, NAMED_RUNS).map(({ run, samples }) => `${run} (${count(samples)})`);
  const rest = found.runs.length - named.length;
  words.textContent = found.samples
    ? `${count(found.samples)} of ${count(found.of)} samples: ${each.join("; ")}. In ${visible(named.join(", "))}${rest > 0 ? ` and ${rest} more` : ""}.`
    : "No sample is chosen.";
}

function clear() {
  brush = undefined;
  for (const plot of plots) {
    plot.setBrush(undefined);
    plot.light(undefined);
  }
  words.textContent = "Drag over samples in any plot: the same samples light up in all.";
}

function drawControls(state, ui, model, choose) {
  const others = state.models.filter((one) => one.number !== model.number);
  const pick = (id, label, value, options, onchange) =>
    make(
      "label",
      { class: "field inline" },
      label,
      make(
        "select",
        { id, onchange: (event) => onchange(event.target.value) },
        options.map(([key, text]) => make("option", { value: key, selected: String(key) === String(value ?? "") }, text)),
      ),
    );
  const focused = document.activeElement?.id;
  const title = (one) => `${one.number} · ${one.title} (${fixed(one.comparison.residual_ug)} µg)`;
  controls.replaceChildren(
    pick(
      "linked-model",
      "Model",
      model.number,
      state.models.map((one) => [one.number, title(one)]),
      (value) => choose.model(Number(value)),
    ),
    ...(others.length
      ? [
          pick(
            "linked-against",
            "with",
            ui.against,
            [["", "no other"], ...others.map((one) => [one.number, title(one)])],
            (value) => choose.against(Number(value) || undefined),
          ),
        ]
      : []),
    pick(
      "linked-runs",
      "Runs",
      ui.runs,
      [
        ["", "all"],
        ["held-out", "held out"],
        ["training", "training"],
      ],
      (value) => choose.runs(value || undefined),
    ),
  );
  if (focused?.startsWith("linked-")) document.getElementById(focused)?.focus();
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => shown.data && draw());
