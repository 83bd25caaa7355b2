// The page of tune_pid.
begin(`Gains from ${report.recording}`, `Deployment ${report.deployment}`);
paragraph(`Demanded over the whole range of inertia, friction and delay: ${report.demand.sentence}. A margin is the worst over that range. Coulomb friction, which only `
  + "damps, is left out. What the recording does not show (a flexible coupling, an amplifier that saturates) no margin knows: try new gains without anybody on the robot, and "
  + "at low speed first.");

const LOOP_COLORS = { "present, light": "#b0b0b0", "present, heavy": "#6a6a6a", "proposed, light": COLORS.measured, "proposed, heavy": COLORS.model };
report.axes.forEach((axis, i) => {
  heading(`${axis.name} (${axis.driver})`);
  table(["", { text: "" }], axis.in_words.map(([title, words]) => [title, { text: words }]));
  const one = series.axes[i];
  if (!one) return;
  plot([{ label: "commanded", color: COLORS.measured, x: one.time_s, y: one.commanded_N },
    { label: "inertia, friction, delay", color: COLORS.model, x: one.time_s, y: one.model_N }], { x: "time, s", y: "force, N" });
  if (!one.loops.length) return;
  const lines = (x, of) => one.loops.map((loop) => ({ label: `${loop.gains}, ${loop.end}`, color: LOOP_COLORS[`${loop.gains}, ${loop.end}`], x, y: loop[of] }));
  plot(lines(one.frequency_hz, "sensitivity"), { x: "frequency, Hz", y: "sensitivity |1 / (1 + L)|", logX: true });
  plot(lines(one.step_time_s, "step"), { x: "time, s", y: "position after a step of 1" });
});
end();
