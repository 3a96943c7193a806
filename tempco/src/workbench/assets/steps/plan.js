// Plan: the next recording, the one that tells best apart what is open.

import { button, command, fixed, make, table } from "../dom.js";

export const id = "plan";
export const name = "Plan";
export const title = "Plan the next recording";

const USEFUL = 8;

export function summary(_state, model) {
  const plan = model?.plan;
  return { done: Boolean(plan), text: plan ? (plan.file ? plan.proposals[0].recording : "no recording helps") : "" };
}

export function render(state, model, context) {
  if (!model) return [make("p", { class: "empty" }, "Train a model first.")];
  const { plan } = model;
  const { typed } = context.ui;
  const hours = make("input", {
    id: "hours",
    type: "number",
    min: 0,
    step: "any",
    placeholder: "any",
    value: typed.hours ?? "",
    oninput: ({ target }) => {
      typed.hours = target.value;
    },
  });
  const request = () => ({ model: model.number, hours: typed.hours ? Number(typed.hours) : null });
  return [
    make(
      "p",
      {},
      "Recordings of chamber and turntable are rehearsed, and ranked by how far they would move apart what the measurements so far leave open, per hour.",
    ),
    make(
      "div",
      { class: "actions" },
      button(plan ? "Plan again" : "Plan", {
        id: "plan",
        class: plan ? "button quiet" : "button primary",
        disabled: Boolean(state.job),
        onclick: () => context.act("plan", request()),
      }),
      make("label", { class: "field inline" }, "At most so many hours", hours),
    ),
    ...(plan ? answer(plan) : []),
    command(model.commands.plan),
  ];
}

function answer(plan) {
  const number = (text) => ({ number: text });
  const open = plan.hypotheses.map((one) => one.effect).join(", ");
  const why = {
    ambiguous: `${open}: this campaign can’t tell which.`,
    asked: `To be told apart: ${open}.`,
    unseen: `Nothing is ambiguous. This campaign could not show ${open}.`,
  }[plan.reason];
  const pair = (one) => `${one.from ? `${one.effect} | ${one.from}` : one.effect} ${fixed(one.sigma, 1)} σ`;
  const rows = plan.proposals.slice(0, USEFUL).map((one, k) => ({
    properties: { class: k === 0 && plan.file ? "current" : "" },
    cells: [
      one.recording,
      fixed(one.hours, 1),
      fixed(one.days, 1),
      fixed(one.sigma2_per_hour, 1),
      one.separations.map(pair).join(", "),
    ],
  }));
  return [
    make("p", { class: "answer" }, why),
    plan.file
      ? make("p", {}, "The best recording is written to ", make("code", {}, plan.file), ".")
      : make("p", {}, "No recording here tells them apart any better."),
    table("", ["recording", number("hours"), number("days"), number("σ² per hour"), "tells apart, or shows"], rows),
    make("details", { id: "plan-text" }, make("summary", {}, "As text"), make("pre", {}, plan.text)),
    plan.file ? command(plan.rehearse, "Rehearse it") : undefined,
  ];
}
