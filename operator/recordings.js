// Recordings, what can be computed from them, and the reports.
import { request } from "./api.js";
import { showList } from "./lists.js";
import { number, sentence, text } from "./text.js";

const $ = (id) => document.getElementById(id);
const chosen = new Set();
let ask = null, job = null, role = "look", ran = false;

export function wire(asking) {
  ask = asking;
  for (const button of document.querySelectorAll("[data-job]")) button.onclick = () => begin_job(button);
  $("cancel-job").onclick = () => ask($("cancel-job"), "/api/jobs/cancel", {});
}

// The last one that was chosen validates the model that the others identify.
function begin_job(button) {
  const names = [...chosen], command = button.dataset.job;
  const body = { command, train: names, validate: [] };
  if ((command === "identify" || command === "trace") && names.length > 1) body.validate = body.train.splice(-1);
  return ask(button, "/api/jobs", body);
}

export async function open() {
  const answer = await request("/api/recordings");
  if (!answer.recordings) return;
  const names = answer.recordings.map((r) => r.name);
  for (const name of chosen) if (!names.includes(name)) chosen.delete(name);
  $("no-recordings").hidden = names.length > 0;
  $("older-recordings").hidden = !answer.older;
  $("older-recordings").textContent = text("recordings.older", { older: answer.older });
  showList($("recordings"), answer.recordings.sort((a, b) => b.changed - a.changed), row);
  $("no-reports").hidden = answer.reports.length > 0;
  showList($("reports"), answer.reports, report, role);
  mark();
}

const when = (seconds) => new Date(1000 * seconds).toLocaleString(document.documentElement.lang, { dateStyle: "short", timeStyle: "short" });

function row(recording) {
  const line = document.createElement("label"), box = document.createElement("input"), name = document.createElement("span"), size = document.createElement("small");
  box.type = "checkbox";
  box.checked = chosen.has(recording.name);
  box.onchange = () => { if (box.checked) chosen.add(recording.name); else chosen.delete(recording.name); mark(); };
  name.textContent = recording.name.replace(/\.csv$/, "");
  size.textContent = `${number(recording.bytes / 1e6, 1)} MB`;
  line.append(box, name, size);
  return line;
}

function report(found) {
  const line = document.createElement("div"), link = document.createElement("a"), at = document.createElement("small");
  link.href = `/api/reports/${encodeURIComponent(found.name)}/report.html`;
  link.target = "_blank";
  link.rel = "noopener";
  link.textContent = found.name;
  at.textContent = when(found.changed);
  line.append(link, at);
  if (role === "engineer" && found.files.includes("model.yaml")) {
    const use = document.createElement("button");
    use.className = "quiet";
    use.textContent = text("model.use");
    use.onclick = () => ask(use, "/api/model", { report: found.name });
    line.append(use);
  }
  return line;
}

function mark() {
  const running = Boolean(job && job.active), count = chosen.size;
  const needs = { compare: count === 1, identify: count >= 1, trace: count >= 1, check_model: true };
  for (const button of document.querySelectorAll("[data-job]")) {
    const name = button.dataset.job;
    button.hidden = name !== "compare" && role !== "engineer";
    button.disabled = running || role === "look" || !needs[name];
  }
  $("cancel-job").disabled = !running || role === "look";
}

export function translate() { if (job) show(); if (!$("tab-recordings").hidden) open(); }

export function update(content, new_role) {
  job = content.job;
  role = new_role;
  if (ran && !job.active && !$("tab-recordings").hidden) open();
  ran = job.active;
  show();
  mark();
}

function show() {
  $("job-share").value = job.share;
  let words = "";
  if (job.active) words = `${text(`job.${job.command}`)}: ${sentence(job.stage)}`;
  else if (job.message) words = job.message.includes("/") ? text("job.done") : sentence(job.message);
  $("job-words").textContent = words;
  const key = JSON.stringify(job.result || null) + document.documentElement.lang;
  if ($("job-result").dataset.shown === key) return;
  $("job-result").dataset.shown = key;
  $("job-result").replaceChildren(...(job.result ? [table(job.result)] : []));
}

// Errors per actuator, before and after, and the model in use beside the new one.
function table(result) {
  const rows = [["result.before", result.before_rms_N], ["result.after", result.after_rms_N], ["result.in_use", result.in_use_rms_N], ["result.new", result.new_rms_N]];
  const node = document.createElement("table");
  const line = (cells, kind) => {
    const tr = document.createElement("tr");
    cells.forEach((cell, k) => { const td = document.createElement(k === 0 || kind === "th" ? "th" : "td"); td.textContent = cell; tr.append(td); });
    node.append(tr);
  };
  const filled = rows.filter(([, values]) => values && values.length);
  if (filled.length) line([text("result.error"), ...filled[0][1].map((_, k) => text("leg", { leg: k + 1 }))], "th");
  for (const [key, values] of filled) line([text(key), ...values.map((v) => number(v, 2))]);
  if (result.effects && result.effects.length) line([text("result.effects"), result.effects.join(", ")]);
  return node;
}
