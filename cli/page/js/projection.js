// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { depth_part } from "./depth.js";
import { element, table } from "./elements.js";
import { significant } from "./format.js";
import { is_number, upper } from "./numbers.js";
import { COLOUR, figure, room_px } from "./plot.js";

/** Effect of the covariance on projected points (maps in pixels) and on depth. */
export function projection_content(rig) {
  const { projection } = rig;
  if (!projection) return [depth_part(rig)];
  const range = colour_range(projection.cameras);
  const [nearest, , farthest] = projection.boards_m;
  return [
    element("p", {}, "If the calibration were repeated with the same board poses, a point fixed"
      + " to the boards would be projected to a slightly different pixel each time. The maps show"
      + " the standard deviation of this pixel in its worst direction, from the joint covariance"
      + " of rig and board poses. It is smallest in the image region and at the"
      + ` distance of the boards (${significant(nearest, 2)} to ${significant(farthest, 2)} m`
      + " here), and grows towards the image border and outside this range. Model error is not"
      + " included."),
    ...projection.cameras.map((one) => projection_figure(one, range)),
    projection_table(projection),
    depth_part(rig),
  ];
}

const distance_words = (d) => is_number(d) ? `${significant(d, 2)} m` : "infinity";

function projection_table({ cameras }) {
  const rows = cameras.flatMap((one) => one.figures.map((row) => ({ ...row, camera: one.camera })));
  const bound = rows.some((row) => is_number(row.centre_bound_px))
    ? " The bound includes corner noise only." : "";
  return table(`Standard deviation of a projected point, px, in its worst direction.${bound}`, [
    { head: "Camera", text: true, cell: (row) => row.camera },
    { head: "Distance", text: true, cell: (row) => distance_words(row.distance_m)
      + (row.boards ? " (board distance)" : "") },
    { head: "Centre", small: "of the image", cell: (row) => significant(row.centre_px, 2) },
    { head: "Centre", small: "bound", cell: (row) => significant(row.centre_bound_px, 2) },
    { head: "Median", small: "of the image", cell: (row) => significant(row.median_px, 2) },
    { head: "Median", small: "bound", cell: (row) => significant(row.median_bound_px, 2) },
    { head: "Worst", small: "in the image", cell: (row) => significant(row.worst_px, 2) },
  ], rows, { wide: false });
}

/** One logarithmic colour range for all maps, in powers of ten; the top 2 % are clipped. */
function colour_range(cameras) {
  const sds = cameras.flatMap((one) => one.maps.flatMap((map) => map.sd_px.flat()))
    .filter((sd) => sd > 0);
  return [Math.log10(Math.min(...sds)), Math.log10(upper(sds, 0.98))];
}

function projection_figure(one, range) {
  const across = room_px() < 700 ? 1 : one.maps.length;
  const width = (room_px() - 70) / across;
  const rows = one.maps.length / across;
  const height = Math.round(70 + rows * (20 + 0.86 * width * one.size_px[1] / one.size_px[0]));
  return figure(`Projection uncertainty, ${one.camera} camera`, "Standard deviation of the"
    + " projected pixel over the image, at three distances along the ray. All maps use the same"
    + " colours (darkest: this value or more); lines are contours of equal uncertainty, with"
    + " different steps in each map."
    + (one.figures.some((row) => row.absent > 0) ? " Blank regions cannot be unprojected: the"
    + " lens distortion model folds over there." : ""),
    `Maps of the projection uncertainty of the ${one.camera} camera; values are in the`
    + " table below.", height, () => projection_plot(one, range, across));
}

function projection_plot(one, [low, high], across) {
  const rows = one.maps.length / across;
  const data = [], layout = { margin: { l: 8, r: 8, t: 30, b: 8 }, annotations: [],
    showlegend: false };
  one.maps.forEach((map, i) => {
    const name = i ? String(i + 1) : "";
    const column = i % across, row = Math.floor(i / across);
    const x = [column / across + 0.008, (column + 1) / across - 0.008 - 0.012];
    const y = [1 - (row + 1) / rows + 0.03, 1 - row / rows - (rows > 1 ? 0.05 : 0)];
    data.push(...map_traces(one, map, [low, high], name, i === one.maps.length - 1));
    layout[`xaxis${name}`] = { domain: x, anchor: `y${name}`, showgrid: false, zeroline: false,
      showticklabels: false, ticks: "", constrain: "domain", range: [-0.5, one.size_px[0] - 0.5] };
    layout[`yaxis${name}`] = { domain: y, anchor: `x${name}`, showgrid: false, zeroline: false,
      showticklabels: false, ticks: "", scaleanchor: `x${name}`, constrain: "domain",
      range: [one.size_px[1] - 0.5, -0.5] };
    layout.annotations.push({ text: is_number(map.distance_m) ? `at ${map.distance_m} m`
      : "at infinity", showarrow: false, xref: `x${name} domain`, yref: `y${name} domain`, x: 0.5,
      y: 1.01, yanchor: "bottom", font: { size: 14 } });
  });
  return { data, layout };
}

function map_traces(one, map, [low, high], name, with_bar) {
  const place = { x: one.x_px, y: one.y_px, xaxis: `x${name}`, yaxis: `y${name}` };
  const ticks = colour_ticks(low, high);
  const sds = map.sd_px.flat().filter((sd) => sd > 0);
  const step = contour_step(Math.min(...sds), upper([...sds], 0.9));
  return [
    { type: "heatmap", ...place, zsmooth: "best", zmin: low, zmax: high, showscale: with_bar,
      z: map.sd_px.map((row) => row.map((sd) => sd > 0 ? Math.log10(sd) : null)),
      customdata: map.sd_px,
      colorscale: [[0, "#f7fbff"], [0.35, "#c6dff0"], [0.7, "#6fb1d8"], [1, "#2f83bd"]],
      colorbar: { thickness: 10, len: 0.95, outlinewidth: 0, tickvals: ticks.map(Math.log10),
        ticktext: ticks.map(String), title: { text: "px", side: "top" } },
      hovertemplate: "(%{x:.0f}, %{y:.0f}) px: %{customdata:.3g} px<extra></extra>" },
    { type: "contour", ...place, z: map.sd_px, showscale: false, hoverinfo: "skip",
      contours: { coloring: "none", showlabels: true, start: step, end: 12 * step, size: step,
        labelfont: { size: 11, color: COLOUR.ink } },
      line: { color: COLOUR.ink, width: 0.9, smoothing: 0.8 } },
  ];
}

/** Round tick values between two powers of ten: 1, 2 and 5, or finer if these are too few. */
function colour_ticks(low, high) {
  const among = (steps) => [-4, -3, -2, -1, 0, 1, 2, 3]
    .flatMap((power) => steps.map((step) => Number((step * 10 ** power).toPrecision(2))))
    .filter((t) => Math.log10(t) >= low && Math.log10(t) <= high);
  const coarse = among([1, 2, 5]);
  return coarse.length > 2 ? coarse : among([1, 1.5, 2, 3, 4, 5, 7]);
}

/** A round step for about six contour lines. */
function contour_step(low, high) {
  const wanted = Math.max(1e-6, (high - low) / 6);
  const power = 10 ** Math.floor(Math.log10(wanted));
  return ([1, 2, 5].find((s) => s * power >= wanted) ?? 10) * power;
}
