// Pictures of exercises: the platform seen from the side, its turning over time, and what is left to the limits. Drawn, never parsed.
import { number, text } from "./text.js";

function element(name, attributes, words) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (words !== undefined) node.textContent = words;
  return node;
}

function line(points, kind) {
  return element("polyline", { class: kind, points: points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ") });
}

const span = (values) => [Math.min(...values), Math.max(...values)];

// path: {time_s, pose (rows of Xm, Zm, theta, psi; m, rad), lengths (rows, m)}
export function picture(path) {
  const svg = element("svg", { viewBox: "0 0 240 100", role: "img" });
  svg.append(element("rect", { class: "frame", x: 1, y: 12, width: 98, height: 87 }), element("rect", { class: "frame", x: 111, y: 12, width: 128, height: 87 }));
  if (path.pose.length) side(svg, path.pose); else svg.append(element("text", { x: 6, y: 55 }, "–"));
  over_time(svg, path);
  return svg;
}

function side(svg, pose) {
  const x = span(pose.map((p) => p[0])), z = span(pose.map((p) => p[1]));
  const size = Math.max(x[1] - x[0], z[1] - z[0], 0.02);
  const scale = 72 / size, middle = [(x[0] + x[1]) / 2, (z[0] + z[1]) / 2];
  const place = (p) => [50 + (p[0] - middle[0]) * scale, 56 - (p[1] - middle[1]) * scale];
  svg.append(line(pose.map(place), "path"));
  const [cx, cy] = place(pose[0]);
  svg.append(element("circle", { class: "start", cx, cy, r: 4 }), element("text", { x: 3, y: 9 }, text("picture.side", { mm: number(1000 * size, 0) })));
}

function over_time(svg, path) {
  const end = path.time_s[path.time_s.length - 1] || 1;
  const curves = path.pose.length ? [path.pose.map((p) => p[2] * 57.29578), path.pose.map((p) => p[3] * 57.29578)] : path.lengths[0].map((_, i) => path.lengths.map((l) => 1000 * l[i]));
  const range = span(curves.flat()), size = Math.max(range[1] - range[0], path.pose.length ? 2 : 1), middle = (range[0] + range[1]) / 2;
  curves.forEach((curve, k) => {
    svg.append(line(curve.map((v, i) => [112 + 126 * path.time_s[i] / end, 56 - (v - middle) / size * 74]), k === 1 ? "path second" : "path"));
  });
  if (!path.pose.length) return svg.append(element("text", { x: 112, y: 9 }, text("picture.lengths", { range: number(size, 0) })));
  // Each angle's own range, in the colour of its curve: angles that only differ turn nothing.
  const own = curves.map((curve) => { const [low, high] = span(curve); return number(high - low, 0); });
  svg.append(element("text", { x: 114, y: 9, class: "words" }, text("picture.theta", { range: own[0] })),
    element("text", { x: 239, y: 9, class: "words second", "text-anchor": "end" }, text("picture.psi", { range: own[1] })));
}

// margins: [{quantity, left}] as shares of the limit
export function marginBars(margins) {
  const box = document.createElement("div");
  box.className = "bars";
  for (const margin of [...margins].sort((a, b) => a.left - b.left).slice(0, 4)) {
    const name = document.createElement("span"), bar = document.createElement("span"), fill = document.createElement("i"), value = document.createElement("span");
    name.textContent = text(`margin.${margin.quantity}`);
    bar.className = "bar" + (margin.left < 0.02 ? " at" : margin.left < 0.1 ? " near" : "");
    fill.style.width = `${Math.max(2, Math.min(100, 100 * margin.left))}%`;
    bar.append(fill);
    value.textContent = `${number(100 * margin.left, 0)} %`;
    box.append(name, bar, value);
  }
  return box;
}
