// The page of compare.
const recording = report.recording, pose = report.pose, camera = report.camera;
const NAMES = ["X", "Z", "theta", "psi"], KEYS = ["x", "z", "theta", "psi"], UNITS = ["mm", "mm", "deg", "deg"], FACTORS = [1e3, 1e3, DEGREES, DEGREES];
const LONG = ["X, mm", "Z, mm", "theta (about Y), deg", "psi (about Z), deg"];
const axisTitle = (i) => `${pose ? "Leg" : "Axis"} ${i + 1}`;

begin(`Reference against measured: ${recording.name}`, `Robot ${report.robot}`, `${recording.rows} rows, ${number(recording.duration_s)} s`);

// Largest, when, rms and mean of an error; means that a fit made zero are zero.
function errorCells(e, unit, factor) {
  const shown = (value) => (value === null ? null : Math.abs(factor * value) < 1e-6 ? 0 : factor * value);
  return [shown(e[`max_${unit}`]), e.time_of_max_s, shown(e[`rms_${unit}`]), shown(e[`mean_${unit}`])];
}
const poseCells = (errors, k) => errorCells(errors[KEYS[k]], k < 2 ? "m" : "rad", FACTORS[k]);
const errorHead = ["largest", "at, s", "rms", "mean"];

heading(pose ? "Errors beside the paper's" : "Errors");
table(["measured minus reference", ...errorHead, ...(pose ? ["paper, largest"] : [])], [
  ...report.actuators.map((e, i) => [`${axisTitle(i).toLowerCase()}, mm`, ...errorCells(e, "m", 1e3), ...(pose ? [report.paper[i].largest_error] : [])]),
  ...(pose ? NAMES.map((name, k) => [`${name}, ${UNITS[k]}`, ...poseCells(pose, k), report.paper[4 + k].largest_error]) : [])]);
if (pose) key("Pose: forward kinematics of the measured lengths minus that of the reference. The paper's figures are those of the text to its Figs. 15 and 16, of "
  + "another machine and movement.");

function cameraSection() {
  const a = camera.alignment;
  heading("Camera");
  table([{ text: "alignment, fixed over the recording" }, ""], [
    ["delay of the camera (cross-correlation of velocities)", a.delay_s === null ? "not determined, 0 assumed" : `${number(1e3 * a.delay_s)} ms`],
    ["correlation at that delay", number(a.correlation, 4)],
    ["turn of its frame about Y", `${number(DEGREES * a.rotation_rad)} deg`],
    ["shift of its frame, X", `${number(1e3 * a.shift_x_m)} mm`],
    ["shift of its frame, Z", `${number(1e3 * a.shift_z_m)} mm`],
    ["turn of the markers about the platform's normal", `${number(DEGREES * a.plate_rad)} deg`],
    ["rows that the rigid fit rests on", String(a.rows)]]);
  const errors = (title, of) => table([title, ...errorHead, "rows"], NAMES.map((name, k) => [`${name}, ${UNITS[k]}`, ...poseCells(of, k), String(of[KEYS[k]].rows)]));
  errors("camera minus encoders, all rows", camera.camera_minus_encoders);
  errors("camera minus encoders, away from singularities", camera.camera_minus_encoders_regular);
  if (camera.rows_with_nearer_solution > 0) errors("camera minus the nearer pose with these lengths", camera.camera_minus_nearest);
  errors("camera minus reference, all rows", camera.camera_minus_reference);
}
if (camera) cameraSection();
sentences("Notes", report.notes);

const x = series.time_s, time = { x: "time, s" };
heading(pose ? "Actuators (the paper's Fig. 15)" : "Axes");
series.measured_m.forEach((measured, i) => {
  subheading(axisTitle(i));
  plot([{ label: "reference", color: COLORS.reference, x, y: scaled(series.reference_m[i], 1e3) },
    { label: "measured", color: COLORS.measured, x, y: scaled(measured, 1e3) }], { ...time, y: "length, mm", height: 240 });
  plot([{ label: "measured minus reference", color: COLORS.measured, x, y: scaled(series.error_m[i], 1e3) }], { ...time, y: "error, mm", height: 180 });
});

function posePlots() {
  heading("Pose (the paper's Fig. 16)");
  const shaded = series.near_singularity;
  key(`${shaded.length ? "Shaded: the condition of the Jacobian (m, rad) is above " : "The condition of the Jacobian stays below "}${number(report.condition_max, 6)}.`);
  NAMES.forEach((name, k) => {
    const line = (label, color, of) => ({ label, color, x, y: scaled(series.pose[of][k], FACTORS[k]) });
    const values = [line("reference", COLORS.reference, "reference"), line("encoders", COLORS.measured, "encoders")];
    const errors = [line("encoders minus reference", COLORS.measured, "error")];
    if (camera) {
      values.push(line("camera", COLORS.model, "camera"));
      errors.push(line("camera minus encoders", COLORS.model, "camera_error"));
    }
    subheading(name);
    plot(values, { ...time, y: LONG[k], height: 240, shaded });
    plot(errors, { ...time, y: `error, ${UNITS[k]}`, height: 180, shaded });
  });
}
if (pose) posePlots();
end();
