// Export: the calibration as the device stores it.

import { save } from "../api.js";
import { button, command, make } from "../dom.js";

export const id = "export";
export const name = "Export";
export const title = "Export the calibration";

export function summary(_state, model) {
  return { done: Boolean(model?.exported), text: model?.exported ? `${model.exported.bytes} bytes` : "" };
}

export function render(_state, model, context) {
  if (!model) return [make("p", { class: "empty" }, "Train a model first.")];
  const { exported } = model;
  const download = (format, text) =>
    button(text, {
      id: `download-${format}`,
      onclick: () => save(`/api/download?model=${model.number}&format=${format}`).catch(context.refuse),
    });
  return [
    make(
      "p",
      {},
      "Model and effects become one small block of bytes with a checksum. The microcontroller refuses it if a single bit is wrong, or if its arithmetic gave other bits than this computer’s.",
    ),
    make(
      "div",
      { class: "actions" },
      button(exported ? "Export again" : "Export", {
        id: "export",
        class: exported ? "button quiet" : "button primary",
        onclick: () => context.act("export", { model: model.number }),
      }),
    ),
    exported &&
      make(
        "p",
        { class: "answer" },
        make("strong", {}, `${exported.bytes} bytes`),
        `, ${exported.address}, written to `,
        make("code", {}, exported.hex),
        " and ",
        make("code", {}, exported.bin),
        ".",
      ),
    exported &&
      make(
        "div",
        { class: "actions" },
        download("hex", "Download Intel HEX"),
        download("bin", "Download the bare blob"),
        download("toml", "Download the model file"),
      ),
    command(model.commands.export),
  ];
}
