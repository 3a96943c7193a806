// The page: what there is comes from the server as one state; each step draws its part of it.

import { act, listen, read } from "./api.js";
import { make, visible } from "./dom.js";
import { guide } from "./guide.js";
import { linked } from "./linked.js";
import { reports } from "./reports.js";
import * as add from "./steps/add.js";
import * as compare from "./steps/compare.js";
import * as diagnose from "./steps/diagnose.js";
import * as exported from "./steps/export.js";
import * as load from "./steps/load.js";
import * as plan from "./steps/plan.js";
import * as train from "./steps/train.js";
import * as verify from "./steps/verify.js";

const STEPS = [load, train, compare, diagnose, add, exported, verify, plan];
// Work of the server and the step that shows it.
const SHOWN_BY = { load, train, diagnose, add, verify, plan };

const find = (id) => document.getElementById(id);
// What only the page knows: where the user is, and what was typed and not yet sent.
const ui = { step: load, against: undefined, runs: undefined, typed: {} };
let state;
let effects;
let ticking;
// What became of the campaign before this one.
let moved = "";

const context = {
  ui,
  get effects() {
    return effects;
  },
  // Asks the server for something; why it would not is shown where everybody looks.
  async act(verb, request) {
    refuse(undefined);
    try {
      await act(verb, request);
    } catch (refusal) {
      refuse(refusal);
    }
  },
  refuse,
  go,
  redraw: draw,
};

const choose = {
  model: (model) => {
    if (ui.against === model) ui.against = undefined;
    context.act("select", { model });
  },
  against: (model) => {
    ui.against = model;
    draw();
  },
  runs: (runs) => {
    ui.runs = runs;
    draw();
  },
};
context.choose = choose;

function go(step) {
  ui.step = step;
  draw();
  find("main").focus();
}

function refuse(refusal) {
  find("refusal").replaceChildren(
    ...(refusal
      ? [
          ...lines(refusal.message).map((line) => make("p", { class: "message" }, line)),
          ...lines(refusal.help).map((line) => make("p", { class: "help" }, line)),
        ]
      : []),
  );
}

const lines = (text) => (text ? text.split("\n") : []);

function draw() {
  if (!state) return;
  const model = state.models.find((one) => one.number === state.current);
  if (ui.against === state.current || !state.models.some((one) => one.number === ui.against)) ui.against = undefined;
  drawSteps(model);
  const panel = find("panel");
  keepFocus(panel, () =>
    panel.replaceChildren(
      make("h1", { id: "panel-title" }, ui.step.title),
      ...ui.step.render(state, model, context).flat(Infinity).filter(Boolean),
    ),
  );
  reports.attach(state);
  drawActivity();
  find("subject").textContent = state.campaign
    ? visible(`${state.campaign.files.join(", ")}${model ? ` · model ${model.number}` : ""}`)
    : "";
  linked.update(state, ui, choose).catch((refusal) => refuse(refusal));
  guide.update(state, context);
}

// Drawing anew must not take away what one is at: focus, and a list's place.
function keepFocus(within, redraw) {
  const active = document.activeElement;
  const id = within.contains(active) ? active.id : "";
  const text = id && "selectionStart" in active ? [active.selectionStart, active.selectionEnd] : undefined;
  const places = [...within.querySelectorAll(".scroll[id]")].map(({ id: name, scrollTop }) => [name, scrollTop]);
  const open = [...within.querySelectorAll("details[id]")].map(({ id: name, open: is }) => [name, is]);
  redraw();
  for (const [name, is] of open) if (find(name)) find(name).open = is;
  for (const [name, place] of places) if (find(name)) find(name).scrollTop = place;
  if (!id) return;
  const again = find(id);
  again?.focus({ preventScroll: true });
  if (again && text?.[0] !== null && text) again.setSelectionRange?.(...text);
}

function drawSteps(model) {
  const list = find("steps");
  const focused = document.activeElement?.id;
  const busy = state.job && SHOWN_BY[state.job.step];
  list.replaceChildren(
    ...STEPS.map((step) => {
      const { done, text } = step.summary(state, model);
      const mark = busy === step ? "busy" : done ? "done" : "open";
      const said = { busy: "at work", done: "done", open: "not done" }[mark];
      return make(
        "li",
        {},
        make(
          "button",
          {
            type: "button",
            id: `step-${step.id}`,
            class: "step",
            "aria-current": ui.step === step ? "step" : undefined,
            onclick: () => go(step),
          },
          make("span", { class: `step-mark ${mark}`, "aria-hidden": "true" }),
          make("span", { class: "step-name" }, step.name),
          make("span", { class: "visually-hidden" }, `, ${said}. `),
          make("span", { class: "step-text" }, text ?? ""),
        ),
      );
    }),
  );
  if (focused?.startsWith("step-")) find(focused)?.focus();
}

function drawActivity() {
  const { job, stopped } = state;
  find("stop").hidden = !job;
  find("stop").disabled = Boolean(job?.stopping);
  document.body.classList.toggle("busy", Boolean(job));
  clearInterval(ticking);
  const words = job ? (job.stopping ? "Stopping" : job.what) : stopped ? "Stopped; nothing was changed." : moved;
  const activity = find("activity");
  if (activity.dataset.words !== words) {
    activity.dataset.words = words;
    activity.replaceChildren(make("span", {}, words), make("span", { class: "elapsed", "aria-hidden": "true" }));
    activity.dataset.since = performance.now();
  }
  if (!job) return;
  const tick = () => {
    const seconds = Math.round((performance.now() - Number(activity.dataset.since)) / 1000);
    activity.querySelector(".elapsed").textContent = ` ${seconds} s${reports.share()}`;
  };
  tick();
  ticking = setInterval(tick, 500);
}

const campaign = ({ campaigns }) => campaigns.find((one) => one.current);

// What was typed and chosen for one campaign says nothing about another.
function leave(other) {
  Object.assign(ui, { against: undefined, runs: undefined, typed: {} });
  moved = other ? `${other.files.map((file) => file.split("/").at(-1)).join(", ")} is kept, ${load.withModels(other)}: back to it under Load.` : "";
}

async function look() {
  const before = state;
  state = await read("/api/state");
  const began = state.job && state.job.number !== before?.job?.number;
  if (began) ui.step = SHOWN_BY[state.job.step];
  if (state.refused) refuse(state.refused);
  else if (before?.refused) refuse(undefined);
  if (began) moved = "";
  if (before && campaign(before)?.number !== campaign(state)?.number) {
    leave(campaign(before));
    // A campaign that is new leads on to training; after that the user leads.
    if (!state.models.length) ui.step = train;
  }
  draw();
}

function onLine(is) {
  document.body.classList.toggle("offline", !is);
  if (!is) refuse({ message: "The workbench has stopped.", help: "Start it again in the terminal:  tempco workbench" });
}

find("stop").addEventListener("click", () => context.act("stop"));
find("guide-open").addEventListener("click", () => guide.open(state, context));
load.acceptDrops(document.body, context, () => state);

try {
  effects = await read("/api/effects");
  await look();
  let looking = Promise.resolve();
  listen((event, data) => {
    if (event === "reports") reports.take(data, state);
    else looking = looking.then(look).catch(refuse);
  }, onLine);
} catch (refusal) {
  refuse(refusal);
}
