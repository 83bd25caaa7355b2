// Live plots of one leg over the last WINDOW_S, cheap enough for a weak tablet: drawn only while they are seen, and less often when
// drawing takes long.
import { text } from "./text.js";

const WINDOW_S = 30, MOST = 400;
const $ = (id) => document.getElementById(id);
const samples = [];
let leg = 0, pending = false, cost_ms = 0, drawn = 0;

export function wire() {
  for (let i = 0; i < 4; i++) {
    const button = document.createElement("button");
    button.onclick = () => { leg = i; mark(); draw(); };
    $("legs").append(button);
  }
}

export function translate() { mark(); }
export function begin() { mark(); }
export function open() { mark(); requestAnimationFrame(draw); }

function mark() {
  [...$("legs").children].forEach((button, i) => {
    button.textContent = text("leg", { leg: i + 1 });
    button.setAttribute("aria-pressed", i === leg);
  });
}

export function add(sample) {
  if (samples.length && sample.t < samples[samples.length - 1].t) samples.length = 0;  // another session of the robot
  samples.push(sample);
  if (samples.length > MOST) samples.shift();
  if (sample.nearest !== undefined) $("nearest").textContent = `${Math.max(0, Math.round(100 * sample.left))} %`;
  const now = performance.now();
  if ($("tab-live").hidden || document.hidden || pending || now - drawn < 8 * cost_ms) return;
  pending = true;
  requestAnimationFrame(draw);
}

function draw() {
  const begun = performance.now();
  pending = false;
  curve("plot-length", [["reference", "#b9770e", [6, 5]], ["position", "#0b5394", []]], 1.0, "mm");
  curve("plot-force", [["force", "#0b5394", []]], 5.0, "N");
  curve("plot-residual", [["residual", "#943126", []]], 5.0, "N");
  drawn = performance.now();
  cost_ms = drawn - begun;
}

function curve(id, kinds, smallest, unit) {
  const canvas = $(id), ratio = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (!width || !height) return;
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  const pen = canvas.getContext("2d");
  pen.clearRect(0, 0, width, height);
  if (!samples.length) return;
  const end = samples[samples.length - 1].t, left = 64 * ratio;
  let low = Infinity, high = -Infinity;
  for (const [kind] of kinds) {
    for (const sample of samples) {
      if (sample.t < end - WINDOW_S) continue;
      low = Math.min(low, sample[kind][leg]);
      high = Math.max(high, sample[kind][leg]);
    }
  }
  const size = Math.max(high - low, smallest) * 1.15, middle = (high + low) / 2;
  const y = (value) => height / 2 - (value - middle) / size * height, x = (t) => width - (end - t) / WINDOW_S * (width - left);
  axes(pen, width, height, left, ratio, middle, size, y, unit);
  for (const [kind, colour, dash] of kinds) {
    pen.beginPath();
    pen.strokeStyle = colour;
    pen.lineWidth = 2 * ratio;
    pen.setLineDash(dash.map((d) => d * ratio));
    for (const sample of samples) if (sample.t >= end - WINDOW_S) pen.lineTo(x(sample.t), y(sample[kind][leg]));
    pen.stroke();
  }
  pen.setLineDash([]);
}

function axes(pen, width, height, left, ratio, middle, size, y, unit) {
  pen.strokeStyle = "#dfe5ea";
  pen.fillStyle = "#44525f";
  pen.lineWidth = ratio;
  pen.font = `${12 * ratio}px "DejaVu Sans", sans-serif`;
  for (const share of [-0.4, 0, 0.4]) {
    const value = middle + share * size;
    pen.beginPath();
    pen.moveTo(left, y(value));
    pen.lineTo(width, y(value));
    pen.stroke();
    pen.fillText(`${value.toFixed(size < 10 ? 1 : 0)} ${unit}`, 2 * ratio, y(value) + 4 * ratio);
  }
}
