// Verify: the instrument's bits against this computer's.

import { bar, button, command, count, make } from "../dom.js";

export const id = "verify";
export const name = "Verify";
export const title = "Verify on the virtual instrument";

export function summary(_state, model) {
  const parity = model?.parity;
  if (!parity) return { done: false };
  return {
    done: true,
    text: parity.identical === parity.samples ? "identical in every bit" : `${count(parity.samples - parity.identical)} differ`,
  };
}

export function render(state, model, context) {
  if (!model) return [make("p", { class: "empty" }, "Train a model first.")];
  const { parity } = model;
  const all = parity && parity.identical === parity.samples;
  return [
    make(
      "p",
      {},
      "The firmware’s own code, with register-level models of its drivers, gets this calibration over its own wire and reads every sample of the campaign. Each reading must have the bits that this computer computed.",
    ),
    make(
      "div",
      { class: "actions" },
      button(parity ? "Verify again" : "Verify", {
        id: "verify",
        class: parity ? "button quiet" : "button primary",
        disabled: Boolean(state.job),
        onclick: () => context.act("verify", { model: model.number }),
      }),
    ),
    parity &&
      make(
        "div",
        { class: `verdict ${all ? "nothing-missing" : "missing"}` },
        make("h2", {}, `${count(parity.identical)} of ${count(parity.samples)} readings identical in every bit`),
        bar(parity.identical / parity.samples, "third"),
        parity.first_difference && make("p", {}, `First difference: ${parity.first_difference}`),
      ),
    command(model.commands.verify),
  ];
}
