// A scatter of many samples on a canvas, written pixel by pixel: twenty thousand marks in seven plots follow a brush.
// Two layers: all samples, and above them those that are chosen. Axes and brush are SVG, so that they stay sharp.

import { make } from "./dom.js";

// Written by the processor, pixel by pixel: a graphics card would only copy them back and forth.
const WRITTEN = { willReadFrequently: true };
const { element, scale } = globalThis.charts;
const ROOM = { left: 52, right: 10, top: 14, bottom: 34 };
const FAINT = 0.5;
const LEAST_BAND = 4;

// axis: { column, title, unit, log, height }
export class Scatter {
  constructor(axis, onBrush) {
    this.axis = axis;
    this.onBrush = onBrush;
    this.base = make("canvas", { class: "layer base" });
    this.lit = make("canvas", { class: "layer lit" });
    this.svg = element("svg", { class: "plot", "aria-hidden": "true" });
    this.box = make(
      "div",
      {
        class: "scatter",
        tabindex: "0",
        role: "group",
        "aria-label": `Residual against ${axis.title}`,
        "aria-describedby": "brush-help",
        "data-column": axis.column,
      },
      this.base,
      this.lit,
      this.svg,
    );
    this.figure = make("figure", { class: axis.wide ? "wide" : "" }, make("h3", {}, axis.title), this.box);
    this.#listen();
    new ResizeObserver(() => this.layout()).observe(this.box);
  }

  // xs: the column; series: [{ ys, classes }] from the bottom up; bands: runs to shade, in the column's unit.
  show({ xs, series, yRange, palette, bands = [] }) {
    Object.assign(this, { xs, series, yRange, palette, bands });
    this.xRange = range(xs, this.axis.log);
    this.figure.hidden = !this.xRange;
    this.layout();
  }

  // Places everything anew: another size, other data, other colours.
  layout() {
    const width = this.box.clientWidth;
    const height = this.box.clientHeight;
    if (!this.xs || !this.xRange || width < 80) return;
    const inner = { left: ROOM.left, right: width - ROOM.right, top: ROOM.top, bottom: height - ROOM.bottom };
    const kind = this.axis.log ? "log" : "linear";
    this.inner = inner;
    this.x = scale({ scale: kind, range: this.xRange }, [inner.left, inner.right]);
    this.y = scale({ scale: "linear", range: this.yRange }, [inner.bottom, inner.top]);
    this.dense = Math.min(3, globalThis.devicePixelRatio || 1);
    for (const canvas of [this.base, this.lit]) {
      canvas.width = Math.round((inner.right - inner.left) * this.dense);
      canvas.height = Math.round((inner.bottom - inner.top) * this.dense);
    }
    this.size = Math.max(2, Math.round(1.7 * this.dense));
    const image = new ImageData(Math.max(1, this.lit.width), Math.max(1, this.lit.height));
    // One word a pixel, in this order of bytes on every machine that runs a browser.
    this.stamped = { image, words: new Uint32Array(image.data.buffer) };
    this.#place();
    this.#axes(width, height);
    this.#paint(this.base, FAINT);
    this.light(this.rows);
    this.#drawBrush();
  }

  // Shows the chosen samples in full, and the others faintly. `rows` are the places of the chosen ones.
  light(rows) {
    this.rows = rows;
    this.box.classList.toggle("dimmed", Boolean(rows));
    if (this.inner) this.#stamp(rows ?? []);
  }

  setBrush(brush) {
    this.brush = brush;
    this.#drawBrush();
  }

  // Pixels of every sample, once; a brush then only chooses among them.
  #place() {
    const { xs, x, y, dense, inner } = this;
    const least = this.xRange[0];
    this.px = new Int32Array(xs.length);
    for (let k = 0; k < xs.length; k += 1) {
      this.px[k] = Number.isNaN(xs[k])
        ? -9
        : Math.round((x.at(this.axis.log ? Math.max(least, xs[k]) : xs[k]) - inner.left) * dense);
    }
    this.py = this.series.map(({ ys }) => {
      const py = new Int32Array(ys.length);
      for (let k = 0; k < ys.length; k += 1) py[k] = Math.round((y.at(ys[k]) - inner.top) * dense);
      return py;
    });
  }

  // All samples, one laid over the other, so that it is darker where they are many.
  #paint(canvas, strength) {
    const { width, height } = canvas;
    if (!width || !height) return;
    const context = canvas.getContext("2d", WRITTEN);
    const image = context.createImageData(width, height);
    this.series.forEach(({ classes }, which) => {
      const py = this.py[which];
      for (let k = 0; k < py.length; k += 1) dot(image, this.px[k], py[k], this.size, this.palette[classes[k]], strength);
    });
    context.putImageData(image, 0, 0);
  }

  // The chosen ones, in full colour: whole pixels are written, for a brush moves with the hand.
  #stamp(rows) {
    const { width, height } = this.lit;
    if (!width || !height) return;
    const { words, image } = this.stamped;
    words.fill(0);
    const colours = this.palette.map(([red, green, blue]) => (255 << 24) | (blue << 16) | (green << 8) | red);
    const half = this.size >> 1;
    this.series.forEach(({ classes }, which) => {
      const py = this.py[which];
      for (const k of rows) {
        const colour = colours[classes[k]];
        const [left, top] = [Math.max(0, this.px[k] - half), Math.max(0, py[k] - half)];
        const [right, bottom] = [Math.min(width, this.px[k] - half + this.size), Math.min(height, py[k] - half + this.size)];
        for (let y = top; y < bottom; y += 1) {
          for (let x = left; x < right; x += 1) words[y * width + x] = colour;
        }
      }
    });
    this.lit.getContext("2d", WRITTEN).putImageData(image, 0, 0);
  }

  #axes(width, height) {
    const { x, y, inner, svg } = this;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const grid = element("g", { class: "grid" });
    // Borders that stand closer than this would only darken the plot.
    const bordered = this.bands.length * LEAST_BAND < inner.right - inner.left;
    for (const { from, to, name, held } of this.bands) {
      const [left, right] = [x.at(from), x.at(to)];
      if (held)
        grid.append(
          element("rect", {
            class: "held",
            x: left,
            width: Math.max(0.5, right - left),
            y: inner.top,
            height: inner.bottom - inner.top,
          }),
        );
      if (bordered) grid.append(element("line", { class: "border", x1: left, x2: left, y1: inner.top, y2: inner.bottom }));
      if (right - left > 7 * name.length)
        grid.append(element("text", { class: "run", x: (left + right) / 2, y: inner.top + 11, "text-anchor": "middle" }, name));
    }
    const sparse = (ticks, room) => ticks.filter((_, k) => ticks.length * room < inner.right - inner.left || k % 2 === 0);
    for (const { value, text } of sparse(x.ticks, 34)) {
      grid.append(
        element("line", { x1: x.at(value), x2: x.at(value), y1: inner.bottom, y2: inner.bottom + 4 }),
        element("text", { x: x.at(value), y: inner.bottom + 16, "text-anchor": "middle" }, text),
      );
    }
    // Twice as many ticks as a chart of this height would have: these are low.
    for (const { value, text } of scale({ scale: "linear", range: this.yRange }, [0, 2 * (inner.bottom - inner.top)]).ticks) {
      grid.append(
        element("line", {
          x1: inner.left,
          x2: inner.right,
          y1: y.at(value),
          y2: y.at(value),
          class: value === 0 ? "zero" : "",
        }),
        element("text", { x: inner.left - 6, y: y.at(value) + 4, "text-anchor": "end" }, text),
      );
    }
    this.brushed = element("rect", { class: "selection", visibility: "hidden" });
    svg.replaceChildren(
      grid,
      this.brushed,
      element("text", { class: "unit", x: inner.right, y: height - 4, "text-anchor": "end" }, this.axis.unit),
      element("text", { class: "unit", x: inner.left - 6, y: inner.top - 4, "text-anchor": "end" }, "µg"),
    );
    for (const canvas of [this.base, this.lit]) {
      Object.assign(canvas.style, {
        left: `${inner.left}px`,
        top: `${inner.top}px`,
        width: `${inner.right - inner.left}px`,
        height: `${inner.bottom - inner.top}px`,
      });
    }
  }

  #drawBrush() {
    if (!this.brushed) return;
    this.brushed.setAttribute("visibility", this.brush ? "visible" : "hidden");
    if (!this.brush) return;
    const [left, right] = this.brush.x.map(this.x.at);
    const [bottom, top] = this.brush.y.map(this.y.at);
    const box = { x: left, y: top, width: right - left, height: bottom - top };
    for (const [key, value] of Object.entries(box)) this.brushed.setAttribute(key, value);
  }

  #listen() {
    let from;
    const place = (event) => {
      const bounds = this.box.getBoundingClientRect();
      const within = (value, low, high) => Math.min(high, Math.max(low, value));
      return [
        within(event.clientX - bounds.left, this.inner.left, this.inner.right),
        within(event.clientY - bounds.top, this.inner.top, this.inner.bottom),
      ];
    };
    this.box.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || !this.inner) return;
      from = place(event);
      this.box.setPointerCapture(event.pointerId);
    });
    this.box.addEventListener("pointermove", (event) => {
      if (!from) return;
      const to = place(event);
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 3) return;
      this.#brushed([from[0], to[0]], [from[1], to[1]], event.timeStamp);
    });
    const end = (event) => {
      if (from && event.type === "pointerup") {
        const to = place(event);
        if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 3) this.onBrush(this, undefined, event.timeStamp);
      }
      from = undefined;
    };
    this.box.addEventListener("pointerup", end);
    this.box.addEventListener("pointercancel", end);
    this.box.addEventListener("keydown", (event) => this.#keys(event));
  }

  #brushed(xs, ys, since) {
    const [left, right] = xs.toSorted((a, b) => a - b);
    const [top, bottom] = ys.toSorted((a, b) => a - b);
    const brush = { x: [this.x.value(left), this.x.value(right)], y: [this.y.value(bottom), this.y.value(top)] };
    this.onBrush(this, brush, since);
  }

  // Enter begins in the middle; arrows move, with Shift they widen and narrow; Escape ends.
  #keys(event) {
    if (!this.inner) return;
    const { left, right, top, bottom } = this.inner;
    const step = (right - left) / 40;
    let [low, high] = this.brush ? this.brush.x.map(this.x.at) : [(left + right) / 2 - step, (left + right) / 2 + step];
    if (event.key === "Escape") {
      this.onBrush(this, undefined, event.timeStamp);
      return;
    }
    if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
      if (!this.brush) return;
      const towards = event.key === "ArrowRight" ? step : -step;
      if (event.shiftKey) high = Math.max(low + step, high + towards);
      else [low, high] = [low + towards, high + towards];
    } else if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    const within = (value) => Math.min(right, Math.max(left, value));
    this.#brushed([within(low), within(high)], [top, bottom], event.timeStamp);
  }
}

// From the least to the greatest with a little room; nothing where nothing was measured or nothing varies.
function range(values, log) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!(high > low)) return undefined;
  if (log) return [Math.max(low, high * 1e-4, 0.1), high * 1.05];
  const room = (high - low) * 0.03;
  return [low - room, high + room];
}

// A square of so many pixels, laid over what is there.
function dot(image, x, y, size, [red, green, blue], strength) {
  const { data, width, height } = image;
  const half = size >> 1;
  for (let row = y - half; row < y - half + size; row += 1) {
    if (row < 0 || row >= height) continue;
    for (let column = x - half; column < x - half + size; column += 1) {
      if (column < 0 || column >= width) continue;
      const at = (row * width + column) * 4;
      const below = data[at + 3] / 255;
      const alpha = strength + below * (1 - strength);
      const share = strength / alpha;
      data[at] = red * share + data[at] * (1 - share);
      data[at + 1] = green * share + data[at + 1] * (1 - share);
      data[at + 2] = blue * share + data[at + 2] * (1 - share);
      data[at + 3] = alpha * 255;
    }
  }
}
