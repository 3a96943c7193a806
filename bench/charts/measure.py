"""Draws the same charts with each library in headless Chromium and prints one table."""

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CHARTS, DOTS, CLASSES = 16, 3000, 2
ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "tempco/src/page"
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--dump-dom"]

# Each draws `data` (lists of x and of y, class by class) into `target`.
DRAW = {
    "tempco": """
        const axis = (range) => ({ label: 'x', unit: '', scale: 'linear', range });
        const layers = data.map(([x, y], k) =>
            ({ mark: 'dots', name: `class ${k}`, tone: ['first', 'second'][k], x, y, run: [] }));
        charts.draw(target, { id: 'c', title: 'c', caption: '', x: axis([0, 1]), y: axis([0, 1]), layers });""",
    "plotly": """
        Plotly.newPlot(target, data.map(([x, y]) => ({ x, y, mode: 'markers', type: 'scatter', marker: { size: 3 } })),
            { width: 620, height: 330 });""",
    "echarts": """
        echarts.init(target, null, { renderer: 'svg', width: 620, height: 330 }).setOption({
            animation: false, xAxis: {}, yAxis: {},
            series: data.map(([x, y]) => ({ type: 'scatter', symbolSize: 3, data: x.map((v, k) => [v, y[k]]) })) });""",
    "chart.js": """
        const canvas = target.appendChild(document.createElement('canvas'));
        new Chart(canvas, { type: 'scatter', options: { animation: false, responsive: false },
            data: { datasets: data.map(([x, y]) => ({ pointRadius: 1.5, data: x.map((v, k) => ({ x: v, y: y[k] })) })) } });""",
    "uplot": """
        new uPlot({ width: 620, height: 330, mode: 1, scales: { x: { time: false } },
            series: [{}, ...data.map(() => ({ stroke: 'blue', paths: () => null, points: { show: true, size: 3 } }))] },
            [data[0][0].toSorted((a, b) => a - b), ...data.map(([, y]) => y)], target);""",
}


def files(work):
    modules = work / "node_modules"
    return {
        "tempco": [PAGE / name for name in ("scale.js", "marks.js", "charts.js", "readout.js", "style.css")],
        "plotly": [modules / "plotly.js-dist-min/plotly.min.js"],
        "echarts": [modules / "echarts/dist/echarts.min.js"],
        "chart.js": [modules / "chart.js/dist/chart.umd.js"],
        "uplot": [modules / "uplot/dist/uPlot.iife.min.js", modules / "uplot/dist/uPlot.min.css"],
    }


def page(draw, sources):
    scripts = "".join(f"<script>{source.read_text()}</script>" for source in sources if source.suffix == ".js")
    return f"""<!DOCTYPE html><meta charset="utf-8"><body>{scripts}<script>
        let seed = 1;
        const random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
        const list = () => Array.from({{ length: {DOTS} }}, random);
        const all = Array.from({{ length: {CHARTS} }}, () => Array.from({{ length: {CLASSES} }}, () => [list(), list()]));
        const start = performance.now();
        for (const data of all) {{
            const target = document.body.appendChild(document.createElement('div'));
            {draw}
        }}
        document.body.getBoundingClientRect();
        const spent = performance.now() - start;
        const nodes = document.querySelectorAll('*').length;
        document.body.replaceChildren();
        document.body.dataset.result = JSON.stringify({{ spent, nodes }});
        </script>"""


def measured(browser, html):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "page.html")
        file.write_text(html)
        command = [browser, *FLAGS, f"--user-data-dir={folder}/profile", file.as_uri()]
        dom = subprocess.run(command, capture_output=True, text=True, timeout=300).stdout
    found = re.search(r'data-result="([^"]*)"', dom)
    if not found:
        sys.exit(f"no result; the page said: {dom[-300:]}")
    return json.loads(found[1].replace("&quot;", '"'))


def main():
    browser = shutil.which("chromium") or sys.exit("no chromium; on Debian: apt-get install chromium")
    print(f"{CHARTS} charts of {CLASSES} x {DOTS} dots\n")
    print(f"  {'':<10}{'carried KB':>12}{'drawn in ms':>13}{'elements':>10}")
    for name, sources in files(Path(sys.argv[1])).items():
        size = sum(source.stat().st_size for source in sources)
        runs = [measured(browser, page(DRAW[name], sources)) for _ in range(3)]
        spent = min(run["spent"] for run in runs)
        print(f"  {name:<10}{size / 1000:>12.0f}{spent:>13.0f}{runs[0]['nodes']:>10}")


if __name__ == "__main__":
    main()
