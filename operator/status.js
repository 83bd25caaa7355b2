// The strip at the top: what the robot does, and what to do next.
import { has, sentence, text } from "./text.js";

const $ = (id) => document.getElementById(id);

function show(state, what, next) {
  $("status").dataset.state = state;
  if ($("status-what").textContent !== what) $("status-what").textContent = what;
  if ($("status-next").textContent !== next) $("status-next").textContent = next;
}

export function lost() {
  document.body.classList.add("lost");  // what is seen is old: no order may rest on it. STOP is always there.
  show("lost", text("state.lost"), text("next.lost"));
}
export function anonymous() { show("unknown", text("login.title"), ""); $("status-patient").textContent = ""; }

// The next step: a key of the languages without "next.", and the order that belongs to it.
export function nextStep(content) {
  const robot = content.robot;
  if (!robot) return { key: "silent", order: "" };
  const busy = content.playing.active;
  switch (robot.state) {
    case "faulted": return { key: "faulted", order: "reset_faults" };
    case "disabled":
      if (!robot.homed) return { key: "home", order: "home" };
      if (robot.occupancy === "unknown") return { key: "patient", order: "patient" };
      return { key: "enable", order: "enable" };
    case "holding":
      if (busy) return { key: "wait", order: "" };
      if (!robot.reference_file) return { key: "exercise", order: "" };
      return robot.at_start ? { key: "start", order: "start" } : { key: "approach", order: "approach" };
    case "playing": return { key: robot.playing === robot.reference_file || busy ? "playing" : "approaching", order: "" };
    case "paused": return { key: "paused", order: "resume" };
    default: return { key: "wait", order: "" };
  }
}

// The tab on which that step is; none while there is nothing to press.
export function tabOfNextStep(content) {
  const { key, order } = nextStep(content);
  if (order === "patient") return "patient";
  return order || key === "exercise" ? "exercise" : "";
}

export function occupancy(robot) {
  if (!robot) return "";
  if (robot.patient) return text("patient.named", { patient: robot.patient });
  if (robot.occupancy === "empty") return text("patient.empty");
  return robot.occupancy === "unknown" ? text("patient.unknown") : text("patient.no_file");
}

export function update(content) {
  document.body.classList.remove("lost");
  const robot = content.robot;
  $("status-patient").textContent = occupancy(robot);
  if (!robot) return show("lost", text("state.silent"), text("next.silent"));
  let next = text(`next.${nextStep(content).key}`);
  if (robot.state === "faulted" || robot.fault) {
    const known = has(`fault.${robot.fault}`);
    const own = known ? text(`fault.${robot.fault}`) : sentence(robot.cause);
    next = known && document.documentElement.lang !== "en" ? `${own}. ${next} (${robot.cause})` : `${sentence(robot.cause)}. ${next}`;
  }
  show(robot.state, text(`state.${robot.state}`), next);
}
