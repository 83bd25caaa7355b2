// The page of trace.
const data = report.data;
const validated = data.validate.length > 0;
const axes = report.friction_near_rest.length;

begin("Traced residual", `Robot ${report.robot}`, `${data.train.length} training and ${data.validate.length} validation recording(s)`, `seed ${report.seed}`);
add(element("p", { class: "verdict" }, `${report.outcome} ${report.verdict}`));
sentences("Doubts about the recordings", report.doubts);

// Effects
function parameterTexts(effect) {
  if (effect.depends_on) return [`depends on ${effect.depends_on.join(", ")}`];
  return Object.entries(effect.parameters).map(([name, p]) => `${name} = ${plusMinus(p.value, p.std)}`);
}
// Figures of an effect on all actuators are those of the one that it explains most of.
function effectRows(effect) {
  const explained = figure(effect, "explained_rms"), shared = effect.actuators.length > 1;
  const at = shared ? explained.indexOf(Math.max(...explained)) : effect.actuators[0] - 1;
  const gain = effect.held_back_gain;
  const alike = effect.not_separable_from || effect.indistinguishable_from;
  return [[{ text: [effect.looks_like ? `${effect.name} (looks like ${effect.looks_like})` : effect.name, ...(effect.transfers ? [] : ["(does not transfer)"])] }, shared ? "all" : String(effect.actuators[0]), explained[at],
    figure(effect, "null_rms")[at], effect.p, gain ? `${number(100 * gain.share)}\u00a0\u00b1\u00a0${number(100 * gain.standard_error)}\u00a0%` : DASH,
    figure(effect, "validate_gain")[at]],
  { note: [effect.sentence, parameterTexts(effect).join("; "), ...(alike.length ? [`Cannot be told from ${alike.join(", ")}.`] : [])] }];
}
if (report.effects.length) {
  heading("Effects");
  table([{ text: "effect" }, chain ? "joint" : "actuator", `explains, ${forceUnits}`, `surrogates at most, ${forceUnits}`, "p",
    "held-back gain", `gain on validation, ${forceUnits}`], report.effects.flatMap(effectRows));
  key("Surrogates: recordings of a machine that lacks nothing. Held-back gain: error saved on left-out blocks of the training data. Gain on validation: rise of the "
    + "rms there when this effect alone is taken out of the finished model.");
}

const given = report.given_model;
if (given) {
  sentences("What of the given model still holds", [...given.effects, ...given.parameters].map((one) => one.sentence));
  key(`Given model: ${given.file}. Before: that model unchanged. Uncertainties by leaving blocks of the new recordings out; differs: by more than two of them.`);
}

const next = report.next_experiment;
if (next) {
  heading("Next experiment");
  paragraph(next.sentence);
}
if (next && next.reference) {
  plot(series.next_experiment.length_m.map((y, i) => ({ label: `leg ${i + 1}`, color: AXIS_COLORS[i], x: series.next_experiment.time_s, y: scaled(y, 1e3) })),
    { x: "time, s", y: "length, mm" });
  key(`Margins to the limits: ${next.margins.map((m) => `${m.quantity} ${number(100 * m.left, 2)} %`).join("; ")}.`);
}

// Errors
function errorRows(title, kind) {
  const before = report.before[kind], after = report.after[kind], gain = report.gain_interval[kind];
  if (!after) return [];
  const both = (words, values) => [[`before: ${words}`, ...values(before)], [`after: ${words}`, ...values(after)]];
  return [{ group: title },
    ...both(`rms, all samples, ${forceUnits}`, (a) => figure(a, "rms")),
    [`change of rms, lower end of 95 %, ${forceUnits}`, ...figure(gain, "rms_change_low")],
    [`change of rms, upper end of 95 %, ${forceUnits}`, ...figure(gain, "rms_change_high")],
    ...both("rms / rms of the force, %", (a) => a.rms_percent),
    ...both(`rms / rms of the force, all ${chain ? "joints" : "actuators"} together, %`, (a) => [a.together_percent]),
    ...both(`rms, moving samples, ${forceUnits}`, (a) => figure(a, "rms_moving")),
    ...both(`rms, all rows, full band, ${forceUnits}`, (a) => figure(a, "rms_raw")),
    ...both(`largest error, ${forceUnits}`, (a) => figure(a, "max"))];
}
heading("Errors before and after");
table(axesHead("", axes), [...errorRows("Validation", "validate"), ...errorRows("Training", "train"), { group: "Floor" },
  [`noise floor, ${forceUnits}`, ...figure(report.unexplained, "noise_floor")]]);
key(`Floor: ${report.unexplained.noise_floor_source}. Before: ${given ? "the given model, unchanged" : "rigid body, Coulomb, viscous, rotor, offset"}. Both sides `
  + `low-passed at ${number(data.cutoff_hz)} Hz unless the row says otherwise. Intervals: bootstrap over blocks of 2 s.`);

const kinds = { moving: `while the ${chain ? "joint" : "axis"} moves`, at_rest: "at rest (friction may take any value)",
  beginning: `before the ${chain ? "joint" : "axis"} first moves (nobody knows how its friction was loaded)`, masked: "masked (near a singular pose, at a limit)" };
const shares = (name) => Object.entries(kinds).map(([kind, words]) => [words, ...scaled(report.unexplained.where[kind][name], 100)]);
heading("Where the error that is left lies");
table(axesHead("", axes), [{ group: `% of the squared error, ${validated ? "validation" : "training"}` }, ...shares("share_of_squared_error"),
  { group: "% of the samples" }, ...shares("share_of_samples")]);

frictionSection(report.friction_near_rest, report.friction_tried);

if (report.angles.length) {
  folded("Principal angles between every candidate and the base, and its nearest others", () => {
    const placeOf = (one) => one.name + (one.actuator === null ? "" : ` on ${axisName(one.actuator - 1)}`);
    const degrees = (angle) => number(Math.round(angle));
    table([{ text: "candidate" }, "to the base, smallest, deg", "largest, deg", { text: "nearest others, base taken out" }], report.angles.map((a) => [placeOf(a),
      degrees(a.to_base_deg[0]), degrees(a.to_base_deg[1]), { text: a.nearest.map((n) => `${n.name} ${degrees(n.angle_deg)} deg`).join(", ") || "-" }]));
    key("Along the training recordings, each candidate with the shape that explains most. Near 0 to the base: the base parameters take it up. Near 0 to another: "
      + "these recordings hardly tell the two apart.");
  });
}

// Pose
const pose = report.pose, factors = [1e3, 1e3, DEGREES, DEGREES];
function poseFinding(finding) {
  const [name, p] = Object.entries(finding.parameters)[0];
  const turned = name.includes("_rad"), factor = turned ? DEGREES : 1e3;
  return [finding.place + (finding.transfers ? "" : " (does not transfer: home is set anew at every start)"),
    plusMinus(factor * p.value, factor * p.std, turned ? "deg" : "mm"), 100 * finding.share, number(100 * finding.null_share, 2), number(finding.p, 2),
    `${number(100 * finding.held_back_gain.share)}\u00a0\u00b1\u00a0${number(100 * finding.held_back_gain.standard_error, 2)}\u00a0%`, { text: finding.not_told_from }];
}
const poseNumbers = (errors) => [...errors.rms_m, ...errors.rms_rad, ...errors.max_m, ...errors.max_rad].map((value, k) => value * factors[k % 4]);
function poseSection() {
  heading("Pose: camera against encoders");
  if (!pose.findings.length) paragraph("No explanation of the pose beats surrogates; nothing was added.");
  else table([{ text: "explanation" }, "size", "explains, % of the square", "surrogates at most, %", "p", "held-back gain", { text: "cannot be told from" }],
    pose.findings.map(poseFinding));
  const rows = [];
  for (const [kind, title] of [["train", "Training: "], ["validate", "Validation: "]]) {
    pose.before[kind].forEach((before, k) => rows.push({ group: title + plainName(before.recording) },
      ["before: one fixed transform", ...poseNumbers(before)], ["after", ...poseNumbers(pose.after[kind][k])],
      ["after, with this recording's own transform and delay", ...poseNumbers(pose.after_with_own_frame[kind][k])]));
  }
  table(["camera minus encoders", "X rms, mm", "Z, mm", "theta, deg", "psi, deg", "X largest, mm", "Z, mm", "theta, deg", "psi, deg"], rows);
  const noise = [...pose.picture_noise.m, ...pose.picture_noise.rad].map((value, k) => `${number(value * factors[k], 2)} ${k < 2 ? "mm" : "deg"}`);
  key("The transform (turn about Y, shift in X and Z, turn of the markers about the platform's normal) and all explanations are fitted on training recordings. Noise "
    + `of single pictures: ${noise.join(", ")}. Rows with a condition above ${number(pose.condition_max)} are left out.`);
  for (const recording of series.pose) {
    subheading(`${recordingKind(recording.kind)}: ${recording.name}, camera minus encoders`);
    ["X, mm", "Z, mm", "theta, deg", "psi, deg"].forEach((name, k) => plot(
      [{ label: "before", color: COLORS.before, x: recording.time_s, y: scaled(recording.before[k], factors[k]) },
        { label: "after", color: COLORS.model, x: recording.time_s, y: scaled(recording.after[k], factors[k]) }],
      { x: "time, s", y: name, height: 180 }));
  }
  sentences("Notes on the pose", pose.notes, subheading);
  sentences("Taken up by the camera transform", pose.absorbed, subheading);
  sentences("Looked at for the pose and not added", pose.not_added, subheading);
}
if (pose) poseSection();

// Residual over velocity and position
heading(`Residual against velocity and position, ${recordingKind(series.maps.kind).toLowerCase()}: ${series.maps.name}`);
key("Means over bins, all samples.");
series.maps.over_velocity.forEach((velocity, i) => {
  subheading(capital(axisName(i)));
  for (const [map, x] of [[velocity, `velocity, ${positionUnit(i)}/s`], [series.maps.over_position[i], `position, ${positionUnit(i)}`]]) {
    plot([{ label: "before", color: COLORS.before, x: map.at, y: map.before }, { label: "after", color: COLORS.model, x: map.at, y: map.after }],
      { x, y: `mean residual, ${forceUnit(i)}`, height: 190 });
  }
});

for (const recording of series.recordings) forcePlots(recording, { predicted: "predicted after", residual: "after", before: "before" });
sentences("Absorbed by the baseline", report.absorbed);
sentences("Looked at and not added", report.not_added);
sentences("How the surrogates were made", report.notes);
singleRecording(data.train.length);
end();
