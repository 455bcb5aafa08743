// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section } from "./elements.js";
import { count, metres, percent, plot_text, range_percent, setting } from "./format.js";
import { bars_in_percent, in_percent, is_number } from "./numbers.js";
import { COLOUR, axis, figure, log_axis } from "./plot.js";
import { PSI_MEANING, ceiling_of, cell_key } from "./study.js";

const SOURCE_MEANING = {
  "sources.calibration": PSI_MEANING,
  "sources.moved": "moved is the fraction of the furniture that stands elsewhere than on the map.",
  "sources.mount_height_m": "The camera's height differs from what is told by this standard deviation, in metres.",
  "sources.mount_pitch_deg": "The camera's pitch differs from what is told by this standard deviation, in degrees.",
  "sources.mount_roll_deg": "The camera's roll, told to be 0, has this standard deviation, in degrees.",
  "sources.unseen": "unseen is the fraction of the world's edges that no image shows.",
  "sources.clutter": "clutter is the number of false edges, as a fraction of the edges in view.",
  "sources.merge_px": "Parallel lines nearer than merge_px, in pixels, are detected as one.",
  "sources.lateral_shift_px": "ψ_l is the shift of edges by illumination, in pixels.",
  "sources.edge_loss": "ψ_e is the missing fraction of each edge's length.",
  "sources.endpoint_sigma_px": "ψ_g is the standard deviation of line endpoints, in pixels.",
  "sources.stereo_mismatch": "ψ_s is the fraction of edges with a wrong stereo match.",
  "sources.corner_loss": "ψ_cd is the fraction of corner pairs that are not detected.",
  "sources.corner_mismatch": "ψ_cm is the fraction of corner pairs with a wrong match.",
};

/** Success and median error against the swept setting, or by cell without a sweep. */
export function sweep_section(study) {
  const swept = study.sweep;
  const label = swept ? swept.label || swept.key : "the cell";
  const made = section("sweep", swept ? `Effect of ${label}` : "Results by cell");
  if (swept && SOURCE_MEANING[swept.key]) made.append(paragraph(SOURCE_MEANING[swept.key]));
  const plots = [success_figure(study, label), error_figure(study, label)].filter(Boolean);
  if (plots.length) made.append(element("div", { class: "pair" }, plots));
  else made.append(paragraph("The values are in the table of all cells."));
}

/** One series per combination of the other settings that differ between cells. */
function sweep_series(study) {
  if (!study.sweep) return [{ name: "", cells: study.cells }];
  const others = varying_settings(study.cells).filter((key) => key !== study.sweep.key);
  const series = new Map();
  for (const cell of study.cells) {
    const name = others.map((key) => `${key} = ${setting(cell_key(cell, key))}`).join(", ");
    if (!series.has(name)) series.set(name, []);
    series.get(name).push(cell);
  }
  return [...series].map(([name, cells]) => ({ name, cells }));
}

export function varying_settings(cells) {
  const keys = [...new Set(cells.flatMap((cell) => Object.keys(cell.settings || {})))];
  return keys.filter((key) =>
    new Set(cells.map((cell) => JSON.stringify(cell_key(cell, key) ?? null))).size > 1);
}

/** The x axis and the position of cells on it: {axis, at: cell => x}. */
function sweep_axis(study) {
  const swept = study.sweep;
  if (!swept) {
    return { axis: axis("", { type: "category" }), at: (cell) => plot_text(cell.label) };
  }
  const title = swept.label || swept.key;
  const at = (cell) => cell_key(cell, swept.key);
  const values = study.cells.map(at);
  const positive = values.filter((x) => x > 0);
  const wide = Math.max(...positive) / Math.min(...positive) > 20;
  // A logarithmic axis cannot show zero: such values, and text values, are evenly spaced.
  if (!values.every(is_number) || (wide && values.some((x) => x <= 0))) {
    return { axis: axis(title, { type: "category" }), at: (cell) => setting(at(cell)) };
  }
  if (!wide) return { axis: axis(title), at };
  return { axis: log_axis(`${title} (logarithmic)`, values), at };
}

function success_figure(study, label) {
  const ceilings = study.cells.map((cell) => ceiling_of(study, cell)).filter(is_number);
  const ceiling = ceilings.length ? " Dashed line: ceiling of the world, the success of an"
    + " exhaustive search without noise." : "";
  return figure("Success", `${spread_words(study, "success", percent)} Dots: success rate of`
    + ` a cell; bars: 95 % intervals.${ceiling}`,
    `Success rate with 95 per cent intervals against ${label}; values are in the table of`
      + " all cells.", 400, () => success_plot(study));
}

/** "Success goes from 89 % (ψ_c = 0.1) to 34 % (ψ_c = 10)." */
function spread_words(study, key, write) {
  const cells = study.cells.filter((cell) => is_number(cell[key]));
  if (!cells.length) return "";
  const sorted = [...cells].sort((a, b) => a[key] - b[key]);
  const [low, high] = [sorted[0], sorted[sorted.length - 1]];
  const what = key === "success" ? "Success" : "The median error";
  if (cells.length === 1 || low[key] === high[key]) return `${what} is ${write(low[key])}.`;
  return `${what} ranges from ${write(low[key])} (${low.label}) to ${write(high[key])}`
    + ` (${high.label}).`;
}

function success_plot(study) {
  const across = sweep_axis(study);
  const all = sweep_series(study);
  const data = all.map(({ name, cells }, i) => ({
    type: "scatter", mode: study.sweep ? "lines+markers" : "markers", name: plot_text(name),
    x: cells.map(across.at), y: cells.map((cell) => in_percent(cell.success)),
    error_y: interval_bars(cells), line: { color: series_colour(i), width: 1.5 },
    marker: { size: 8, symbol: i }, showlegend: all.length > 1,
    customdata: cells.map((cell) => [plot_text(cell.label),
      range_percent(cell.success_interval_95),
      count(cell.trials)]),
    hovertemplate: "%{customdata[0]}<br>success %{y:.1f} %<br>95 %: %{customdata[1]}"
      + "<br>%{customdata[2]} trials<extra></extra>",
  }));
  const layout = { xaxis: across.axis, yaxis: axis("success, %", { range: [0, 102] }),
    ...ceiling_marks(study) };
  return { data, layout };
}

function interval_bars(cells) {
  const ranges = cells.map((cell) => cell.success_interval_95);
  return bars_in_percent(cells.map((cell) => cell.success), ranges, { thickness: 1.5, width: 6 });
}

function ceiling_marks(study) {
  const ceilings = [...new Set(study.cells.map((cell) => ceiling_of(study, cell)))]
    .filter(is_number);
  return {
    shapes: ceilings.map((c) => ({ type: "line", xref: "paper", x0: 0, x1: 1, y0: 100 * c,
      y1: 100 * c, line: { color: COLOUR.ink, width: 1.2, dash: "dash" } })),
    annotations: ceilings.map((c) => ({ xref: "paper", x: 1, xanchor: "right", y: 100 * c,
      yanchor: "top", yshift: -1, showarrow: false, text: `ceiling ${percent(c)}`,
      font: { size: 12 } })),
  };
}

function error_figure(study, label) {
  if (!study.cells.some((cell) => is_number(cell.median_error_m))) return null;
  return figure("Median error", `${spread_words(study, "median_error_m", metres)} Over` + " all"
    + " answered queries, including wrong answers; unanswered queries are excluded.",
    `Median position error against ${label}; values are in the table of all cells.`, 400,
    () => error_plot(study));
}

function error_plot(study) {
  const across = sweep_axis(study);
  const all = sweep_series(study);
  const values = study.cells.map((cell) => cell.median_error_m).filter(is_number);
  const data = all.map(({ name, cells }, i) => ({
    type: "scatter", mode: study.sweep ? "lines+markers" : "markers", name: plot_text(name),
    x: cells.map(across.at), y: cells.map((cell) => cell.median_error_m),
    line: { color: series_colour(i), width: 1.5 }, marker: { size: 8, symbol: i },
    showlegend: all.length > 1, text: cells.map((cell) => plot_text(cell.label)),
    hovertemplate: "%{text}<br>median error %{y:.3g} m<extra></extra>",
  }));
  const wide = Math.max(...values) / Math.min(...values) > 20 && Math.min(...values) > 0;
  const yaxis = wide ? log_axis("median error, m (logarithmic)", values)
    : axis("median error, m", { rangemode: "tozero" });
  return { data, layout: { xaxis: across.axis, yaxis } };
}
