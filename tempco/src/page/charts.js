// Charts: draws one description (trainer's `Chart`, as JSON) into an element of the page.
//
//   const drawn = charts.draw(element, chart, { runs, width, height });
//
// `runs` names the runs that the dots refer to. What was in the element is replaced. `drawn` is
// { svg, x, y, box, chart }: the two scales and the plot's box, for whoever adds something.
"use strict";

globalThis.charts = globalThis.charts ?? {};

(() => {
  const { element, mark, shape, scale } = globalThis.charts;
  const SIZE = { width: 620, height: 330 };
  const ROOM = { left: 76, right: 14, top: 10, bottom: 44 };
  let count = 0;

  function draw(target, chart, options = {}) {
    const size = { ...SIZE, ...options };
    const box = {
      left: ROOM.left, right: size.width - ROOM.right, top: ROOM.top, bottom: size.height - ROOM.bottom,
    };
    const frame = {
      chart, box,
      x: scale(chart.x, [box.left, box.right]),
      y: scale(chart.y, [box.bottom, box.top]),
    };
    const clip = `clip-${(count += 1)}`;
    const svg = element("svg", {
      class: "plot", viewBox: `0 0 ${size.width} ${size.height}`, role: "img", tabindex: "0", "aria-label": spoken(chart),
    });
    const marks = element("g", { "clip-path": `url(#${clip})` }, ...chart.layers.map((layer) => mark(layer, frame)));
    svg.append(
      element("clipPath", { id: clip }, rectangle(box, {})),
      grid(frame), marks, rectangle(box, { class: "frame" }), names(frame),
    );
    target.replaceChildren(svg, legend(chart));
    const drawn = { ...frame, svg, target, options };
    globalThis.charts.readout?.(drawn);
    return drawn;
  }

  function rectangle({ left, right, top, bottom }, attributes) {
    return element("rect", { x: left, y: top, width: right - left, height: bottom - top, ...attributes });
  }

  function grid({ chart, x, y, box }) {
    const mapped = chart.layers.some((layer) => layer.mark === "map");
    const group = element("g", { class: "grid" });
    for (const { value, text } of x.ticks) {
      const at = x.at(value);
      group.append(
        element("line", { x1: at, x2: at, y1: box.top, y2: box.bottom }),
        element("text", { x: at, y: box.bottom + 16, "text-anchor": "middle" }, text),
      );
    }
    for (const { value, text } of y.ticks) {
      const at = y.at(value);
      group.append(
        element("line", { x1: box.left, x2: box.right, y1: at, y2: at, class: value === 0 && !mapped ? "zero" : "" }),
        element("text", { x: box.left - 6, y: at + 4, "text-anchor": "end" }, text),
      );
    }
    return group;
  }

  const titled = ({ label, unit }) => (unit ? `${label}, ${unit}` : label);

  function names({ chart, box }) {
    const middle = (box.top + box.bottom) / 2;
    return element("g", { class: "names" },
      element("text", { x: (box.left + box.right) / 2, y: box.bottom + 36, "text-anchor": "middle" }, titled(chart.x)),
      element("text", { transform: `translate(13 ${middle}) rotate(-90)`, "text-anchor": "middle" }, titled(chart.y)));
  }

  // What a screen reader says instead of the picture.
  function spoken(chart) {
    const layers = chart.layers.filter((layer) => layer.name).map(({ name, x, mark: kind }) =>
      (kind === "dots" ? `${name} (${x.length} marks)` : name));
    return `${chart.title}. ${titled(chart.y)} over ${titled(chart.x)}. Shown: ${layers.join("; ")}. ${chart.caption}`;
  }

  // In the page's own text, so that it wraps, scales and is read aloud.
  function legend(chart) {
    const list = document.createElement("ul");
    list.className = "legend";
    list.setAttribute("aria-hidden", "true");
    for (const layer of chart.layers) {
      if (layer.mark === "map") list.append(...key(layer));
      else if (layer.mark !== "rule" && layer.name) list.append(entry(layer));
    }
    return list;
  }

  function entry(layer) {
    const item = document.createElement("li");
    const swatch = element("svg", { class: "swatch", viewBox: "0 0 22 12" });
    const kind = `mark ${layer.mark} tone-${layer.tone ?? "ink"}${layer.dashed ? " dashed" : ""}`;
    const pictures = {
      dots: () => element("path", { class: kind, d: [5, 11, 17].map((x) => shape(layer.tone, x, 6)).join("") }),
      line: () => element("path", { class: kind, d: "M1 6h20" }),
      band: () => element("path", { class: kind, d: "M1 2h20v8h-20z" }),
      outline: () => element("rect", { class: kind, x: 2, y: 2, width: 18, height: 8 }),
    };
    swatch.append(pictures[layer.mark]());
    item.append(swatch, globalThis.charts.visible(layer.name));
    return item;
  }

  // The colours of a map, from the most negative to the most positive.
  function key({ limit, unit, name }) {
    const item = document.createElement("li");
    const bar = element("svg", { class: "key", viewBox: "0 0 110 12" });
    const group = element("g", { class: "mark map" });
    for (let k = -5; k <= 5; k += 1) {
      group.append(element("rect", {
        x: (k + 5) * 10, y: 0, width: 10, height: 12, class: k < 0 ? "below" : "above", "fill-opacity": Math.abs(k) / 5,
      }));
    }
    bar.append(group);
    const number = globalThis.charts.number;
    item.append(`${name}: ${number(-limit, 2)} `, bar, ` +${number(limit, 2)} ${unit}`);
    return [item];
  }

  Object.assign(globalThis.charts, { draw, titled });
})();
