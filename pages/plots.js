// Line plots by Chart.js. A line: { label, color, x, y }; null interrupts it. What was before is broader, to be seen below what did not change.
const COLORS = { measured: "#1b6ca8", model: "#d1495b", before: "#8a8a8a", reference: "#555555" };
const AXIS_COLORS = ["#1b6ca8", "#d1495b", "#2a9d55", "#8e5ea2", "#c77c11", "#17858b", "#7a5c43", "#5a6b1e", "#b0508f", "#3d4f9f", "#a03a2c", "#666666"];
const LEFT = 66; // px of the y axis: plots below each other share their x
const FEW = 40; // a line of so few points shows them

Chart.defaults.font.family = "system-ui, sans-serif";
Chart.defaults.color = "#333";

// Tinted intervals of x, and dashed vertical lines.
const background = {
  id: "background",
  beforeDatasetsDraw(chart, _, { shaded = [], markers = [] }) {
    const { ctx, chartArea: area, scales: { x } } = chart;
    ctx.save();
    ctx.beginPath();
    ctx.rect(area.left, area.top, area.width, area.height);
    ctx.clip();
    ctx.fillStyle = "rgba(214, 196, 140, 0.28)";
    for (const [from, to] of shaded) {
      const left = x.getPixelForValue(from);
      ctx.fillRect(left, area.top, x.getPixelForValue(to) - left, area.height);
    }
    ctx.strokeStyle = "#333";
    ctx.setLineDash([4, 3]);
    for (const at of markers) {
      ctx.beginPath();
      ctx.moveTo(x.getPixelForValue(at), area.top);
      ctx.lineTo(x.getPixelForValue(at), area.bottom);
      ctx.stroke();
    }
    ctx.restore();
  },
};

// From `low` to `high`, with labels at round numbers only; on a logarithmic axis at 1, 2 and 5, or at powers of ten where it is long.
function axis(title, isLog, low, high) {
  const long = isLog && high / low > 300;
  const labelled = (value) => !isLog || (long ? /^1e/ : /^[125]e/).test(value.toExponential());
  return { type: isLog ? "logarithmic" : "linear", min: low, max: high, title: { display: true, text: title }, grid: { color: "#e6e6e6", borderColor: "#888" },
    ticks: { maxRotation: 0, includeBounds: false, autoSkip: !isLog, callback: (value) => (labelled(value) ? number(value, 6) : null) } };
}

// What is shown of these values: all, with a margin, and some width even where they are one and the same.
function range(values, isLog, margin) {
  if (!values.length) return [isLog ? 0.1 : 0, 1];
  const low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
  if (isLog) return low === high ? [low / 2, 2 * high] : margin ? [low / 1.15, 1.15 * high] : [low, high];
  const more = low === high ? 0.1 * Math.abs(high) + 0.1 : margin * (high - low);
  return [low - more, high + more];
}

function dataset({ label, color, x, y }, logX, logY) {
  const data = x.map((at, k) => ({ x: at, y: y[k] === null || (logY && y[k] <= 0) ? NaN : y[k] })).filter((p) => !logX || p.x > 0);
  const few = data.length <= FEW;
  return { label, data, borderColor: color, backgroundColor: color, borderWidth: color === COLORS.before ? 2.6 : 1.4, pointRadius: few ? 2 : 0, pointHitRadius: 4 };
}

function plot(lines, { x, y, height = 260, logX = false, logY = false, shaded = [], markers = [] }) {
  const canvas = element("canvas", { role: "img", "aria-label": `${y} over ${x}: ${lines.map((line) => line.label).join(", ")}` });
  const box = add(element("div", { class: "plot" }, canvas));
  box.style.height = `${height}px`;
  const datasets = lines.map((line, k) => ({ ...dataset(line, logX, logY), order: -k })); // the last is drawn on top of the others
  const points = datasets.flatMap((set) => set.data.filter((p) => Number.isFinite(p.y)));
  const xs = axis(x, logX, ...range(points.map((p) => p.x), logX, 0)), ys = axis(y, logY, ...range(points.map((p) => p.y), logY, 0.05));
  new Chart(canvas, {
    type: "line",
    data: { datasets },
    plugins: [background],
    options: {
      animation: false, maintainAspectRatio: false, parsing: false, normalized: true, spanGaps: false,
      interaction: { mode: "nearest", axis: "x", intersect: false },
      layout: { padding: { right: 12 } },
      scales: { x: xs, y: { ...ys, afterFit: (scale) => { scale.width = LEFT; } } },
      plugins: {
        background: { shaded, markers },
        legend: { align: "end", reverse: true, labels: { boxWidth: 22, boxHeight: 1, font: { size: 12 }, padding: 8 } },
        tooltip: { callbacks: { title: (items) => `${x}: ${number(items[0].parsed.x, 5)}`, label: (item) => `${item.dataset.label}: ${number(item.parsed.y, 4)}` } },
      },
    },
  });
}
