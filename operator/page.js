// Start, login, tabs, STOP. Each tab has a module of its own.
import { listen, request, setToken, stop } from "./api.js";
import { sentence, text, useLanguage } from "./text.js";
import * as exercise from "./exercise.js";
import * as log from "./log.js";
import * as patient from "./patient.js";
import * as plots from "./plots.js";
import * as recordings from "./recordings.js";
import * as status from "./status.js";

const $ = (id) => document.getElementById(id);
const parts = { exercise, live: plots, patient, recordings, log };
let tab = "exercise", session = null, endListening = null, state = null;

// ---- STOP: works before everything else, without login, and never asks back
function wireStop() {
  const press = async (event) => {
    event.preventDefault();
    // The click that follows a finger's pointerdown, however late: only a keyboard's click has no detail.
    if (event.type === "click" && event.detail !== 0) return;
    $("stop").classList.add("sent");
    const answer = await stop();
    $("stop").classList.remove("sent");
    show(answer, true);
  };
  $("stop").addEventListener("pointerdown", press);
  $("stop").addEventListener("click", press);
  $("stop-form").addEventListener("submit", (event) => event.preventDefault());
  document.addEventListener("keydown", (event) => { if (event.key === "Escape") press(event); });
}

// ---- answers
let hide = 0;
export function show(answer, from_stop = false) {
  if (!answer || !answer.message) return;
  const box = $("answer");
  box.textContent = (from_stop ? "STOP: " : "") + sentence(answer.message);
  box.classList.toggle("good", answer.success);
  box.hidden = false;
  clearTimeout(hide);
  hide = setTimeout(() => { box.hidden = true; }, answer.success ? 4000 : 15000);
}

// One request of a button: the button waits for its answer, everything else does not.
async function ask(button, path, body) {
  if (button.classList.contains("busy")) return null;
  button.classList.add("busy");
  try {
    const answer = await request(path, body);
    show(answer);
    return answer;
  } finally {
    button.classList.remove("busy");
  }
}

function openTab(name) {
  tab = name;
  for (const key of Object.keys(parts)) {
    $(`tab-${key}`).hidden = key !== name || !session;
    document.querySelector(`[data-tab=${key}]`).setAttribute("aria-selected", key === name);
  }
  if (session && parts[name].open) parts[name].open();
}

function onState(content) {
  state = content;
  status.update(content, session.role);
  const wanted = session.role === "look" ? "" : status.tabOfNextStep(content);
  document.querySelectorAll("#tabs button").forEach((button) => button.classList.toggle("next", button.dataset.tab === wanted));
  for (const part of Object.values(parts)) if (part.update) part.update(content, session.role);
}

async function begin() {
  const answer = await request("/api/session");
  if (answer.success === false && answer.lost) {
    status.lost();
    setTimeout(begin, 1000);
    return;
  }
  const must_log_in = answer.login !== false;
  $("login").hidden = !must_log_in;
  $("tabs").hidden = must_log_in;
  if (endListening) endListening();
  endListening = null;
  session = must_log_in ? null : answer;
  openTab(tab);
  $("logout").hidden = !(session && session.may_log_out);
  if (!session) {
    status.anonymous();
    return;
  }
  setToken(session.csrf);
  for (const part of Object.values(parts)) if (part.begin) await part.begin(session);
  endListening = listen({ state: onState, live: plots.add, event: log.add }, (is_lost) => {
    if (is_lost) status.lost(); else begin();  // after a restart of the server the token is another one
  });
}

async function chooseLanguage() {
  const list = (await request("languages/index.json")).languages || [{ code: "en", name: "English" }];
  const box = $("language");
  for (const { code, name } of list) box.add(new Option(name, code));
  const kept = localStorage.getItem("language") || navigator.language.slice(0, 2);
  box.value = list.some((l) => l.code === kept) ? kept : list[0].code;
  box.onchange = async () => {
    localStorage.setItem("language", box.value);
    await useLanguage(box.value);
    for (const part of Object.values(parts)) if (part.translate) part.translate();
    if (state && session) onState(state); else if (!session) status.anonymous();
    openTab(tab);
  };
  await useLanguage(box.value);
}

$("login").querySelector("form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const form = new FormData(event.target);
  const answer = await request("/api/login", { user: form.get("user"), password: form.get("password") });
  event.target.elements.password.value = "";
  if (answer.success) await begin(); else show(answer);
});
$("logout").addEventListener("click", async () => { await request("/api/logout", {}); await begin(); });
document.addEventListener("logged-out", () => { if (session) begin(); });
document.querySelectorAll("#tabs button").forEach((button) => { button.onclick = () => openTab(button.dataset.tab); });

wireStop();
try {
  await chooseLanguage();
} catch (error) { /* the keys themselves, and STOP works */ }
for (const part of Object.values(parts)) if (part.wire) part.wire(ask, show);
await begin();
