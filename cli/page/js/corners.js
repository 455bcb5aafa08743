// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { cells_trace, image_height, magnification } from "./corner_cells.js";
import { element, table } from "./elements.js";
import { count, counted, fixed, percent } from "./format.js";
import { upper } from "./numbers.js";
import { COLOUR, figure, image_axes, segments_trace } from "./plot.js";
import { histogram_figure, mean_figure } from "./residual_pattern.js";

/** Corner coverage and residuals of a calibration. */
export function corners_content(rig) {
  const cameras = rig.corners.filter((one) => one.points?.length);
  const scale = residual_scale(cameras);
  return [
    element("p", {}, "A calibration is reliable only where corners were observed, and its"
      + " covariance only describes noise: empty image regions are extrapolated, and systematic"
      + " residuals indicate an error of the lens model, the board or the corners that is not"
      + " included in the uncertainties below."),
    residuals_table(cameras),
    ...cameras.map((one) => element("div", { class: "pair" }, coverage_figure(one),
      residual_figure(one, scale))),
    ...cameras.map((one) => element("div", { class: "pair" }, mean_figure(one),
      histogram_figure(one))),
  ];
}

function residuals_table(cameras) {
  const rows = cameras.map((one) => ({ ...one, empty: one.structure.counts.filter((n) => !n).length,
    cells: one.structure.counts.length }));
  return table("Corners and residuals by camera; cells as in the figures below", [
    { head: "Camera", text: true, cell: (row) => row.camera },
    { head: "Corners", small: "used", cell: (row) => count(row.corners) },
    { head: "Outliers", small: "rejected", cell: (row) => count(row.outliers.length) },
    { head: "Empty cells", small: "of the image",
      cell: (row) => `${count(row.empty)} of ${count(row.cells)}` },
    { head: "Cells off zero", small: "expected: 5 %",
      cell: ({ structure: s }) => `${count(s.beyond_95)} of ${count(s.filled)}` },
    { head: "Beyond 3 σ", small: "normal distribution: 0.27 %",
      cell: ({ structure: s }) => percent(s.beyond_3_sigma, 2) },
  ], rows, { wide: false });
}

const thinned_words = ({ points, corners }) => points.length < corners
  ? ` ${count(points.length)} of ${count(corners)} corners are shown, evenly sampled.` : "";

function coverage_figure(one) {
  const outliers = one.outliers.length
    ? ` Crosses: ${counted(one.outliers.length, "corner")} rejected as outliers.` : "";
  return figure(`Corner coverage, ${one.camera} camera`, "All corners used; darker cells contain"
    + ` more corners. Orange cells contain none: the calibration is extrapolated`
    + ` there.${outliers}${thinned_words(one)}`,
    `Corners of the ${one.camera} camera over its image; the table above counts empty cells.`,
    image_height(one.size_px), () => coverage_plot(one));
}

function coverage_plot(one) {
  const { structure, size_px, points, outliers } = one;
  const most = Math.max(1, ...structure.counts);
  const data = [
    cells_trace(one, structure.counts, { zmin: 0, zmax: most, showscale: false,
      colorscale: [[0, "#fbe3d0"], [0.5 / most, "#fbe3d0"], [0.5 / most, "#eef5fa"],
        [1, "#8fc3e3"]],
      hovertemplate: "%{z} corners in this cell<extra></extra>" }),
    { type: "scatter", mode: "markers", name: "corner used", showlegend: true,
      x: points.map((p) => p[0]), y: points.map((p) => p[1]),
      marker: { color: COLOUR.ink, size: 3, opacity: 0.75 },
      hovertemplate: "(%{x:.1f}, %{y:.1f}) px<extra></extra>" },
    { type: "scatter", mode: "markers", name: "outlier, rejected", x: outliers.map((o) => o[0]),
      y: outliers.map((o) => o[1]), marker: { color: COLOUR.red, size: 9, symbol: "x-thin",
        line: { color: COLOUR.red, width: 2.2 } },
      text: outliers.map((o) => `frame ${o[3]}, corner ${o[4]}, ${fixed(o[2], 1)} px off`),
      hovertemplate: "%{text}<extra></extra>" },
  ];
  return { data: data.filter((trace) => trace.x.length),
    layout: { ...image_axes(size_px), hovermode: "closest" } };
}

/** One magnification for all cameras, so that their figures are comparable. */
function residual_scale(cameras) {
  const lengths = cameras.flatMap((one) => one.points.map((p) => Math.hypot(p[2], p[3])));
  return magnification(upper(lengths, 0.95), Math.max(...cameras.map((one) => one.size_px[0])),
    0.05);
}

function residual_figure(one, scale) {
  return figure(`Residual vectors, ${one.camera} camera`, "Each stroke starts at a corner and"
    + ` shows its residual (prediction minus corner), magnified ${count(scale)} times.`
    + ` Random directions indicate noise; neighbouring strokes in the same direction indicate a`
    + ` systematic error.${thinned_words(one)}`,
    `${one.points.length} residual vectors of the ${one.camera} camera.`,
    image_height(one.size_px), () => residual_plot(one, scale));
}

function residual_plot({ points, size_px }, scale) {
  const strokes = points.map(([u, v, du, dv]) => [u, v, u + scale * du, v + scale * dv]);
  return {
    data: [
      segments_trace(strokes, { name: `residual × ${count(scale)}`,
        line: { color: COLOUR.red, width: 1.3 } }),
      { type: "scatter", mode: "markers", name: "corner", x: points.map((p) => p[0]),
        y: points.map((p) => p[1]), marker: { color: COLOUR.ink, size: 3 },
        text: points.map((p) => `residual ${fixed(p[2], 2)}, ${fixed(p[3], 2)} px`),
        hovertemplate: "(%{x:.1f}, %{y:.1f}) px<br>%{text}<extra></extra>" },
    ],
    layout: { ...image_axes(size_px), hovermode: "closest" },
  };
}
