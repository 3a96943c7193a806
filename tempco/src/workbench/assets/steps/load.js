// Load: a campaign by dropping files, or one that is simulated.

import { uploadAll } from "../api.js";
import { button, command, count, fixed, make, table } from "../dom.js";

export const id = "load";
export const name = "Load";
export const title = "Load a campaign";

export function summary({ campaign }) {
  return { done: Boolean(campaign), text: campaign ? `${count(campaign.rows)} samples, ${campaign.runs.length} runs` : "" };
}

export function render(state, _model, context) {
  const { campaign } = state;
  return [drop(state, context), ...(campaign ? content(campaign) : []), others(state, context), practice(state, context)];
}

function drop(state, context) {
  const input = make("input", {
    type: "file",
    id: "files",
    multiple: true,
    accept: ".csv,.toml",
    class: "visually-hidden",
    disabled: Boolean(state.job),
    onchange: ({ target }) => send([...target.files], context, state),
  });
  const map = make("input", {
    type: "text",
    id: "map",
    placeholder: "delta_f_hz=FreqDiff, time_s=t_ms*0.001",
    value: context.ui.typed.map ?? "",
    spellcheck: "false",
    oninput: ({ target }) => {
      context.ui.typed.map = target.value;
    },
  });
  return make(
    "div",
    { class: "drop" },
    make(
      "p",
      {},
      make("strong", {}, "Drop CSV files here"),
      ", anywhere on the page, or ",
      make("label", { class: "button", for: "files" }, "choose files", input),
    ),
    make(
      "p",
      { class: "note" },
      "Units are in the column names: ",
      make("code", {}, "time_s, temperature_c, reference_g, delta_f_hz"),
      " or ",
      make("code", {}, "f1_hz, f2_hz"),
      "; ",
      make("code", {}, "run"),
      " and ",
      make("code", {}, "kind"),
      " name the recordings. A ",
      make("code", {}, "campaign.toml"),
      " that is dropped together with them says how to read them, and nothing about other files.",
    ),
    make(
      "details",
      { id: "mapping", open: Boolean(context.ui.typed.map) },
      make("summary", {}, "The columns have other names"),
      make("label", { class: "field" }, "Ours = theirs, separated by commas", map),
    ),
  );
}

function content(campaign) {
  const runs = campaign.runs.map((run) => ({
    cells: [
      run.run,
      run.kind,
      count(run.samples),
      fixed(run.interval_s, 1),
      fixed(run.hours, 1),
      fixed(run.from_c, 1),
      fixed(run.to_c, 1),
      String(run.levels),
    ],
  }));
  const number = (text) => ({ number: text });
  return [
    make(
      "p",
      {},
      make("strong", {}, campaign.files.join(", ")),
      `: ${count(campaign.rows)} samples in ${campaign.runs.length} runs`,
      campaign.channels.length ? `, with ${campaign.channels.join(", ")}.` : ".",
    ),
    campaign.mappings.length
      ? make("p", { class: "note", id: "mappings" }, "Read as ", make("code", {}, campaign.mappings.join(", ")), " says.")
      : undefined,
    campaign.ignored_columns.length
      ? make("p", { class: "note" }, `Left unread: ${campaign.ignored_columns.join(", ")}.`)
      : undefined,
    make(
      "div",
      { class: "scroll tall", id: "runs-table", tabindex: "0", role: "region", "aria-label": "Runs of the campaign" },
      table(
        "",
        [
          "run",
          "kind",
          number("samples"),
          number("every s"),
          number("hours"),
          number("from °C"),
          number("to °C"),
          number("levels"),
        ],
        runs,
      ),
    ),
    command(campaign.made_by, "Made by"),
    command(campaign.command),
  ];
}

export const withModels = ({ models }) =>
  models.length > 1
    ? `with its models ${models.join(", ")}`
    : models.length
      ? `with its model ${models[0]}`
      : "without a model so far";

// Nothing is lost by loading something else.
function others(state, context) {
  const found = state.campaigns.filter((one) => !one.current);
  if (!found.length) return undefined;
  return make(
    "div",
    { class: "aside", id: "campaigns" },
    make("h2", {}, "Other campaigns of this session"),
    make(
      "ul",
      { class: "plain" },
      found.map((one) =>
        make(
          "li",
          { class: "effect-row" },
          make("strong", {}, one.files.join(", ")),
          make("span", { class: "note" }, `${count(one.rows)} samples, ${withModels(one)}`),
          button("Back to it", {
            class: "button tiny quiet",
            id: `campaign-${one.number}`,
            disabled: Boolean(state.job),
            onclick: () => context.act("campaign", { campaign: one.number }),
          }),
        ),
      ),
    ),
  );
}

function practice(state, context) {
  return make(
    "div",
    { class: "aside" },
    make(
      "p",
      {},
      make("strong", {}, "No measurements at hand?"),
      " A simulated sensor is put through chamber and turntable. One physical effect is hidden in it, and sealed in an envelope until you open it.",
    ),
    button("Simulate a campaign with a hidden effect", {
      id: "practice",
      disabled: Boolean(state.job),
      onclick: () => context.act("demo", {}),
    }),
  );
}

export function acceptDrops(target, context, state) {
  let depth = 0;
  const over = (by) => {
    depth += by;
    target.classList.toggle("dropping", depth > 0);
  };
  target.addEventListener("dragenter", () => over(1));
  target.addEventListener("dragleave", () => over(-1));
  target.addEventListener("dragover", (event) => event.preventDefault());
  target.addEventListener("drop", (event) => {
    event.preventDefault();
    over(-depth);
    const folder = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()).find((entry) => entry?.isDirectory);
    if (folder) context.refuse({ message: `${folder.name} is a folder.`, help: "Drop the files in it, all at once." });
    else send([...event.dataTransfer.files], context, state());
  });
}

async function send(files, context, state) {
  if (!files.length) return;
  if (state?.job) {
    context.refuse({ message: "Something else is at work.", help: "Wait for it, or stop it, and drop the files again." });
    return;
  }
  context.refuse(undefined);
  let upload;
  try {
    upload = await uploadAll(files);
  } catch (refusal) {
    context.refuse(refusal);
    return;
  }
  const map = (context.ui.typed.map ?? "")
    .split(",")
    .map((pair) => pair.trim())
    .filter(Boolean);
  await context.act("load", { upload, files: files.map((file) => file.name), map });
}
