// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { paragraph, section } from "./elements.js";
import { count, counted, fixed } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, figure, image_axes, room_px, segments_trace } from "./plot.js";

/** One camera image: the true edges, and the sensed edges that the localiser gets. */
export function view_section(view) {
  const made = section("view", "Simulated camera view");
  if (view.words) made.append(paragraph(view.words));
  const sensed = view.sensed ?? [];
  const wrong = sensed.filter((s) => s[4]).length;
  const [x, y, heading_deg] = view.pose ?? [];
  const where = is_number(x) ? ` Robot pose: x = ${fixed(x, 2)} m, y = ${fixed(y, 2)} m,`
    + ` heading ${fixed(heading_deg, 1)}° (counter-clockwise from x).` : "";
  made.append(paragraph(`Left camera: ${counted((view.true ?? []).length, "visible edge")},`
    + ` ${counted(sensed.length, "edge segment")} passed to the localiser,`
    + ` ${count(wrong)} of them with a wrong stereo match.${where}`));
  const drawn = figure("", "Thin grey lines: edges as seen by a perfect camera. Coloured lines:"
    + " edges after simulated detection and line-fit errors. Gaps and missing lines are lost"
    + " edges; lines in the second colour have a wrong stereo match and get a wrong depth. Drag a"
    + " box to zoom in on line ends and shifts; click a legend entry to hide it.",
    "One camera image with true and sensed line segments.", view_height(view),
    () => view_plot(view));
  if (drawn) made.append(drawn);
}

function view_height({ camera_size_px: [width, height] }) {
  const legend = room_px() < 500 ? 80 : 0;  // one legend entry per line
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
      { name: "sensed, wrong stereo match", line: { color: COLOUR.red, width: 3 } }),
    { type: "scatter", mode: "markers", name: "corners", x: corners.map((c) => c[0]),
      y: corners.map((c) => c[1]), marker: { color: COLOUR.green, size: 5, symbol: "square-open" },
      hovertemplate: "corner (%{x:.1f}, %{y:.1f}) px<extra></extra>" },
  ];
  return { data: data.filter((trace) => trace.x.length),
    layout: { ...image_axes(view.camera_size_px), hovermode: "closest" } };
}
