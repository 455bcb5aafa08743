// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { cell_centres, cells_trace, image_height, magnification } from "./corner_cells.js";
import { count, fixed, percent } from "./format.js";
import { upper } from "./numbers.js";
import { COLOUR, axis, figure, image_axes, segments_trace } from "./plot.js";

export function mean_figure(one) {
  const { structure, size_px } = one;
  const filled = structure.mean.filter((_, i) => structure.counts[i] > 2);
  const scale = magnification(upper(filled.map(([x, y]) => Math.hypot(x, y)), 0.95), size_px[0],
    0.9 / structure.columns);
  return figure(`Mean residual by image region, ${one.camera} camera`, "Arrows: mean residual"
    + ` of cells with at least three corners, magnified ${count(scale)} times. Colour: distance`
    + " from zero in standard deviations; independent noise exceeds 2.4 in one cell of twenty."
    + ` Here ${count(structure.beyond_95)} of ${count(structure.filled)} cells exceed it,`
    + ` ${fixed(0.05 * structure.filled, 0)} are expected.`,
    `Mean residuals of the ${one.camera} camera over its image.`, image_height(size_px),
    () => mean_plot(one, scale));
}

function mean_plot(one, scale) {
  const { structure, size_px } = one;
  const x = cell_centres(structure.columns, size_px[0]);
  const y = cell_centres(structure.rows, size_px[1]);
  const arrows = structure.mean.flatMap(([du, dv], i) => structure.counts[i] > 2
    ? arrow(x[i % structure.columns], y[Math.floor(i / structure.columns)], scale * du, scale * dv)
    : []);
  return {
    data: [
      cells_trace(one, structure.in_sigmas.map((s, i) => structure.counts[i] ? s : null), {
        zmin: 0, zmax: 8, colorscale: [[0, "#ffffff"], [0.3, "#fdf3df"], [0.31, "#fbdca4"],
          [1, COLOUR.amber]],
        colorbar: { thickness: 10, len: 0.9, outlinewidth: 0, tickvals: [0, 2.4, 4, 6, 8],
          ticktext: ["0", "2.4", "4", "6", "8 +"], title: { text: "σ", side: "top" } },
        hovertemplate: "mean is %{z:.1f} σ from zero<extra></extra>" }),
      segments_trace(arrows, { name: `mean residual × ${count(scale)}`, showlegend: true,
        line: { color: COLOUR.ink, width: 1.6 } }),
    ],
    layout: { ...image_axes(size_px), hovermode: "closest" },
  };
}

/** An arrow as line segments. */
function arrow(x, y, dx, dy) {
  const length = Math.hypot(dx, dy);
  if (!(length > 0)) return [];
  const head = Math.min(0.35 * length, 9) / length;
  const barb = (side) => [x + dx, y + dy, x + dx - head * (dx + 0.6 * side * dy),
    y + dy - head * (dy - 0.6 * side * dx)];
  return [[x, y, x + dx, y + dy], barb(1), barb(-1)];
}

export function histogram_figure(one) {
  const { structure: s } = one;
  return figure(`Residuals and normal distribution, ${one.camera} camera`,
    "Residuals of both coordinates, in standard deviations of the corner noise. Line: normal"
      + " distribution. The outermost bars include everything beyond ± 5 σ."
    + ` Beyond 3 σ: ${percent(s.beyond_3_sigma, 2)}; normal distribution:`
    + " 0.27 %. A high peak with heavy tails means that some views or corners are noisier than"
    + " others.", `Histogram of residuals of the ${one.camera} camera.`,
    image_height(one.size_px), () => histogram_plot(one));
}

function histogram_plot({ structure: { histogram, first_edge, bin }, corners }) {
  const x = histogram.map((_, i) => first_edge + (i + 0.5) * bin);
  const normal = (t) => 2 * corners * bin * Math.exp(-t * t / 2) / Math.sqrt(2 * Math.PI);
  const fine = Array.from({ length: 201 }, (_, i) => first_edge * (1 - i / 100));
  return {
    data: [
      { type: "bar", name: "residuals", x, y: histogram, marker: { color: COLOUR.sky },
        hovertemplate: "%{y} at %{x:.2f} σ<extra></extra>" },
      { type: "scatter", mode: "lines", name: "normal", x: fine, y: fine.map(normal),
        line: { color: COLOUR.ink, width: 1.6 }, hoverinfo: "skip" },
    ],
    layout: { bargap: 0.06,
      xaxis: axis("residual, σ", { showgrid: false, dtick: 1 }),
      yaxis: axis("coordinates", { rangemode: "tozero" }) },
  };
}
