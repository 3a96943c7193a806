// Elements in one line each.

// make("p", { class: "note", onclick }, "text", child, …): properties that begin with `on` are listeners, absent children are left out.
export function make(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else made.setAttribute(key, value);
  }
  const shown = name === "pre" ? byLine : visible;
  const parts = children.flat(Infinity).filter((child) => child !== undefined && child !== null && child !== false);
  made.append(...parts.map((part) => (part instanceof Node ? part : shown(part))));
  return made;
}

// Foreign names are text, never HTML, and nothing in them is hidden or turned around.
export const { visible } = globalThis.charts;
const byLine = (text) => text.split("\n").map(visible).join("\n");

// A bar of so many parts of the whole; the width is set by script because the page allows no inline style.
export function bar(share, tone = "first") {
  const filled = make("span", { class: `bar-filled tone-${tone}` });
  filled.style.width = `${Math.max(0, Math.min(1, share)) * 100}%`;
  return make("span", { class: "bar", "aria-hidden": "true" }, filled);
}

// A table; cells that are numbers are set to the right.
const MOST_ROWS = 300;
export function table(caption, header, rows) {
  const cell = (kind) => (value) => {
    const figure = typeof value === "string" && /^(< )?[−+–]?[\d\u202f.]*( .{0,4})?$/.test(value);
    return make(kind, figure ? { class: "number" } : {}, value);
  };
  return make(
    "div",
    { class: "scroll" },
    make(
      "table",
      {},
      caption && make("caption", {}, caption),
      make(
        "thead",
        {},
        make(
          "tr",
          {},
          header.map((title) =>
            typeof title === "string"
              ? make("th", { scope: "col" }, title)
              : make("th", { scope: "col", class: "number" }, title.number),
          ),
        ),
      ),
      make(
        "tbody",
        {},
        rows
          .slice(0, MOST_ROWS)
          .map((row) =>
            make("tr", row.properties ?? {}, make("th", { scope: "row" }, row.cells[0]), row.cells.slice(1).map(cell("td"))),
          ),
      ),
      rows.length > MOST_ROWS &&
        make(
          "tfoot",
          {},
          make("tr", {}, make("td", { colspan: header.length }, `and ${rows.length - MOST_ROWS} more; the command prints all`)),
        ),
    ),
  );
}

export function button(text, properties = {}) {
  return make("button", { type: "button", class: "button", ...properties }, text);
}

// Numbers as people write them: grouped, with a true minus.
export const count = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
export function fixed(value, digits = 2) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const [whole, fraction] = Math.abs(value).toFixed(digits).split(".");
  const text = whole.length > 4 ? count(whole) : whole;
  const sign = value < 0 && Number(Math.abs(value).toFixed(digits)) !== 0 ? "\u2212" : "";
  return sign + (fraction ? `${text}.${fraction}` : text);
}
export const ug = (value, digits = value >= 1000 ? 0 : value >= 100 ? 1 : 2) => `${fixed(value, digits)} µg`;

// The command line that does the same, to be copied.
export function command(line, label = "The same on the command line") {
  if (!line) return undefined;
  const copy = button("Copy", {
    class: "button tiny quiet",
    "aria-label": `Copy: ${visible(line)}`,
    onclick: async () => {
      const copied = await navigator.clipboard?.writeText(line).then(
        () => true,
        () => false,
      );
      copy.textContent = copied ? "Copied" : "Not allowed";
      setTimeout(() => {
        copy.textContent = "Copy";
      }, 1500);
    },
  });
  return make("div", { class: "command" }, make("span", { class: "command-label" }, label), make("code", {}, line), copy);
}
