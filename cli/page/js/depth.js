// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, table } from "./elements.js";
import { percent, setting, significant } from "./format.js";
import { is_number, ratio } from "./numbers.js";
import { COLOUR, figure, log_axis } from "./plot.js";

/** Depth uncertainty against range: plot and table. */
export function depth_part(rig) {
  const rows = (rig.depth ?? []).filter((row) => is_number(row.range_m));
  if (!rows.length) return null;
  const numbers = element("div", {}, element("h3", {}, "Depth values"), table(
    "Standard deviation of depth due to calibration error only (ψ_c = 1)", [
      { head: "Range, m", cell: (row) => setting(row.range_m) },
      { head: "Linear, m", cell: (row) => significant(row.sigma_linear_m, 2) },
      { head: "Sampled, m", cell: (row) => significant(row.sigma_sampled_m, 2) },
      { head: "Linear", small: "fraction of range",
        cell: (row) => percent(ratio(row.sigma_linear_m, row.range_m)) },
      { head: "Non-physical", small: "samples without depth",
        cell: (row) => percent(row.non_physical_share) },
    ], rows));
  return element("div", { class: "pair" }, depth_figure(rows), numbers);
}

function depth_figure(rows) {
  const lost = rows.filter((row) => row.non_physical_share > 0.001);
  const warning = lost.length ? ` From ${setting(lost[0].range_m)} m on, some sampled rigs`
    + " give no positive depth: the standard deviation is not meaningful there." : "";
  return figure("Depth uncertainty against range", "Depth uncertainty due to calibration error"
    + " only, on log-log axes: a straight line of slope 2 is the quadratic growth with range"
    + " expected of stereo. Linear: first-order propagation at the calibrated rig. Sampled: rigs"
    + ` sampled from the covariance. Where they differ, the linear approximation is no`
    + ` longer valid: use the sampled values.${warning}`,
    "Standard deviation of depth against range, linear and sampled; values are in the"
      + " table.", 400, () => depth_plot(rows));
}

function depth_plot(rows) {
  const ranges = rows.map((row) => row.range_m);
  const line = (key, name, color, dash, symbol) => ({
    type: "scatter", mode: "lines+markers", name, x: ranges, y: rows.map((row) => row[key]),
    line: { color, dash, width: 2 }, marker: { size: 7, symbol },
    hovertemplate: `${name}: %{y:.2g} m at %{x:.3g} m<extra></extra>`,
  });
  const sigmas = rows.flatMap((row) => [row.sigma_linear_m, row.sigma_sampled_m]);
  return {
    data: [line("sigma_linear_m", "linear", COLOUR.blue, "solid", "circle"),
      line("sigma_sampled_m", "sampled", COLOUR.red, "dash", "square-open")],
    layout: { xaxis: log_axis("range, m", ranges), yaxis: log_axis("σ of depth, m", sigmas) },
  };
}
