// The page of predict.
begin("Predicted forces", `Robot ${report.robot}`, `model ${report.model}`, `${report.recordings.length} recording(s)`);

const effects = report.effects.map((e) => e.name + (e.actuators.length === 1 ? ` on ${chain ? "joint" : "actuator"} ${e.actuators[0]}` : "")
  + (e.transfers ? "" : " (on its own recordings only)"));
paragraph(effects.length ? `The model has rigid body, friction and ${effects.join(", ")}.` : "The model has rigid body and friction, no further effects.");

heading("Errors");
table(axesHead("", series.recordings[0].measured.length),
  report.recordings.flatMap((one) => accuracyRows(one.name + (one.fitted_on_it ? ", which the model was fitted on" : ""), one)));
key(`Both sides pass the same zero-phase low-pass at ${number(report.cutoff_hz)} Hz unless the row says otherwise. Moving: every ${chain ? "joint" : "axis"} faster than `
  + `${slowest(lengthFigure(report, "moving", "_per_s"))}.`);
for (const one of series.recordings) forcePlots(one, { predicted: "predicted", residual: "measured minus predicted" }, { shade: true });

heading("What was done with the signals");
for (const one of report.recordings) {
  subheading(one.path);
  bullets(one.notes);
}
end();
