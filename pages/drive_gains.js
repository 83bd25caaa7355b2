// The page of drive_gains.
begin("Drive gains", `Robot ${report.robot}`, `by a payload of ${number(report.payload_kg, 6)} kg`);

const gainOf = (g) => (g.torque_per_ampere_Nm !== undefined ? [g.torque_per_ampere_Nm, "N m/A"] : [g.force_per_ampere_N, "N/A"]);
heading("Gains");
table([{ text: "joint" }, "gain", "95 % from", "to", { text: "unit" }, "standard error", "residual of the current, rms / rms, %"],
  report.drive_gains.map((g) => [g.joint, number(gainOf(g)[0], 4), number(g.low, 4), number(g.high, 4), { text: gainOf(g)[1] }, g.std, g.rms_percent]));
key("Inertias, payload's centre, friction and gains are fitted together to the currents of recordings without and with the payload. Standard errors: blocks of the "
  + "recordings left out in turn. The gains are in robot.yaml beside this page.");
sentences("Notes", report.notes);

heading("Payload's centre");
table(["last body's frame", "m", "standard error"], ["x", "y", "z"].map((name, k) => [name, report.payload_center_m[k], number(report.payload_center_std_m[k], 2)]));
end();
