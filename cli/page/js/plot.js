// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element } from "./elements.js";
import { minus, plot_text } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, choose_theme, on_other_theme, series_colour } from "./theme.js";

export { COLOUR, series_colour };

export const have_plots = () => typeof window.Plotly !== "undefined";

// Plots are drawn once their place in the page, and so their width, is known.
const waiting_plots = [];

/** A figure: heading, caption, plot. `draw` returns {data, layout}; `spoken` is the label for screen
 * readers; `height` in pixels, or a function that returns it. Null without Plotly.
 */
export function figure(heading, reading, spoken, height, draw) {
  if (!have_plots()) return null;
  const place = element("div", { class: "plot", role: "img", "aria-label": spoken });
  waiting_plots.push(() => draw_plot(place, height, draw));
  return element("figure", {}, heading && element("h3", {}, heading),
    element("figcaption", {}, reading), place);
}

export function draw_waiting_plots() {
  waiting_plots.splice(0).forEach((draw) => draw());
}

const drawings = new Map();  // of places: how they are drawn again

export function draw_plot(place, height, draw) {
  drawings.set(place, () => draw_plot(place, height, draw));
  const { data, layout } = draw();
  const height_px = typeof height === "function" ? height() : height;
  place.style.height = `${height_px}px`;
  const config = { responsive: true, displaylogo: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };
  return Plotly.react(place, data, { ...base_layout(), ...layout, height: height_px },
    config);
}

function base_layout() {
  return {
    autosize: true,
    font: { family: "system-ui, 'Segoe UI', 'Liberation Sans', sans-serif", size: 13,
      color: COLOUR.ink },
    margin: { l: 62, r: 14, t: 14, b: 52 },
    paper_bgcolor: COLOUR.paper,
    plot_bgcolor: COLOUR.paper,
    hoverlabel: { bgcolor: COLOUR.paper, bordercolor: COLOUR.grey, font: { color: COLOUR.ink } },
    legend: { orientation: "h", x: 0, xanchor: "left", y: 1.01, yanchor: "bottom" },
  };
}

export function axis(title, more = {}) {
  return { title: { text: plot_text(title), standoff: 8 }, gridcolor: COLOUR.grid, zeroline: false,
    linecolor: COLOUR.grey, showline: true, ticks: "outside", tickcolor: COLOUR.grey,
    automargin: true, tickangle: 0, ...more };
}

/** A logarithmic axis over `values` with labelled ticks at 1, 2 and 5 times powers of ten; `sparse`:
 * at these powers if there are several. */
export function log_axis(title, values, { sparse = false, ...more } = {}) {
  const positive = values.filter((x) => is_number(x) && x > 0);
  const low = Math.floor(Math.log10(Math.min(...positive)));
  const high = Math.ceil(Math.log10(Math.max(...positive)));
  const steps = high - low > 3 || (sparse && high > low + 1) ? [1] : [1, 2, 5];
  const ticks = [];
  for (let power = low; power <= high; ++power) {
    ticks.push(...steps.map((step) => step * 10 ** power));
  }
  return axis(title, { type: "log", tickmode: "array", tickvals: ticks,
    ticktext: ticks.map((t) => minus(String(Number(t.toPrecision(3))))), ...more });
}

/** Line segments [x1, y1, x2, y2] as one trace, separated by gaps. */
export function segments_trace(segments, more) {
  const x = [], y = [];
  for (const [x1, y1, x2, y2] of segments) {
    x.push(x1, x2, null);
    y.push(y1, y2, null);
  }
  return { type: "scatter", mode: "lines", x, y, hoverinfo: "skip", ...more };
}

/** The available width of a figure, px. */
export const room_px = () =>
  Math.min(1104, document.getElementById("report").clientWidth || 1104);

/** The same for a figure next to another one on a wide page (report.css). */
export function half_room_px() {
  const narrow = window.matchMedia?.("(max-width: 860px)").matches;
  return narrow ? room_px() : (room_px() - 36) / 2;
}

/** Axes of an image: pixels, y down, square; a margin of 3 % around the frame. */
export function image_axes([width, height]) {
  const edge = 0.03 * width;
  return {
    xaxis: axis("u, px (to the right)", { range: [-edge, width + edge], showgrid: false,
      showline: false, constrain: "domain" }),
    yaxis: axis("v, px (down)", { range: [height + edge, -edge], showgrid: false,
      showline: false, scaleanchor: "x", constrain: "domain" }),
    shapes: [{ type: "rect", x0: -0.5, y0: -0.5, x1: width - 0.5, y1: height - 0.5,
      line: { color: COLOUR.ink, width: 1 }, layer: "below" }],
  };
}

// Paper is narrower than the window: 680 px fit on A4 and Letter within the margins.
const PAPER_PX = 680;
let opened_for_paper = [];

const draw_again = () => drawings.forEach((draw) => draw());

/** Plots follow the theme, and the number of small multiples beside each other the width. */
export function follow_reader() {
  on_other_theme(() => {
    choose_theme();
    draw_again();
  });
  let room = room_px(), waiting = null;
  window.addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      if (room_px() === room) return;
      room = room_px();
      draw_again();
    }, 150);
  });
}

const all_plots = () => [...document.querySelectorAll(".plot.js-plotly-plot")];

export function fit_plots_to_paper() {
  choose_theme({ paper: true });
  draw_again();
  opened_for_paper = [...document.querySelectorAll("details:not([open])")];
  opened_for_paper.forEach((closed) => { closed.open = true; });
  for (const place of all_plots()) {
    const { width, height, yaxis } = place._fullLayout;
    place.dataset.height = place.dataset.height ?? height;
    const frame_px = 110;  // legend and axis, which keep their size
    const smaller = Math.min(1, PAPER_PX / width);
    const shrunk = yaxis.scaleanchor ? frame_px + (height - frame_px) * smaller
      : Math.min(height, 340 + 0.35 * Math.max(0, height - 340));
    place.style.height = `${shrunk}px`;
    Plotly.relayout(place, { autosize: false, width: PAPER_PX, height: shrunk });
  }
}

export function fit_plots_to_window() {
  opened_for_paper.forEach((details) => { details.open = false; });
  for (const place of all_plots()) {
    const height = Number(place.dataset.height);
    place.style.height = `${height}px`;
    Plotly.relayout(place, { autosize: true, width: null, height });
  }
  choose_theme();
  draw_again();
}
