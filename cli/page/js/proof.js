// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, table } from "./elements.js";
import { DASH, count, counted, fixed, percent, significant } from "./format.js";
import { in_percent, is_number, times } from "./numbers.js";
import { is_bound } from "./parameters.js";
import { COLOUR, axis, figure, log_axis } from "./plot.js";
import { ink_on } from "./theme.js";

/** Cross-validation of lens model and covariance on held-out views. */
export function proof_content(rig) {
  const { proof } = rig;
  return [
    ...(proof.notes ?? []).map((words) => element("p", { class: "notice" }, words)),
    proof.models && models_table(proof.models),
    ...(proof.halves ? halves_content(proof.halves, covariances(rig)) : []),
    ...(proof.left_out ? left_out_content(proof.left_out, covariances(rig)) : []),
  ];
}

function models_table({ frames, rows }) {
  const caption = `Lens models on held-out views: each of ${count(frames)} frames is predicted by a`
    + " calibration without it (only its board pose is fitted). Only a clearly smaller held-out"
    + " residual justifies a richer model; the gain is the mean improvement divided by its"
    + " standard deviation. Largest change: of a parameter when the model changes, in honest σ of the"
    + " model in use. A change above 3 σ is a model error that no covariance on this page"
    + " includes.";
  return element("div", {}, element("h3", {}, "Is the lens model rich enough?"), table(caption, [
    { head: "Model", text: true, cell: (row) => row.in_use ? `${row.model} (in use)` : row.model },
    { head: "Held out", small: "RMS, px", cell: (row) => significant(row.held_out_rms_px, 4) },
    { head: "Fitted", small: "RMS, px", cell: (row) => significant(row.fitted_rms_px, 4) },
    { head: "Better views", cell: (row) => is_number(row.better_views)
      ? `${count(row.better_views)} of ${count(frames)}` : DASH },
    { head: "Gain", small: "standard deviations", cell: (row) => fixed(row.gain_sigmas, 1) },
    { head: "Largest change", text: true, cell: (row) => row.largest_move
      ? `${row.largest_move} by ${fixed(row.largest_move_sigmas, 1)} σ` : DASH },
  ], rows, { chosen: (row) => row.in_use, wide: false }));
}

const COVARIANCES = [
  { by: "honest", name: "honest covariance", suffix: "honest", color: COLOUR.blue },
  { by: "bound", name: "minimum variance bound", suffix: "mvb", color: COLOUR.red },
];

/** The covariances of a rig: only one if its covariance is the bound. */
const covariances = (rig) => is_bound(rig) ? COVARIANCES.slice(1) : COVARIANCES;

/** Halves of the views, calibrated apart. */
function halves_content(halves, by) {
  const failed = halves.failed ? ` ${counted(halves.failed, "split")} could not be calibrated.` : "";
  return [
    element("h3", {}, "Is the covariance correct?"),
    element("p", {}, `The ${count(halves.frames)} frames were divided at random into halves, which`
      + ` were calibrated apart, ${count(halves.splits)} times. With a correct covariance the squared`
      + ` distance between two halves is ${count(halves.dof)} on average, the number of parameters.`
      + " It is " + by.map(({ name, suffix }) =>
        `${significant(halves[`nees_mean_${suffix}`], 3)} by the ${name}`).join(", ")
      + `.${failed}`),
    distances_figure(halves, by),
    element("p", { class: "reading" }, "This tests the scatter from view to view. What all views"
      + " share (board, square size, lens model, corner detector) is equally wrong in both halves"
      + " and cannot be seen. Splits share frames, so the mean of one set scatters more than that"
      + " of independent ones."),
  ];
}

function distances_figure({ distances, dof, splits }, by) {
  const below = distances.expected.map((_, i) => 100 * (i + 0.5) / splits);
  const line = (name, x, color, dash) => ({ type: "scatter", mode: "lines", name, x, y: below,
    line: { color, width: 2, shape: "linear", dash },
    hovertemplate: `${name}: %{y:.0f} % below %{x:.3g}<extra></extra>` });
  return figure("", "Fraction of splits below a squared distance. A covariance whose line follows"
    + ` the dotted one (χ², ${dof} degrees of freedom) states the errors correctly; one to the right`
    + " of it states errors that are too small.", "Distances between halves of the views.", 300,
    () => ({
      data: [line("correct", distances.expected, COLOUR.ink, "dot"),
        ...by.map(({ name, suffix, color }) => line(name, distances[suffix], color, "solid"))],
      layout: {
        xaxis: log_axis("squared Mahalanobis distance", [...distances.expected,
          ...by.flatMap(({ suffix }) => distances[suffix])]),
        yaxis: axis("splits below, %", { range: [0, 100], dtick: 20 }) },
    }));
}

function left_out_content(left_out, by) {
  const [edges] = left_out.rows;
  const failed = left_out.failed ? ` ${counted(left_out.failed, "split")} could not be calibrated.`
    : "";
  return [
    element("h3", {}, "Are its intervals correct on held-out boards?"),
    element("p", {}, `The rig was calibrated ${count(left_out.splits)} times with`
      + ` ${count(left_out.training_frames)} of ${count(left_out.frames)} frames, and the boards in`
      + " the other frames were measured by triangulation: rows, columns and diagonals, compared"
      + " with the known board. With a correct covariance, 95 % of the errors are inside their"
      + " 95 % interval and the RMS of error over predicted σ is 1. Inside the interval, of"
      + ` ${count(edges.lengths)} lengths: ` + by.map(({ name, suffix }) =>
        `${percent(edges[`coverage_${suffix}`])} with the ${name}`).join(", ") + `.${failed}`),
    element("div", { class: "pair table-first" }, left_out_table(left_out, by),
      coverage_bars(left_out.rows, by)),
    element("p", { class: "reading" }, "Splits share frames, so these fractions have no simple"
      + " interval. A single length also includes corner noise"
      + `${by.length > 1 ? ", equally for both covariances" : ""};`
      + " in the scale of a board (the mean of its lengths) the noise averages out and the rig's"
      + " error remains. Lengths test the rig only at the board poses."),
  ];
}

function left_out_table({ rows, boards }, by) {
  const length = (row, value) => row.unit === "m" ? `${significant(times(1e3, value), 2)} mm`
    : percent(value, 3);
  const lines = rows.flatMap((row) => by.map(({ by: name, suffix }) => ({ row, by: name,
    covered: row[`coverage_${suffix}`], z: row[`z_rms_${suffix}`],
    sigma: row[`sigma_${suffix}`] })));
  return table(`Lengths on ${count(boards)} held-out boards`, [
    { head: "Quantity", text: true, cell: (l) => l.row.what },
    { head: "Covariance", text: true, cell: (l) => l.by },
    { head: "Inside 95 %", cell: (l) => percent(l.covered) },
    { head: "Error over σ", small: "rms; expected: 1", cell: (l) => significant(l.z, 3) },
    { head: "Error", small: "rms", cell: (l) => length(l.row, l.row.error_rms) },
    { head: "Predicted σ", small: "rms", cell: (l) => length(l.row, l.sigma) },
  ], lines, { wide: false });
}

function coverage_bars(rows, by) {
  const bars = ({ name, suffix, color }) => ({ type: "bar", name, x: rows.map((row) => row.what),
    y: rows.map((row) => in_percent(row[`coverage_${suffix}`])), marker: { color },
    text: rows.map((row) => percent(row[`coverage_${suffix}`], 0)), textposition: "inside",
    insidetextfont: { color: ink_on(color) }, hovertemplate: `${name}: %{y:.1f} %<extra></extra>` });
  return figure("", "Fraction of lengths inside their 95 % interval. The line is at 95 %: the"
    + " intervals are too narrow below it, too wide above it.",
    "Coverage of 95 % intervals, as in the table.", 300,
    () => ({
      data: by.map(bars),
      layout: { bargap: 0.35, xaxis: axis("", { showgrid: false, ticks: "" }),
        yaxis: axis("inside, %", { range: [0, 100], dtick: 20 }),
        shapes: [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: 95, y1: 95,
          line: { color: COLOUR.ink, width: 1.6, dash: "dot" } }] },
    }));
}
