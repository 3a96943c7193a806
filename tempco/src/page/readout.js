// Looking closer: the pointer or the arrow keys read a mark, dragging magnifies, a double click or Escape goes back.
"use strict";

globalThis.charts = globalThis.charts ?? {};

(() => {
  const { element, number, titled } = globalThis.charts;
  const REACH = 40;

  function readout(drawn) {
    const { svg, target, options, chart } = drawn;
    const marks = readable(drawn);
    const ring = element("circle", { class: "ring", r: 5, visibility: "hidden" });
    const selection = element("rect", { class: "selection", visibility: "hidden" });
    const words = document.createElement("p");
    words.className = "readout";
    words.setAttribute("aria-live", "polite");
    words.textContent = "\u00a0";
    svg.append(ring, selection);
    target.append(words);

    const show = (found) => {
      ring.setAttribute("visibility", found ? "visible" : "hidden");
      if (found) {
        ring.setAttribute("cx", found.px);
        ring.setAttribute("cy", found.py);
      }
      words.textContent = found ? globalThis.charts.visible(found.words()) : "\u00a0";
    };
    keys(svg, marks, show, () => back(drawn));
    svg.addEventListener("pointermove", (event) => show(nearest(marks, inside(svg, event))));
    svg.addEventListener("pointerleave", () => show(undefined));
    svg.addEventListener("dblclick", () => back(drawn));
    drag(drawn, selection, ([left, right], [top, bottom]) => {
      const x = { ...chart.x, range: [drawn.x.value(left), drawn.x.value(right)] };
      const y = { ...chart.y, range: [drawn.y.value(bottom), drawn.y.value(top)] };
      magnify(drawn, { ...chart, x, y }, { ...options, whole: options.whole ?? chart });
    });
  }

  // The same element with other axes; whoever holds the page may be told, to bring finer data.
  function magnify({ target }, chart, options) {
    globalThis.charts.draw(target, chart, options);
    target.dispatchEvent(new CustomEvent("chart-range", { bubbles: true, detail: { x: chart.x.range, y: chart.y.range } }));
  }

  function back(drawn) {
    const { whole, ...options } = drawn.options;
    if (whole) magnify(drawn, whole, options);
  }

  // All marks that can be read, in pixels, with the words for each.
  function readable({ chart, x, y, options }) {
    const found = [];
    const unit = (axis) => (axis.unit ? ` ${axis.unit}` : "");
    const place = (px, py) => `${chart.x.label} ${number(px)}${unit(chart.x)}, ${chart.y.label} ${number(py)}${unit(chart.y)}`;
    for (const layer of chart.layers) {
      if (layer.mark === "dots" || layer.mark === "line") {
        layer.x.forEach((value, k) => found.push({
          px: x.at(value), py: y.at(layer.y[k]),
          words: () => `${place(value, layer.y[k])} \u2014 ${layer.name}${runName(options, layer, k)}`,
        }));
      }
      if (layer.mark === "map") found.push(...cells(layer, { chart, x, y, place }));
    }
    return found;
  }

  function runName({ runs }, layer, k) {
    const run = runs?.[layer.run?.[k]];
    return run ? `, run ${run.name}` : "";
  }

  function cells(layer, { x, y, place }) {
    const columns = layer.x_edges.length - 1;
    const middle = (edges, k) => (edges[k] + edges[k + 1]) / 2;
    return layer.values.map((value, k) => {
      const [px, py] = [middle(layer.x_edges, k % columns), middle(layer.y_edges, Math.floor(k / columns))];
      const words = () => `${place(px, py)}: ${number(value, 3)} ${layer.unit}`;
      return { px: x.at(px), py: y.at(py), words, value };
    }).filter(({ value }) => value !== null);
  }

  function nearest(marks, [left, top]) {
    let best;
    let least = REACH * REACH;
    for (const one of marks) {
      const distance = (one.px - left) ** 2 + (one.py - top) ** 2;
      if (distance < least) [best, least] = [one, distance];
    }
    return best;
  }

  // From the screen into the drawing.
  function inside(svg, event) {
    const box = svg.getBoundingClientRect();
    const { width, height } = svg.viewBox.baseVal;
    return [(event.clientX - box.left) / box.width * width, (event.clientY - box.top) / box.height * height];
  }

  function keys(svg, marks, show, leave) {
    let order;
    let at = -1;
    svg.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1, PageDown: 20, PageUp: -20 }[event.key];
      if (event.key === "Escape") leave();
      if (!step || !marks.length) return;
      order ??= [...marks].sort((a, b) => a.px - b.px);
      at = Math.min(order.length - 1, Math.max(0, at + step));
      show(order[at]);
      event.preventDefault();
    });
  }

  const LEAST = 8;

  function drag({ svg, box }, selection, chosen) {
    let from;
    const clamped = ([x, y]) => [
      Math.min(box.right, Math.max(box.left, x)), Math.min(box.bottom, Math.max(box.top, y)),
    ];
    const sides = (to) => [0, 1].map((k) => [Math.min(from[k], to[k]), Math.max(from[k], to[k])]);
    svg.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return;
      from = clamped(inside(svg, event));
      svg.setPointerCapture?.(event.pointerId);
    });
    svg.addEventListener("pointermove", (event) => {
      if (!from) return;
      const [[left, right], [top, bottom]] = sides(clamped(inside(svg, event)));
      const shape = { x: left, y: top, width: right - left, height: bottom - top, visibility: "visible" };
      for (const [key, value] of Object.entries(shape)) selection.setAttribute(key, value);
    });
    svg.addEventListener("pointerup", (event) => {
      if (!from) return;
      const [x, y] = sides(clamped(inside(svg, event)));
      from = undefined;
      selection.setAttribute("visibility", "hidden");
      if (x[1] - x[0] > LEAST && y[1] - y[0] > LEAST) chosen(x, y);
    });
  }

  Object.assign(globalThis.charts, { readout, titled });
})();
