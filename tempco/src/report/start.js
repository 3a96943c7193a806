// Draws every chart that the file describes.
"use strict";

(() => {
  const { charts, runs } = JSON.parse(document.getElementById("data").textContent);
  for (const chart of charts) {
    const target = document.getElementById(chart.id)?.querySelector(".chart");
    if (target) globalThis.charts.draw(target, chart, { runs });
  }
  document.documentElement.dataset.drawn = String(charts.length);
})();
