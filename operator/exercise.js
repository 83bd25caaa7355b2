// The exercise: which one, its steps, its progress.
import { request } from "./api.js";
import { showList } from "./lists.js";
import { marginBars, picture } from "./picture.js";
import { nextStep } from "./status.js";
import { duration, number, sentence, text } from "./text.js";

const $ = (id) => document.getElementById(id);
const orders = () => document.querySelectorAll("[data-order]");
let content = null, role = "look", ask = null, repetitions = 1, speed = 100, asked_speed = 0, limits = [5, 100];
const pictures = new Map();

export function wire(asking) {
  ask = asking;
  for (const button of orders()) button.onclick = () => order(button);
  for (const button of document.querySelectorAll("[data-step]")) button.onclick = () => step(button);
}

function order(button) {
  const name = button.dataset.order;
  if (name === "start") return ask(button, "/api/robot/start", { repetitions, record: $("record").checked });
  return ask(button, `/api/robot/${name}`, {});
}

async function step(button) {
  const by = Number(button.dataset.by);
  if (button.dataset.step === "repetitions") {
    repetitions = Math.min(100, Math.max(1, repetitions + by));
    $("repetitions").textContent = repetitions;
    return;
  }
  const wanted = Math.min(limits[1], Math.max(limits[0], by > 0 && speed < 10 ? 10 : speed + by));
  asked_speed = performance.now();
  showSpeed(wanted);
  const answer = await ask(button, "/api/robot/speed", { percent: wanted });
  if (!answer || !answer.success) asked_speed = 0;
}

function showSpeed(percent) {
  speed = percent;
  $("speed").textContent = `${number(percent, 0)} %`;
}

export async function begin(session) {
  limits = [session.slowest_percent, session.fastest_percent];
  await open();
}

export async function open() {
  const list = (await request("/api/exercises")).exercises;
  if (!list) return;
  $("no-exercises").hidden = list.length > 0;
  showList($("exercises"), list, card);
  mark();
  fillAll(list);
}

// One after the other, and nobody waits for them: they may take a minute, and the robot's state must not. The newest list wins.
let filling = 0;
async function fillAll(list) {
  filling += 1;
  const mine = filling;
  for (const { name, changed } of list) {
    if (mine !== filling) return;
    await fill(name, `${name}:${changed}`);
  }
}

function card({ name }) {
  const button = document.createElement("button");
  button.className = "card";
  button.dataset.file = name;
  const title = document.createElement("b");
  title.textContent = name.replace(/\.\w+$/, "").replaceAll("_", " ");
  const body = document.createElement("div");
  body.textContent = "…";
  button.append(title, body);
  button.onclick = () => ask(button, "/api/robot/load", { file: name });
  return button;
}

async function fill(name, version) {
  const box = document.querySelector(`#exercises [data-file="${CSS.escape(name)}"] div`);
  if (!box || box.dataset.language === document.documentElement.lang) return;
  if (!pictures.has(version)) {
    const answer = await request(`/api/exercises/${encodeURIComponent(name)}`);
    if (answer.success === false) { box.textContent = sentence(answer.message); return; }
    pictures.set(version, answer);
  }
  const found = pictures.get(version);
  box.dataset.language = document.documentElement.lang;
  const words = document.createElement("small");
  words.textContent = found.violation ? `${text("exercise.refused")}: ${sentence(found.violation)}` : duration(found.duration_s);
  box.parentElement.classList.toggle("refused", Boolean(found.violation));
  box.replaceChildren(...(found.path ? [picture(found.path)] : []), words, marginBars(found.margins || []));
}

export function translate() { if (content) update(content, role); }

function mark() {
  const loaded = content && content.robot ? content.robot.reference_file : "";
  for (const button of document.querySelectorAll("#exercises .card")) button.setAttribute("aria-pressed", button.dataset.file === loaded);
}

// Which orders make sense now. The controller judges every one of them itself.
function possible(name) {
  const robot = content.robot, busy = content.playing.active;
  if (!robot) return false;
  switch (name) {
    case "enable": return robot.state === "disabled" && robot.homed && robot.occupancy !== "unknown";
    case "approach": return robot.state === "holding" && Boolean(robot.reference_file) && !robot.at_start && !busy;
    case "start": return robot.state === "holding" && robot.at_start && !busy;
    case "pause": return robot.state === "playing";
    case "resume": return robot.state === "paused";
    case "disable": return !["disabled", "faulted", "safe_stopping"].includes(robot.state);
    case "reset_faults": return robot.state === "faulted";
    case "home": case "confirm_home": return robot.state === "disabled" && !robot.homed;
    case "clear_patient": return robot.state === "disabled" && (Boolean(robot.patient) || robot.occupancy === "empty");
    case "declare_empty": return robot.state === "disabled" && robot.occupancy !== "empty" && robot.occupancy !== "";
    default: return false;
  }
}

export function update(now, new_role) {
  content = now;
  role = new_role;
  const next = nextStep(content).order;
  for (const button of orders()) {
    const name = button.dataset.order, can = role !== "look" && possible(name);
    button.disabled = !can;
    button.classList.toggle("next", can && (name === next || (name === "confirm_home" && next === "home")));
    if (["home", "confirm_home", "reset_faults"].includes(name)) button.hidden = !possible(name);
  }
  for (const button of document.querySelectorAll("#exercises .card")) button.disabled = role === "look";
  const robot = content.robot;
  $("chosen").textContent = robot && robot.reference_file ? robot.reference_file.replace(/\.\w+$/, "").replaceAll("_", " ") : text("exercise.none");
  if (robot && performance.now() - asked_speed > 1500 && Math.abs(content.playing.speed_percent - speed) > 0.01) showSpeed(content.playing.speed_percent);
  progress(robot, content.playing);
  mark();
}

// Without the parts that only an engineer reads; the log has all of it.
export function shortly(message) {
  const parts = message.split("; ");
  const without = parts.filter((part, k) => k === 0 || !(part.includes("/") || part.includes("cycles")));
  return without.join("; ");
}

function progress(robot, playing) {
  const moves = robot && ["playing", "paused", "stopping"].includes(robot.state);
  $("progress").value = moves ? robot.progress : 0;
  let words = "";
  if (playing.active) {
    words = text("progress.playing", { k: playing.repetition, n: playing.repetitions, left: duration(playing.left_s ?? 0) });
  } else if (moves) {
    words = text("progress.moving", { percent: number(100 * robot.progress, 0) });
  } else if (playing.message) {
    words = sentence(shortly(playing.message));
  }
  $("progress-words").textContent = words;
}
