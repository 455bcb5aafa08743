// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { paragraph, section, small, table } from "./elements.js";
import { percent, range_percent, significant } from "./format.js";
import { bars_in_percent, in_percent } from "./numbers.js";
import { axis, figure, log_axis, series_colour } from "./plot.js";
import { PSI_MEANING } from "./study.js";

const error_name = (cell) => cell.rows_moved_px ? `rows ${significant(cell.rows_moved_px, 2)} px`
  : `ψ_c = ${significant(cell.psi_c, 2)}`;

export function calibration_error_section(evaluation, names) {
  const { cells, draws, rigs } = evaluation.calibration_error;
  const rig = [...new Set(rigs)].join(", ");
  const made = section("calibration-error", "Under calibration error", paragraph(
    `Each pair is rectified with ${draws === 1 ? "a rig" : `${draws} rigs`} sampled from the`
    + ` covariance of the calibration (${rig}). ${PSI_MEANING} Matches are scored against the true`
    + " disparities after this rectification, so a mismatch is a wrong correspondence. Bias is"
    + " the geometric effect of the calibration error on the true disparities; the error of the"
    + " measured disparities includes both. Repair corrects the vertical misalignment estimated"
    + " from corners of the pair. Any misalignment of the original pair is corrected first, so"
    + " that ψ_c = 0 is the pair without it. If rows are misaligned, an edge may be matched"
    + " anywhere between the disparity of its point and the position where it crosses the row:"
    + " all of these count as correct."));
  const drawn = cells.filter((cell) => cell.psi_c > 0);
  if (drawn.length > 2) made.append(mismatch_figure(drawn, names) || "");
  const rows = cells.flatMap((cell) => names.map((name) =>
    ({ cell, name, ...cell.matchers[name] })));
  made.append(table("Scores for each error, means over pairs and samples", [
    { head: "Error", text: true, cell: (row) => error_name(row.cell) },
    { head: "Repair", small: "pairs repaired", text: true, cell: (row) =>
      row.cell.repair ? `${row.cell.repaired} of ${row.cell.pairs}` : "no" },
    { head: "Matcher", text: true, cell: (row) => row.name },
    { head: "Density", cell: (row) => percent(row.density) },
    { head: "Bad 1", cell: (row) => percent(row.bad_1, 2) },
    { head: "Mismatch", small: "95 % interval", cell: (row) => [percent(row.mismatch, 2),
      row.mismatch_interval_95 && small(range_percent(row.mismatch_interval_95))] },
    { head: "Rows px", small: "vertical, RMS", cell: (row) => significant(row.cell.rows_rms_px) },
    { head: "Bias px", small: "geometric, RMS", cell: (row) =>
      significant(row.cell.geometric_bias_rms_px) },
    { head: "Error px", small: "measured, RMS", cell: (row) =>
      significant(row.disparity_error_rms_px) },
  ], rows));
}

function mismatch_figure(cells, names) {
  const series = names.flatMap((name, i) => [false, true].map((repair) => {
    const own = cells.filter((cell) => cell.repair === repair);
    const shares = own.map((cell) => cell.matchers[name].mismatch);
    const ranges = own.map((cell) => cell.matchers[name].mismatch_interval_95);
    return { type: "scatter", mode: "lines+markers",
      name: repair ? `${name}, repaired` : name,
      x: own.map((cell) => cell.psi_c), y: shares.map(in_percent),
      error_y: bars_in_percent(shares, ranges, { thickness: 1, width: 3 }),
      line: { color: series_colour(i), dash: repair ? "dot" : "solid" },
      hovertemplate: "%{y:.2f} %" };
  })).filter((trace) => trace.x.length);
  return figure("Mismatch against calibration error", "Bars: 95 % intervals over the pairs.",
    "Fraction of mismatches against psi_c, with and without repair.", 400, () => ({ data: series,
      layout: { xaxis: log_axis("ψ_c", cells.map((cell) => cell.psi_c)),
        yaxis: axis("mismatch, %", { rangemode: "tozero" }) } }));
}
