// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { paragraph, section } from "./elements.js";
import { count, counted, fixed } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, figure, image_axes, room_px, segments_trace } from "./plot.js";

/** One camera image: the edges as they are, and as the localiser was given them. */
export function view_section(view) {
  const made = section("view", "What the camera is given");
  if (view.words) made.append(paragraph(view.words));
  const sensed = view.sensed ?? [];
  const wrong = sensed.filter((s) => s[4]).length;
  const [x, y, heading_deg] = view.pose ?? [];
  const where = is_number(x) ? ` The robot stands at x = ${fixed(x, 2)} m, y = ${fixed(y, 2)} m,`
    + ` heading ${fixed(heading_deg, 1)}° (counter-clockwise from x).` : "";
  made.append(paragraph(`One look, by the left camera: ${counted((view.true ?? []).length, "edge")}`
    + ` in view, ${counted(sensed.length, "piece")} of edges handed to the localiser,`
    + ` ${count(wrong)} of them with a wrong stereo partner.${where}`));
  const drawn = figure("", "Thin grey lines are the edges of the world as a perfect camera would"
    + " see them; coloured lines are what is left of them after detection and line-fit errors."
    + " Gaps and missing lines are edges lost; lines in the second colour will be placed at a"
    + " wrong depth. Zoom in (drag a box) to see line ends and shifts; a click on an"
    + " entry of the legend hides it.",
    "One camera image with true and sensed line segments.", view_height(view),
    () => view_plot(view));
  if (drawn) made.append(drawn);
}

function view_height({ camera_size_px: [width, height] }) {
  const legend = room_px() < 500 ? 80 : 0;  // an entry a line there
  const needed = 100 + legend + (room_px() - 80) * height / width;
  return Math.round(Math.max(300, Math.min(680, needed)));
}

function view_plot(view) {
  const sensed = view.sensed ?? [];
  const corners = view.corners ?? [];
  const data = [
    segments_trace(view.true ?? [], { name: "true edges", line: { color: COLOUR.grey, width: 1 } }),
    segments_trace(sensed.filter((s) => !s[4]),
      { name: "sensed", line: { color: COLOUR.blue, width: 2.2 } }),
    segments_trace(sensed.filter((s) => s[4]),
      { name: "sensed, wrong stereo partner", line: { color: COLOUR.red, width: 3 } }),
    { type: "scatter", mode: "markers", name: "corners", x: corners.map((c) => c[0]),
      y: corners.map((c) => c[1]), marker: { color: COLOUR.green, size: 5, symbol: "square-open" },
      hovertemplate: "corner (%{x:.1f}, %{y:.1f}) px<extra></extra>" },
  ];
  return { data: data.filter((trace) => trace.x.length),
    layout: { ...image_axes(view.camera_size_px), hovermode: "closest" } };
}
