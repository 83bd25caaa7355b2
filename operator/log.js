// What has happened since the server started, the newest first.
import { request } from "./api.js";
import { has, sentence, text } from "./text.js";

const MOST = 300;
const $ = (id) => document.getElementById(id);
let events = [];

export async function begin() {
  events = (await request("/api/events")).events || [];
  open();
}

// What was there before the server comes later than its own first entries.
export function open() { events.sort((one, other) => one.time - other.time); show(); }
function show() { $("events").replaceChildren(...events.slice(-MOST).reverse().map(row)); }
export function translate() { show(); }

export function add(entry) {
  const late = events.length && entry.time < events[events.length - 1].time;
  events.push(entry);
  if (events.length > 2 * MOST) events = events.slice(-MOST);
  if ($("tab-log").hidden) return;
  if (late) { open(); return; }
  $("events").prepend(row(entry));
  while ($("events").children.length > MOST) $("events").lastChild.remove();
}

function words(entry) {
  if (entry.kind === "state") return text(`state.${entry.text}`);
  if (entry.kind === "fault") return has(`fault.${entry.name}`) ? `${text("log.fault")}: ${text(`fault.${entry.name}`)} (${entry.text})` : `${text("log.fault")}: ${entry.text}`;
  if (entry.answer === undefined) return sentence(entry.text);
  return `${entry.user ? `${entry.user}: ` : ""}${sentence(entry.text)} → ${sentence(entry.answer)}`;
}

function row(entry) {
  const line = document.createElement("li"), at = document.createElement("time"), what = document.createElement("span");
  line.className = entry.warning ? "warning" : entry.kind;
  at.textContent = new Date(1000 * entry.time).toLocaleTimeString(document.documentElement.lang);
  what.textContent = words(entry);
  line.append(at, what);
  return line;
}
