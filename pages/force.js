// What pages on forces share: a recording's plots, friction near rest, rows of accuracy.

// Measured and predicted force and what is left, per actuator. `words`: labels of the lines, { predicted, residual, before }.
function forcePlots(recording, words, { shade = false } = {}) {
  heading(`${recordingKind(recording.kind)}: ${recording.name}`);
  if (shade) key(`Shaded: every ${chain ? "joint" : "axis"} moves.`);
  const x = recording.time_s, shaded = shade ? recording.moving : [];
  recording.measured.forEach((measured, i) => {
    subheading(capital(axisName(i)));
    const unit = forceUnit(i);
    plot([{ label: "measured", color: COLORS.measured, x, y: measured },
      { label: words.predicted, color: COLORS.model, x, y: recording.predicted[i] }],
    { x: "time, s", y: `${forceName(i)}, ${unit}`, height: 240, shaded });
    const left = [{ label: words.residual, color: COLORS.model, x, y: recording.residual[i] }];
    if (recording.residual_before) left.unshift({ label: words.before, color: COLORS.before, x, y: recording.residual_before[i] });
    plot(left, { x: "time, s", y: `residual, ${unit}`, height: 190, shaded });
  });
}

function frictionSection(laws, tried) {
  heading("Friction near rest");
  table([chain ? "joint" : "actuator", { text: "law" }], laws.map((law, i) => [axisShort(i), { text: `${law.law}: ${law.in_words}` }]));
  const acceleration = series.friction.acceleration * 1e3;
  plot(series.friction.share_of_coulomb.map((y, i) => ({ label: axisName(i), color: AXIS_COLORS[i % AXIS_COLORS.length], x: series.friction.time_ms, y })),
    { x: `time from a reversal at ${number(acceleration)} ${turns ? "mrad/s\u00b2" : "mm/s\u00b2"}, ms`, y: "share of Coulomb friction" });
  if (!tried.length) return;
  paragraph("Chosen on training data alone: blocks are left out in turn, shapes and shares are found without them; the simplest family within a "
    + "quarter of a standard error of the best is taken.");
  table([chain ? "joint" : "actuator", { text: "best law of each family" }, "held-back error / noise", "beyond the best", "standard error"],
    tried.flatMap((laws_of_one, i) => laws_of_one.map((law) => [axisShort(i) + (law.chosen ? " (chosen)" : ""), { text: law.in_words },
      number(Math.sqrt(law.held_back), 4), law.beyond_best, law.standard_error])));
}
const axisShort = (i) => (chain ? report.joints[i] : String(i + 1));

// Rows of one model's accuracy on one set of recordings.
function accuracyRows(title, a) {
  if (!a) return [];
  const unit = forceUnits;
  return [{ group: `${title} (${a.samples} samples, ${a.moving_samples} of them moving)` },
    [`rms, moving samples, ${unit}`, ...figure(a, "rms_moving")],
    [`rms, all samples, ${unit}`, ...figure(a, "rms")],
    [`rms, all rows, full band, ${unit}`, ...figure(a, "rms_raw")],
    ["rms / rms of the force, rows, full band, %", ...a.raw_percent],
    ["rms / rms of the force, %", ...a.rms_percent],
    [`rms / rms of the force, all ${chain ? "joints" : "actuators"} together, %`, a.together_percent],
    ["rms / range of the force, %", ...a.range_percent],
    [`largest error, ${unit}`, ...figure(a, "max")]];
}
