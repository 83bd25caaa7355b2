// Words of the page in the chosen language. A language is one file of languages/: "language", keys of the page, and "sentences": those
// of the controller and the server, where {1}, {2} stand for what changes.
let words = {}, patterns = [];

export async function useLanguage(code) {
  const answer = await fetch(`languages/${code}.json`);
  words = await answer.json();
  patterns = Object.entries(words.sentences || {}).map(([from, to]) => {
    const places = [...from.matchAll(/\{(\d)\}/g)].map((m) => m[1]);
    const escaped = from.split(/\{\d\}/).map((part) => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("(.*?)");
    return { from: new RegExp(`^${escaped}$`, "s"), to, places };
  });
  document.documentElement.lang = code;
  document.querySelectorAll("[data-text]").forEach((element) => { element.textContent = text(element.dataset.text); });
  document.querySelectorAll("[data-say]").forEach((element) => { element.setAttribute("aria-label", text(element.dataset.say)); });
}

// A key's words; {name} is replaced by values.name.
export function text(key, values = {}) {
  const found = words[key];
  if (found === undefined) return key;
  return found.replace(/\{(\w+)\}/g, (_, name) => (name in values ? values[name] : ""));
}

export function has(key) { return key in words; }

// A sentence of the controller or the server in the language, or as it came. Sentences joined by "; " are looked up one by one.
export function sentence(english) {
  const whole = translated(english);
  if (whole !== null) return whole;
  const parts = english.split("; ");
  return parts.length > 1 ? parts.map((part) => translated(part) ?? part).join("; ") : english;
}

function translated(english) {
  for (const pattern of patterns) {
    const match = pattern.from.exec(english);
    if (!match) continue;
    return pattern.to.replace(/\{(\d)\}/g, (_, k) => sentence(match[1 + pattern.places.indexOf(k)] ?? ""));
  }
  return null;
}

export function number(value, digits) {
  return Number(value).toLocaleString(document.documentElement.lang, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

export function duration(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
