// Marks: each layer of a chart as SVG elements. A layer of dots is one path, however many they are:
// a page of twenty charts stays as quick as a page of one, and prints as lines.
"use strict";

globalThis.charts = globalThis.charts ?? {};

(() => {
  const SVG = "http://www.w3.org/2000/svg";

  function element(name, attributes = {}, ...children) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children.map((child) => (typeof child === "string" ? globalThis.charts.visible(child) : child)));
    return made;
  }

  // The shape says what the colour says, for whoever sees no colours. `r` is half its width.
  const SHAPES = {
    quiet: (x, y) => `M${x} ${y}h0`,
    first: (x, y) => `M${x} ${y}h0`,
    second: (x, y, r) => `M${x - r} ${y - r}l${2 * r} ${2 * r}m0-${2 * r}l-${2 * r} ${2 * r}`,
    third: (x, y, r) => `M${x - r} ${y + r}l${r}-${2 * r}l${r} ${2 * r}z`,
    fourth: (x, y, r) => `M${x - r} ${y - r}h${2 * r}v${2 * r}h-${2 * r}z`,
    fifth: (x, y, r) => `M${x - r} ${y}l${r}-${r}l${r} ${r}l-${r} ${r}z`,
    sixth: (x, y, r) => `M${x - r} ${y}h${2 * r}m-${r}-${r}v${2 * r}`,
  };
  const RADIUS = 2;
  // The fewer marks, the larger: up to how many, and how much.
  const SIZES = [{ most: 60, name: " few", times: 2 }, { most: 900, name: " some", times: 1.3 }];

  const pixel = (value) => Math.round(value * 10) / 10;
  const classes = (layer) => `mark ${layer.mark} tone-${layer.tone ?? "ink"}`;

  function joined(xs, ys, { x, y }) {
    return xs.map((place, k) => `${k ? "L" : "M"}${pixel(x.at(place))} ${pixel(y.at(ys[k]))}`).join("");
  }

  const MARKS = {
    dots(layer, { x, y }) {
      const { name, times } = SIZES.find(({ most }) => layer.x.length <= most) ?? { name: "", times: 1 };
      const at = (place, k) => shape(layer.tone, pixel(x.at(place)), pixel(y.at(layer.y[k])), times * RADIUS);
      return element("path", { class: classes(layer) + name, d: layer.x.map(at).join("") });
    },

    line(layer, frame) {
      const dash = layer.dashed ? " dashed" : "";
      return element("path", { class: classes(layer) + dash, d: joined(layer.x, layer.y, frame) });
    },

    band(layer, frame) {
      const back = joined([...layer.x].reverse(), [...layer.low].reverse(), frame).replace("M", "L");
      return element("path", { class: classes(layer), d: `${joined(layer.x, layer.high, frame)}${back}z` });
    },

    outline(layer, { x, y }) {
      const [left, right] = layer.x.map(x.at);
      const [bottom, top] = layer.y.map(y.at);
      const box = { x: pixel(left), y: pixel(top), width: pixel(right - left), height: pixel(bottom - top) };
      return element("rect", { class: classes(layer), ...box });
    },

    rule(layer, { x, y, box }) {
      const across = layer.axis === "x";
      const at = pixel((across ? x : y).at(layer.at));
      const ends = across ? { x1: at, x2: at, y1: box.top, y2: box.bottom } : { x1: box.left, x2: box.right, y1: at, y2: at };
      const place = across ? { x: at + 4, y: box.top + 12 } : { x: box.right - 4, y: at - 4, "text-anchor": "end" };
      return element("g", { class: classes(layer) }, element("line", ends), element("text", place, layer.name));
    },

    map(layer, frame) {
      const columns = layer.x_edges.length - 1;
      const group = element("g", { class: classes(layer) });
      layer.values.forEach((value, k) => {
        if (value !== null) group.append(...cell(layer, frame, k % columns, Math.floor(k / columns), value));
      });
      return group;
    },
  };

  // Blue below zero and orange above, on whatever ground the page has; the number where there is room.
  function cell(layer, { x, y }, column, row, value) {
    const [left, right] = [x.at(layer.x_edges[column]), x.at(layer.x_edges[column + 1])];
    const [bottom, top] = [y.at(layer.y_edges[row]), y.at(layer.y_edges[row + 1])];
    const strength = Math.min(1, Math.abs(value) / layer.limit);
    const box = { x: pixel(left), y: pixel(top), width: pixel(right - left) + 0.3, height: pixel(bottom - top) + 0.3 };
    const colour = { class: value < 0 ? "below" : "above", "fill-opacity": pixel(strength * 100) / 100 };
    const parts = [element("rect", { ...box, ...colour })];
    if (right - left > 30 && bottom - top > 13) {
      const place = { x: pixel((left + right) / 2), y: pixel((top + bottom) / 2 + 3.5) };
      parts.push(element("text", { ...place, class: strength > 0.6 ? "strong" : "weak" }, short(value, layer.limit)));
    }
    return parts;
  }

  function short(value, limit) {
    const digits = Math.max(0, 1 - Math.floor(Math.log10(limit)));
    const text = Math.abs(value).toFixed(Math.min(digits, 3));
    return value < 0 && Number(text) !== 0 ? `\u2212${text}` : text;
  }

  const mark = (layer, frame) => MARKS[layer.mark](layer, frame);
  const shape = (tone, x, y, r = RADIUS) => SHAPES[tone](x, y, r);

  Object.assign(globalThis.charts, { element, mark, shape });
})();
