// The page of identify.
const data = report.data;
const axes = report.friction_near_rest.length;

begin("Identified force model", `Robot ${report.robot}`, `${data.train.length} training and ${data.validate.length} validation recording(s)`,
  `rank ${report.rank.chosen}`);

sentences("Doubts about the recordings", report.doubts);
heading("Errors");
table(axesHead("", axes), [
  ...accuracyRows("Validation", report.after.validate),
  ...accuracyRows("Training", report.after.train),
  ...(report.physical.done ? [...accuracyRows("Validation, physically consistent parameters", report.physical.validate),
    ...accuracyRows("Training, physically consistent parameters", report.physical.train)] : []),
  ...accuracyRows(`Validation, model without ${chain ? "joint" : "actuator"} friction`, report.before.validate),
  ...accuracyRows(`Training, model without ${chain ? "joint" : "actuator"} friction`, report.before.train)]);
key(`${chain ? "Measured is what the recorder wrote." : "Measured means commanded: no force sensor exists."} Both sides pass the same zero-phase low-pass at `
  + `${number(data.cutoff_hz)} Hz unless the row says otherwise. Moving: every ${chain ? "joint" : "axis"} faster than ${slowest(lengthFigure(data, "moving", "_per_s"))}.`);

for (const recording of series.recordings)
  forcePlots(recording, { predicted: "predicted", residual: "identified model", before: "without friction model" }, { shade: true });

heading(`Spectrum of the residual: ${series.spectra.name}`);
key("Amplitude density, all samples, nothing low-passed at the cut-off (dashed). Beyond it the command's own control loop and noise are left, which no "
  + "motion explains.");
series.spectra.measured.forEach((measured, i) => {
  subheading(capital(axisName(i)));
  const x = series.spectra.frequency_hz;
  plot([{ label: `measured ${forceName(i)}`, color: COLORS.measured, x, y: measured },
    { label: "residual", color: COLORS.model, x, y: series.spectra.residual[i] }],
  { x: "frequency, Hz", y: `${forceUnit(i)} / \u221aHz`, height: 220, logY: true, markers: [data.cutoff_hz] });
});

const rank = report.rank, ranks = rank.curve.map((p) => p.rank);
const rankAxis = "directions that the data decide (the prior's pull falls to the right)";
heading("Error against the prior's strength");
paragraph(`Chosen: ${rank.chosen} directions, friction and rotors included, that the data decide (dashed); the others stay near the prior. All are fitted; the `
  + "pull towards the prior is the strongest whose error on held-back blocks of the training data is within one standard error of the best. "
  + `${rank.blocks} blocks, split at stops; repeats of a stretch of motion are held back together. The validation curve is shown for comparison; it played no part.`);
subheading(`Blocks of the training data, all ${chain ? "joints" : "actuators"}, in units of the noise`);
plot([{ label: "held back", color: COLORS.model, x: ranks, y: rank.curve.map((p) => Math.sqrt(p.held_back)) },
  { label: "fitted", color: COLORS.measured, x: ranks, y: rank.curve.map((p) => Math.sqrt(p.training)) }],
{ x: rankAxis, y: "rms / noise", logY: true, markers: [rank.chosen] });
for (const [title, name] of [["Training", "train_moving"], ["Validation", "validate_moving"]]) {
  const curve = rank.curve.map((p) => figure(p, name));
  if (!curve.length || !curve[0].length) continue;
  subheading(`${title}, per ${chain ? "joint" : "actuator"}`);
  plot(each(axes, (i) => ({ label: axisName(i), color: AXIS_COLORS[i % AXIS_COLORS.length], x: ranks, y: curve.map((errors) => errors[i]) })),
    { x: rankAxis, y: `rms, moving, ${forceUnits}`, logY: true, markers: [rank.chosen] });
}

heading("Parameters");
const parameterHead = ["parameter", "value", "standard error", "%", { text: "unit" }, { text: "verdict" }];
const parameterRow = (p) => ({ silent: p.std === null, cells: [p.name, number(p.value, 4), p.std,
  p.std !== null && p.value ? 100 * p.std / Math.abs(p.value) : null, { text: p.unit }, { text: p.verdict }] });
const own = report.parameters.filter((p) => p.std !== null), silent = report.parameters.filter((p) => p.std === null);
table(parameterHead, own.map(parameterRow));
key(`Standard errors: 300 draws of a bootstrap over blocks of ${number(report.uncertainty.block_s)} s, the length that the residual's autocorrelation asks for `
  + "(Politis and White). Identified: standard error below 10 % of the value. Friction and rotor inertia are kept from becoming negative.");
folded(`${silent.length} parameters that this data does not determine alone; ${report.combinations} combinations of them are determined and are listed, with `
  + "uncertainties, in model.yaml", () => table(parameterHead, silent.map(parameterRow)));
sentences("Gains of the drives", report.drive_gains, subheading);
table([chain ? "per joint" : "per actuator", { text: "friction near rest" }, `residual (training, moving), ${forceUnits}`],
  report.friction_near_rest.map((law, i) => [axisShort(i), { text: `${law.law}: ${law.in_words}` }, figure(report, "residual_moving")[i]]));
frictionSection(report.friction_near_rest, report.friction_tried);

heading("Physically consistent parameters");
const physical = report.physical;
if (!physical.done) {
  paragraph(`Not fitted: ${physical.why}`);
} else {
  const inertial = 10 * physical.links.length;
  paragraph(`All ${inertial} inertial parameters of ${physical.links.length} bodies that can exist, with friction, rotors and offsets, fitted to the same equations. `
    + `The data decide ${number(physical.directions_from_data)} of ${inertial + axes} directions (inertias and offsets); where they are silent the prior does: `
    + `${physical.prior}. Strength of the prior (dashed): the strongest whose error on held-back blocks of the training data is within one standard error of the best. `
    + (physical.optimal ? "The solver ended at the optimum: no change of a body gains more than a millionth of the cost."
      : "The solver stopped short of the optimum, at the boundary of what is possible: take these bodies as possible ones, not as the best."));
  plot([{ label: "held back", color: COLORS.model, x: physical.curve.map((p) => p.prior_strength), y: physical.curve.map((p) => Math.sqrt(p.held_back)) }],
    { x: "the prior's strength", y: "rms / noise", logX: true, logY: true, markers: [physical.prior_strength] });
  const millimetres = (center) => center.map((c) => String(Math.round(1e4 * c) / 10 + 0)).join(", ");
  table([{ text: "link" }, "mass, kg", "prior, kg", "centre of mass, mm", "prior, mm", "principal moments, g m\u00b2", "change from the prior, %"],
    physical.links.map((body) => [body.link, body.mass_kg, body.prior_mass_kg, millimetres(body.center_m), millimetres(body.prior_center_m),
      body.principal_moments_kg_m2.map((moment) => number(1e3 * moment)).join(", "), 100 * body.change_from_prior]));
  key("Written to identified.urdf and model_physical.yaml. Change from the prior: 0 % is the prior itself, 100 % a change as large as it, in its own metric.");
}

heading("What was left out");
const files = [...data.train, ...data.validate];
const reasons = Object.keys(report.masks[files[0]] || {});
table([{ text: "share of the samples, %" }, ...files.map(plainName)],
  reasons.map((reason) => [reason, ...files.map((file) => 100 * (report.masks[file] || {})[reason])]));
heading("Cut-off");
paragraph(report.cutoff.rule);
if (series.cutoff.frequency_hz.length) {
  const x = series.cutoff.frequency_hz, markers = [series.cutoff.chosen_hz];
  plot([{ label: "reference's acceleration, root of the power density", color: COLORS.measured, x, y: series.cutoff.reference_acceleration }],
    { x: "frequency, Hz", y: "m/s\u00b2 / \u221aHz", height: 220, logY: true, markers });
  plot([{ label: "coherence of reference and recording", color: COLORS.model, x, y: series.cutoff.coherence }],
    { x: "frequency, Hz", y: "coherence", height: 190, markers });
}
heading("What was done with the signals");
for (const file of files) {
  subheading(file);
  bullets(report.signal_path[file] || []);
}
const fit = report.fit;
bullets([
  `Positions: zero-phase low-pass at ${fit.given_motion_cutoff_hz === null ? "three to five times the cut-off, as the encoders allow" : `${number(fit.given_motion_cutoff_hz)} Hz`}`
    + `, then five-point differences. Both sides of the equation: zero-phase low-pass (4th-order Butterworth, forward and backward) at ${number(data.cutoff_hz)} Hz.`,
  ...(report.full_band.rule ? [report.full_band.rule] : []),
  `Fitted: ${fit.equations} equations from ${number(fit.duration_s)} s of motion, weighted with the residual of each ${chain ? "joint" : "actuator"} (${axes} noise levels); `
    + `${number(100 * report.outlier_share)} % of them are outliers that count less than half; rule: ${fit.outliers}.`,
  "Coulomb friction keeps its last value at rest and builds up over the stated displacement, so stops need no sign of the velocity."]);
singleRecording(data.train.length);
end();
