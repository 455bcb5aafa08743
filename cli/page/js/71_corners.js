// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

/** Where a calibration's corners lie, and what the model leaves of them unexplained. */
function corners_content(rig) {
  const cameras = rig.corners.filter((one) => one.points?.length);
  const scale = residual_scale(cameras);
  return [
    element("p", {}, "A calibration knows its cameras where it saw corners, and its covariance"
      + " speaks of noise alone: an empty part of the image is extrapolated, and residuals that"
      + " follow a pattern are a fault of the model, the board or the corners that no number"
      + " below covers."),
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
  return table("Corners and residuals by camera; cells are those of the pictures below", [
    { head: "Camera", text: true, cell: (row) => row.camera },
    { head: "Corners", small: "used", cell: (row) => count(row.corners) },
    { head: "Outliers", small: "left out", cell: (row) => count(row.outliers.length) },
    { head: "Empty cells", small: "of the image",
      cell: (row) => `${count(row.empty)} of ${count(row.cells)}` },
    { head: "Cells off zero", small: "noise gives 5 %",
      cell: ({ structure: s }) => `${count(s.beyond_95)} of ${count(s.filled)}` },
    { head: "Beyond 3 σ", small: "a normal error has 0.27 %",
      cell: ({ structure: s }) => percent(s.beyond_3_sigma, 2) },
  ], rows, { wide: false });
}

const thinned_words = ({ points, corners }) => points.length < corners
  ? ` ${count(points.length)} of ${count(corners)} corners are drawn, spread evenly.` : "";

const image_height = ([width, height]) => Math.round(118 + 450 * height / width);

/** Centres of a structure's columns or rows, in pixels. */
const cell_centres = (cells, size) =>
  Array.from({ length: cells }, (_, i) => (i + 0.5) * size / cells - 0.5);

/** A structure's list as rows of a heat map. */
function grid_of({ columns, rows }, list) {
  return Array.from({ length: rows }, (_, y) => list.slice(y * columns, (y + 1) * columns));
}

/** The image's cells as a heat map below whatever else is drawn. */
const cells_trace = ({ structure, size_px }, list, more) => ({
  type: "heatmap", x: cell_centres(structure.columns, size_px[0]),
  y: cell_centres(structure.rows, size_px[1]), z: grid_of(structure, list), xgap: 1, ygap: 1,
  ...more,
});

function coverage_figure(one) {
  const outliers = one.outliers.length
    ? ` Crosses are the ${counted(one.outliers.length, "corner")} left out as outliers.` : "";
  return figure(`Corner coverage, ${one.camera} camera`, "Every corner used, on the image; the"
    + " darker a cell, the more corners are in it. Orange cells have none: what the calibration"
    + ` says there is extrapolated.${outliers}${thinned_words(one)}`,
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
    { type: "scatter", mode: "markers", name: "outlier, left out", x: outliers.map((o) => o[0]),
      y: outliers.map((o) => o[1]), marker: { color: COLOUR.red, size: 9, symbol: "x-thin",
        line: { color: COLOUR.red, width: 2.2 } },
      text: outliers.map((o) => `frame ${o[3]}, corner ${o[4]}, ${fixed(o[2], 1)} px off`),
      hovertemplate: "%{text}<extra></extra>" },
  ];
  return { data: data.filter((trace) => trace.x.length),
    layout: { ...image_axes(size_px), hovermode: "closest" } };
}

/** 1, 2 or 5 times a power of ten that makes `long` about `share` of the image's width. */
function magnification(long, width, share) {
  if (!(long > 0)) return 1;
  const wanted = share * width / long;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const step = [5, 2, 1].find((s) => s * power <= wanted) ?? 1;
  return Math.max(1, step * power);
}

const upper = (lengths, share) =>
  lengths.sort((a, b) => a - b)[Math.floor(share * (lengths.length - 1))];

/** One magnification for all cameras, so that their pictures compare. */
function residual_scale(cameras) {
  const lengths = cameras.flatMap((one) => one.points.map((p) => Math.hypot(p[2], p[3])));
  return magnification(upper(lengths, 0.95), Math.max(...cameras.map((one) => one.size_px[0])),
    0.05);
}

function residual_figure(one, scale) {
  return figure(`Residual vectors, ${one.camera} camera`, "Each stroke starts at a corner and is"
    + ` what the calibrated model leaves of it unexplained (prediction less corner), drawn`
    + ` ${count(scale)} times as long as it is. Strokes that point every way are noise;`
    + ` neighbours that point the same way are not.${thinned_words(one)}`,
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

function mean_figure(one) {
  const { structure, size_px } = one;
  const filled = structure.mean.filter((_, i) => structure.counts[i] > 2);
  const scale = magnification(upper(filled.map(([x, y]) => Math.hypot(x, y)), 0.95), size_px[0],
    0.9 / structure.columns);
  return figure(`Mean residual by place, ${one.camera} camera`, "Arrows are the mean residual"
    + ` of the corners in a cell (of three or more), ${count(scale)} times as long. The colour`
    + " says how many standard deviations it lies from zero: independent noise passes 2.4 in one"
    + ` cell of twenty. Here ${count(structure.beyond_95)} of ${count(structure.filled)} cells`
    + ` do, where ${fixed(0.05 * structure.filled, 0)} are expected.`,
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

function histogram_figure(one) {
  const { structure: s } = one;
  return figure(`Residuals against the normal, ${one.camera} camera`, "Residuals of both"
    + " coordinates, counted in standard deviations of the corner noise. The line is what a"
    + ` normal error would give. Beyond 3 σ: ${percent(s.beyond_3_sigma, 2)}, of a normal error`
    + " 0.27 %. A tall middle with long tails means that some views or corners are noisier than"
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
      xaxis: axis("residual, σ (beyond ± 5 in the outermost bars)",
        { showgrid: false, dtick: 1 }),
      yaxis: axis("coordinates", { rangemode: "tozero" }) },
  };
}
