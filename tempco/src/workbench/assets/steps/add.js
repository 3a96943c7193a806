// Add: effects into the model and out of it, and the ladder of residuals down to the noise.

import { button, command, fixed, make, ug } from "../dom.js";
import { drawRungs, reports } from "../reports.js";

export const id = "add";
export const name = "Add";
export const title = "Add what is missing";

export function summary(_state, model) {
  const effects = model?.effect_titles ?? [];
  return {
    done: effects.length > 0,
    text: effects.length
      ? `${ug(model.comparison.residual_ug)} with ${effects.length === 1 ? "one effect" : `${effects.length} effects`}`
      : "",
  };
}

export function render(state, model, context) {
  if (!model) return [make("p", { class: "empty" }, "Train a model first.")];
  const working = state.job?.step === "add";
  const curves = make("div", { id: "curves", class: "curves", hidden: true });
  return [
    make("div", { class: "beside" }, ladder(state, model, working), curves),
    working ? command(state.job.command) : undefined,
    ...(working ? [] : [inModel(state, model, context), choice(state, model, context)]),
    working ? undefined : command(model.commands.made_by, "This model was made by"),
  ];
}

function ladder(state, model, working) {
  const list = make("ol", { class: "ladder tall", id: "rungs", "aria-label": "Held-out residual, effect by effect" });
  if (working) {
    const found = reports.rungs(state.job.number);
    drawRungs(list, found);
    return make("div", { class: "outcome" }, make("p", {}, "From the bare network up, one effect more on each rung."), list);
  }
  const noise = state.campaign.blind
    ? { effect: "noise alone, says the simulation", residual_ug: state.campaign.blind.noise_ug, tone: "quiet" }
    : { effect: "noise from sample to sample", residual_ug: model.comparison.noise_floor_ug, tone: "quiet" };
  const rungs = model.ladder.length ? model.ladder : [{ effect: "network alone", residual_ug: model.comparison.residual_ug }];
  drawRungs(list, [...rungs, ...(noise.residual_ug ? [noise] : [])]);
  const [first, last] = [rungs[0].residual_ug, rungs.at(-1).residual_ug];
  const fell =
    rungs.length > 1 &&
    make(
      "p",
      { class: "answer" },
      "The held-out residual fell from ",
      make("strong", {}, ug(first)),
      " to ",
      make("strong", {}, ug(last)),
      last < first ? `: ${fixed((1 - (last / first) ** 2) * 100, 0)} % of its power is gone.` : ".",
    );
  const doubts = model.doubts.map((doubt) => make("p", { class: "warning" }, doubt, "."));
  return make("div", { class: "outcome" }, fell, ...doubts, list);
}

function inModel(state, model, context) {
  if (!model.effects.length) return undefined;
  const parent = state.models.find((one) => one.number === model.parent);
  return make(
    "div",
    { class: "in-model" },
    make("h2", {}, "In the model"),
    make(
      "ul",
      { class: "plain" },
      model.effects.map((effect, k) => {
        const title = model.effect_titles[k];
        const request = effect.expression ? { expression: effect.expression } : { effect: effect.name };
        return make(
          "li",
          { class: "effect-row" },
          make("strong", {}, title),
          make(
            "span",
            { class: "note" },
            Object.entries(effect.parameters)
              .map(([key, value]) => `${key} = ${value.toPrecision(4)}`)
              .join(", "),
          ),
          button("Remove", {
            class: "button tiny quiet",
            id: `remove-${title}`,
            disabled: Boolean(state.job),
            onclick: () => context.act("remove", { model: model.number, ...request }),
          }),
        );
      }),
    ),
    parent &&
      button(`Undo: back to model ${parent.number}`, {
        id: "undo",
        class: "button quiet",
        onclick: () => context.choose.model(parent.number),
      }),
  );
}

function choice(state, model, context) {
  const { typed } = context.ui;
  const free = context.effects.effects.filter(
    (one) => one.on_device && !one.takes_expression && !model.effect_titles.includes(one.name),
  );
  const has = (channel) => !channel || state.campaign.channels.includes(channel);
  const chosen = [typed.effect, model.to_add].find((wanted) => free.some((one) => one.name === wanted)) ?? free[0]?.name;
  const select = make(
    "select",
    {
      id: "effect",
      onchange: ({ target }) => {
        typed.effect = target.value;
        context.redraw();
      },
    },
    free.map((one) =>
      make(
        "option",
        { value: one.name, selected: one.name === chosen, disabled: !has(one.channel) },
        has(one.channel) ? one.name : `${one.name} (no ${one.channel})`,
      ),
    ),
  );
  const about = free.find((one) => one.name === chosen);
  const expression = make("input", {
    id: "expression",
    type: "text",
    spellcheck: "false",
    placeholder: "supply_v * temperature_rate",
    value: typed.expression ?? "",
    oninput: ({ target }) => {
      typed.expression = target.value;
    },
  });
  const add = (request) => context.act("add", { model: model.number, ...request });
  return make(
    "div",
    { class: "choices" },
    make(
      "form",
      {
        class: "choice",
        onsubmit: (event) => {
          event.preventDefault();
          add({ effect: select.value });
        },
      },
      make("h2", {}, "An effect of the catalogue"),
      make(
        "div",
        { class: "actions" },
        make("label", { class: "field inline" }, make("span", { class: "visually-hidden" }, "Effect"), select),
        make("button", { class: "button primary", id: "add", disabled: Boolean(state.job) }, "Add"),
      ),
      about && make("p", {}, about.summary),
      about && make("p", { class: "equation" }, about.equation),
    ),
    make(
      "form",
      {
        class: "choice",
        onsubmit: (event) => {
          event.preventDefault();
          add({ expression: expression.value });
        },
      },
      make("h2", {}, "An effect of your own"),
      make(
        "div",
        { class: "actions" },
        make("label", { class: "field inline" }, make("span", { class: "visually-hidden" }, "Expression"), expression),
        make("button", { class: "button", id: "add-expression", disabled: Boolean(state.job) }, "Add"),
      ),
      make(
        "p",
        { class: "note" },
        "Of ",
        make("code", {}, context.effects.names.map(([key]) => key).join(" ")),
        ", ",
        make("code", {}, context.effects.functions.map((key) => `${key}(…)`).join(" ")),
        state.campaign.channels.length ? [" and the channels ", make("code", {}, state.campaign.channels.join(" "))] : "",
        ".",
      ),
    ),
  );
}
