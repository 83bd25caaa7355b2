// Who is on the robot: a patient file, or the word that nobody is; and a form for a new patient file.
import { request } from "./api.js";
import { showList } from "./lists.js";
import { occupancy } from "./status.js";
import { number, text } from "./text.js";

const $ = (id) => document.getElementById(id);
// key, unit, and what the form begins with: the paper's slow movements around the middle of the robot
const RANGES = [["X_m", -0.05, 0.05, 0.01], ["Z_m", 0.6, 0.72, 0.01], ["theta_deg", -5, 10, 1], ["psi_deg", -10, 10, 1]];
const SPEEDS = [["linear_mm_per_s", 20, 1], ["angular_deg_per_s", 2, 0.5]];
let ask = null, state = null, role = "look";

export function wire(asking) {
  ask = asking;
  $("new-patient").addEventListener("submit", write);
}

function input(name, value, step) {
  const box = document.createElement("input");
  Object.assign(box, { type: "number", name, value, step, required: true });
  return box;
}

function row(key, boxes) {
  const line = document.createElement("div"), words = document.createElement("span");
  words.dataset.text = `patient.${key}`;
  words.textContent = text(`patient.${key}`);
  line.append(words, ...boxes);
  boxes.forEach((box, k) => box.setAttribute("aria-label", `${text(`patient.${key}`)} ${k + 1}`));
  return line;
}

export async function begin() {
  $("ranges").replaceChildren(
    ...RANGES.map(([key, low, high, step]) => row(key, [input(`${key}_0`, low, step), input(`${key}_1`, high, step)])),
    ...SPEEDS.map(([key, value, step]) => row(key, [document.createElement("span"), input(key, value, step)])));
}

export async function open() {
  const list = (await request("/api/patients")).patients;
  if (!list) return;
  $("no-patients").hidden = list.length > 0;
  showList($("patients"), list, card);
  mark();
}

function card(file) {
  const button = document.createElement("button"), name = document.createElement("b"), words = document.createElement("small");
  button.className = "card";
  button.dataset.patient = file.patient;
  if (file.problem) {
    button.classList.add("refused");
    button.dataset.problem = "yes";
    button.disabled = true;
    name.textContent = file.name;
    words.textContent = `${text("patient.unreadable")}: ${file.problem}`;
    button.append(name, words);
    return button;
  }
  name.textContent = `${text("patient.short")} ${file.patient}`;
  words.textContent = `${file.name}: ${limits(file)}`;
  button.append(name, words);
  button.onclick = () => ask(button, "/api/robot/patient", { file: file.name });
  return button;
}

function limits(file) {
  const pose = file.pose || {}, speed = file.speed || {};
  const parts = RANGES.filter(([key]) => Array.isArray(pose[key])).map(([key]) => {
    const digits = key.endsWith("_m") ? 2 : 0;
    return `${text(`patient.${key}`)} ${pose[key].map((v) => number(v, digits)).join(" … ")}`;
  });
  if (speed.linear_mm_per_s) parts.push(`${number(speed.linear_mm_per_s, 0)} mm/s`);
  if (speed.angular_deg_per_s) parts.push(`${number(speed.angular_deg_per_s, 0)}°/s`);
  return parts.join(", ");
}

async function write(event) {
  event.preventDefault();
  const form = event.target.elements, value = (name) => Number(form[name].value);
  const patient = form.patient.value.trim();
  const body = {
    name: `${patient.replace(/[^A-Za-z0-9_-]/g, "_").replace(/^[^A-Za-z0-9]+/, "p")}.yaml`,
    patient,
    pose: Object.fromEntries(RANGES.map(([key]) => [key, [value(`${key}_0`), value(`${key}_1`)]])),
    speed: Object.fromEntries(SPEEDS.map(([key]) => [key, value(key)])),
  };
  const answer = await ask(event.target.querySelector("button"), "/api/patients", body);
  if (answer && answer.success) {
    form.patient.value = "";
    await open();
  }
}

function mark() {
  const robot = state && state.robot;
  for (const button of document.querySelectorAll("#patients .card")) {
    button.setAttribute("aria-pressed", Boolean(robot) && robot.patient === button.dataset.patient);
    button.disabled = Boolean(button.dataset.problem) || role === "look" || !robot || robot.state !== "disabled";
  }
}

export function translate() { if (!$("tab-patient").hidden) open(); }

export function update(content, new_role) {
  state = content;
  role = new_role;
  $("patient-now").textContent = occupancy(content.robot) || text("state.silent");
  $("new-patient").querySelector("button").disabled = role === "look";
  mark();
}
