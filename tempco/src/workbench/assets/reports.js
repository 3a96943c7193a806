// What work tells while it goes on: the curve of every restart, the rungs of the ladder, how much is done.

import { bar, make, ug } from "./dom.js";

const DRAW_MS = 250;
const jobs = new Map();
let last;
let waiting;

export const reports = { take, attach, share, rungs };

function job(number) {
  if (!jobs.has(number)) jobs.set(number, { number, stages: [], rungs: [], share: undefined });
  return jobs.get(number);
}

function take({ job: number, from, reports: told }) {
  if (from === 0) jobs.delete(number);
  last = job(number);
  for (const report of told) TAKE[report.kind](last, report);
  waiting ??= setTimeout(() => {
    waiting = undefined;
    draw();
  }, DRAW_MS);
}

const TAKE = {
  begins(into, { restarts }) {
    into.stages.push({ restarts, curves: new Map() });
  },
  restart(into, { curve, index, iteration, residual_ug: residual, noise_ug: noise, done }) {
    const stage = into.stages.at(-1);
    if (!stage) return;
    if (!stage.curves.has(curve)) stage.curves.set(curve, { index, noise, x: [], y: [], done: false });
    const points = stage.curves.get(curve);
    points.x.push(iteration);
    points.y.push(residual);
    points.done ||= done;
  },
  rung(into, { effect, residual_ug: residual }) {
    into.rungs.push({ effect, residual_ug: residual });
  },
  done(into, { share: part }) {
    into.share = part;
  },
};

function share() {
  if (last?.share !== undefined && last.share < 1) return ` · ${Math.round(last.share * 100)} %`;
  const stage = last?.stages.at(-1);
  if (!stage) return "";
  const ended = [...stage.curves.values()].filter(({ index, done }) => done && index < stage.restarts).length;
  return ` · ${ended} of ${stage.restarts} restarts`;
}

// Rungs that work has reached, while it goes on.
function rungs(number) {
  return jobs.get(number)?.rungs ?? [];
}

let running;
function attach(state) {
  running = state.job?.number;
  draw();
}

function draw() {
  const target = document.getElementById("curves");
  if (target) drawCurves(target);
  const ladder = document.getElementById("rungs");
  // A bar that grows would begin anew each time.
  if (ladder && running && ladder.children.length !== rungs(running).length) drawRungs(ladder, rungs(running));
}

function drawCurves(target) {
  const stage = last?.stages.at(-1);
  target.hidden = !stage?.curves.size;
  if (target.hidden) return;
  const all = [...stage.curves.values()].filter(({ x }) => x.length > 1);
  if (!all.length) return;
  const lowest = ({ y }) => Math.min(...y);
  const line =
    (tone, name) =>
    ({ x, y }, k) => ({ mark: "line", name: k === 0 ? name : "", tone, x, y, dashed: false });
  const first = all.filter((one) => one.index < stage.restarts);
  const further = all.filter((one) => one.index >= stage.restarts);
  const best = first.length ? [first.reduce((a, b) => (lowest(b) < lowest(a) ? b : a))] : [];
  const floors = [
    ["noise floor", first.at(-1)?.noise],
    ["noise floor, trained on", further.at(-1)?.noise],
  ].filter(([, at], k, all_) => at && !(k && Math.abs(at / all_[0][1] - 1) < 0.4));
  const least = Math.min(...floors.map(([, at]) => at), ...all.map(lowest));
  const top = Math.max(...all.map(({ y }) => y[Math.min(y.length - 1, 2)]));
  const chart = {
    id: "curves",
    title: "Residual of every restart while it trains",
    caption: "Each thin line is one restart. Samples of one state are averaged; what their noise leaves is the floor.",
    x: { label: "iteration", unit: "", scale: "log", range: [1, Math.max(10, ...all.map(({ x }) => x.at(-1)))] },
    y: {
      label: "residual on the training runs",
      unit: "µg",
      scale: "log",
      range: [least * 0.8, Math.max(top, least * 4) * 1.2],
    },
    layers: [
      ...first.map(line("quiet", "restarts")),
      ...best.map(line("first", "the best of them")),
      ...further.map(line("third", "the best, trained on")),
      ...floors.map(([name, at]) => ({ mark: "rule", name: `${name} ${ug(at)}`, axis: "y", at })),
    ],
  };
  globalThis.charts.draw(target, chart, { runs: [], width: 620, height: 300 });
}

export function drawRungs(target, found) {
  const highest = Math.max(...found.map((rung) => rung.residual_ug), 1e-9);
  target.replaceChildren(
    ...found.map(({ effect, residual_ug: residual, tone }, k) =>
      make(
        "li",
        { class: "rung" },
        make("span", { class: "rung-name" }, k && !tone ? `+ ${effect}` : effect),
        bar(residual / highest, tone ?? "first"),
        make("span", { class: "rung-value" }, ug(residual)),
      ),
    ),
  );
}
