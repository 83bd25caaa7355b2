"use strict";
// What the page embeds, and the parts that every page is made of. Names and sentences come from outside: all of them become text nodes.
const { report, series } = JSON.parse(document.getElementById("data").textContent);
const page = document.getElementById("page");

function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) made.setAttribute(name, value);
  made.append(...children.map((child) => (child instanceof Node ? child : String(child))));
  return made;
}

// Everything is added to the end of the page, or of what inside() opened.
let place = page;
function add(made) { place.append(made); return made; }
function inside(container, fill) {
  const outer = place;
  add(container);
  place = container;
  fill();
  place = outer;
}

const heading = (text) => add(element("h2", {}, text));
const subheading = (text) => add(element("h3", {}, text));
const paragraph = (text) => add(element("p", {}, text));
const key = (text) => add(element("p", { class: "key" }, text));
const folded = (summary, fill) => inside(element("details", {}, element("summary", {}, summary)), fill);
const bullets = (sentences) => add(element("ul", {}, ...sentences.map((s) => element("li", {}, s))));

// A heading and its sentences; nothing where there are none.
function sentences(title, list, level = heading) {
  if (!list || !list.length) return;
  level(title);
  bullets(list);
}

function begin(title, ...facts) {
  document.title = title;
  document.getElementById("without-scripts").remove();
  add(element("h1", {}, title));
  key(facts.join(" \u00b7 "));
}

function end() {
  heading("Reproduce");
  add(element("p", {}, element("code", {}, report.reproduce)));
}

// Numbers with so many digits that count; a dash where there is none.
const DASH = "\u2013";
function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  const rounded = Number(value.toPrecision(digits)), size = Math.abs(rounded);
  if (size >= 1e6 || (size > 0 && size < 1e-4)) return rounded.toExponential().replace("e+", "e");
  return String(rounded === 0 ? 0 : rounded);
}
const plusMinus = (value, std, unit = "", digits = 3) =>
  number(value, digits) + (Number.isFinite(std) ? `\u00a0\u00b1\u00a0${number(std, 2)}` : "") + (unit && `\u00a0${unit}`);
const scaled = (values, factor) => values.map((v) => (v === null ? null : v * factor));
const each = (count, make) => Array.from({ length: count }, (_, i) => make(i));
const DEGREES = 180 / Math.PI;

// Units and names of the actuators: a chain's joints have their own.
const chain = Boolean(report.joints);
const turns = chain && report.position_units.every((unit) => unit === "rad");
const inWords = (unit) => (unit === "Nm" ? "N\u00a0m" : unit);
const forceUnit = (i) => (chain ? inWords(report.units[i]) : "N");
const sameUnit = chain ? new Set(report.units).size === 1 : true;
const forceUnits = sameUnit ? forceUnit(0) : "each joint's own unit";
const forceName = (i) => (report.units && report.units[i] === "Nm" ? "torque" : forceUnit(i) === "A" ? "current" : "force");
const positionUnit = (i) => (chain ? report.position_units[i] : "m");
const axisName = (i) => (chain ? `joint ${i + 1} (${report.joints[i]})` : `actuator ${i + 1}`);
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// The figure of report.json whose key ends in the force's unit: rms_N, of chains rms_Nm, rms_A, or rms where joints differ.
function figure(of, name) {
  if (!of) return [];
  for (const ending of ["_N", "_Nm", "_A", ""]) if (of[name + ending] !== undefined) return of[name + ending];
  return [];
}
// The number whose key ends in m or, of chains of turning joints, in rad: moving_m_per_s.
const lengthFigure = (of, before, after = "") => of[`${before}_m${after}`] ?? of[`${before}_rad${after}`];
const slowest = (speed) => `${number(1e3 * speed)} ${turns ? "mrad/s" : "mm/s"}`;

const singleRecording = (count) => {
  if (count === 1)
    paragraph("There was a single training recording: every choice rests on contiguous parts of it, and evidence across trajectories was not available.");
};
const plainName = (path) => path.split("/").pop().replace(/\.csv$/, "");
const recordingKind = (kind) => ({ train: "Training", validate: "Validation", predict: "Predicted" })[kind];
