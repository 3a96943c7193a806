// A first visit in five minutes: the guide says what to do next and why, waits until it is done, and can be sent away.

import { button, make, ug } from "./dom.js";
import * as add from "./steps/add.js";
import * as compare from "./steps/compare.js";
import * as diagnose from "./steps/diagnose.js";
import * as exported from "./steps/export.js";
import * as train from "./steps/train.js";
import * as verify from "./steps/verify.js";

const KEY = "tempco-guide";
const current = (state) => state.models.find((one) => one.number === state.current);
const cured = (state) => state.models.find((one) => one.effects.length);
const diagnosed = (state) => state.models.some((one) => one.diagnosis);
let brushes = 0;
document.addEventListener("brushed", () => {
  brushes += 1;
});

// at: the step it belongs to; mark: what to press; done: whether it was; without `done` one goes on by hand.
const STOPS = [
  {
    title: "A sensor with a secret",
    done: (state) => state.models.length > 0,
    text: () => [
      "A simulated accelerometer went through chamber and turntable. One physical effect is hidden in its measurements, and the truth is sealed in an envelope. Find it: it takes about five minutes.",
    ],
  },
  {
    title: "Train a model",
    at: train,
    mark: "train",
    done: (state) => state.models.length > 0,
    text: () => [
      "Thirty trainings begin at random, each a thin line. The ticked runs are held out: no training ever sees them, so they can judge.",
    ],
  },
  {
    title: "See where it fails",
    mark: "linked",
    done: (state) => brushes > 0 || diagnosed(state),
    text: (state) => [
      `The network leaves ${ug(current(state)?.comparison.residual_ug ?? 0)}; noise alone would leave ${ug(state.campaign.blind.noise_ug)}. Drag over the samples that lie highest or lowest in one of the plots below, and watch where they are in the others: do they follow the temperature, its rate, the time?`,
    ],
  },
  {
    title: "Ask why",
    at: diagnose,
    mark: "diagnose",
    done: diagnosed,
    text: () => [
      "Twenty known effects are tried against what is left. The answer says how sure it is, what else would explain the same, and what these measurements can’t show.",
    ],
  },
  {
    title: "Add it",
    at: diagnose,
    mark: "add-effect",
    done: cured,
    text: (state) => {
      const effect = state.models.find((one) => one.to_add)?.to_add;
      return effect
        ? [
            `One click puts ${effect} beside the network and trains both together, from the bare network up. Watch the ladder fall.`,
          ]
        : ["Nothing was found that an instrument can take out. Look at what remains, and go on."];
    },
  },
  {
    title: "Compare both",
    at: compare,
    mark: "linked-against",
    done: (state, { ui }) => ui.against !== undefined || cured(state)?.exported,
    text: () => [
      "Choose the other model beside “with” above the plots: both residuals are drawn over each other. What was a pattern should now be noise.",
    ],
  },
  {
    title: "Export it",
    at: exported,
    mark: "export",
    done: (state) => cured(state)?.exported,
    text: () => ["The calibration becomes a few hundred bytes for the microcontroller’s flash."],
  },
  {
    title: "Verify it",
    at: verify,
    mark: "verify",
    done: (state) => cured(state)?.parity,
    text: () => [
      "The firmware’s own code reads the whole campaign with this calibration. Every reading must have this computer’s bits.",
    ],
  },
  {
    title: "Open the seal",
    at: diagnose,
    mark: "reveal",
    done: (state) => state.campaign.blind.revealed,
    text: () => ["You have made up your mind. Open the envelope."],
  },
  {
    title: "That was the whole path",
    text: (state) => [
      state.campaign.blind.revealed?.judgement ?? "",
      " Now drop a campaign of your own on the page, or practise on another hidden effect with ",
      make("code", {}, "tempco workbench --demo --seed 19"),
      ".",
    ],
  },
];

const panel = document.getElementById("guide");
let stop = 0;
let arrived = 0;
let away = localStorage.getItem(KEY) === "away";

export const guide = { update, open };

function open(state, context) {
  [away, stop] = [false, 0];
  localStorage.removeItem(KEY);
  update(state, context);
  panel.querySelector("button")?.focus();
}

function close() {
  away = true;
  localStorage.setItem(KEY, "away");
  panel.hidden = true;
  for (const marked of document.querySelectorAll(".marked")) marked.classList.remove("marked");
  document.getElementById("guide-open").focus();
}

function update(state, context) {
  const blind = state.campaign?.blind;
  document.getElementById("guide-open").hidden = !blind;
  panel.hidden = away || !blind;
  if (panel.hidden) return;
  while (STOPS[stop].done?.(state, context) && !state.job && stop < STOPS.length - 1) stop += 1;
  draw(state, context);
}

function draw(state, context) {
  const { title, text, at, mark, done } = STOPS[stop];
  const focused = panel.contains(document.activeElement) ? document.activeElement.id : "";
  const further = () => {
    stop = Math.min(STOPS.length - 1, stop + 1);
    const next = STOPS[stop].at;
    if (next && next !== context.ui.step) context.go(next);
    else context.redraw();
    document.getElementById("guide-next")?.focus();
  };
  const there =
    at &&
    context.ui.step !== at &&
    !state.job &&
    button(`Go to ${at.name}`, { id: "guide-go", class: "button", onclick: () => context.go(at) });
  const last = stop === STOPS.length - 1;
  panel.replaceChildren(
    make(
      "div",
      { class: "guide-head" },
      make("p", { class: "guide-count" }, `${stop + 1} of ${STOPS.length}`),
      button("Dismiss", { id: "guide-close", class: "button tiny quiet", onclick: close }),
    ),
    make("h2", {}, title),
    make("p", {}, text(state)),
    make(
      "div",
      { class: "actions" },
      there,
      last
        ? button("Close", { id: "guide-next", class: "button", onclick: close })
        : button(stop ? "Skip" : "Begin", {
            id: "guide-next",
            class: stop ? "button quiet" : "button primary",
            onclick: further,
          }),
    ),
  );
  if (focused) document.getElementById(focused)?.focus();
  for (const marked of document.querySelectorAll(".marked")) marked.classList.remove("marked");
  const target = mark === "add-effect" ? document.querySelector("[id^=add-]") : document.getElementById(mark);
  if (!state.job) target?.classList.add("marked");
  if (target && arrived !== stop && !state.job) {
    arrived = stop;
    target.scrollIntoView({ block: target.clientHeight > innerHeight / 2 ? "start" : "nearest" });
  }
}
