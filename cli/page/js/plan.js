// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { chooser, element, nodes_of, paragraph, section } from "./elements.js";
import { count, metres, percent } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, axis, draw_plot, figure, have_plots, room_px, segments_trace } from "./plot.js";
import { headline_cell, world_of } from "./study.js";
import { radius_words } from "./trials.js";

const PLAN_CUT_M = 2.3;       // higher edges, above doors, are omitted for clarity
const SHOWN_ERROR_M = 0.1;    // shorter errors would be hidden by the dots

/** How the outcomes of a cell's trials are drawn. */
const marks_of = (cell) => ({
  success: { name: `within ${radius_words(cell)}`, color: COLOUR.blue, symbol: "circle", size: 6 },
  failure: { name: `failed: error above ${radius_words(cell)}`, color: COLOUR.red, symbol: "x",
    size: 8 },
  silent: { name: "failed: no answer", color: COLOUR.amber, symbol: "diamond-open", size: 9 },
});

/** A row of a cell's trial_list as an object. */
function trial_of([trial, x, y, , answer_x, answer_y, , error_m, success]) {
  const outcome = success ? "success" : is_number(answer_x) ? "failure" : "silent";
  return { trial, x, y, answer_x, answer_y, error_m, outcome };
}

export function plan_section(report) {
  const shown = headline_cell(report.study);
  const about = element("div", {}, world_words(world_of(report, shown)));
  const made = section("plan", "Successes and failures on the map", about);
  const cells = (report.study?.cells ?? []).filter((cell) => cell.trial_list?.length);
  if (!have_plots()) {
    made.append(...cells.map((cell) => paragraph(plan_words(cell))));
    return;
  }
  if (!cells.length) {
    made.append(figure("", "Plan of the world with the route along which the map is recorded.",
      "Plan of the world", plan_height(report, shown), () => plan_plot(report, shown)));
    return;
  }
  const first = Math.max(0, cells.indexOf(shown));
  const note = element("p", { "aria-live": "polite" }, plan_words(cells[first]));
  const drawn = figure("", "Dots are true query positions. For failures and errors above 0.1 m, a"
    + " line leads to the estimated position. Clusters of failures indicate similar-looking"
    + " locations or too little structure. Hover over a dot for its trial number and error; click"
    + " a legend entry to hide it.",
    "Plan of the world with the queries, coloured by success, and lines to wrong estimates.",
    plan_height(report, cells[first]), () => plan_plot(report, cells[first]));
  const choose = (i) => {
    note.replaceChildren(...nodes_of(plan_words(cells[i])));
    about.replaceChildren(...nodes_of(world_words(world_of(report, cells[i]))));
    draw_plot(drawn.querySelector("div.plot"), plan_height(report, cells[i]),
      () => plan_plot(report, cells[i]));
  };
  if (cells.length > 1) {
    made.append(chooser("Cell shown:", cells.map((cell) => cell.label), first, choose));
  }
  made.append(note, drawn);
}

function world_words(world) {
  const counts = world?.counts;
  if (!counts) return null;
  const parts = [["segments", "straight edges"], ["corners", "corners"], ["surfaces", "surfaces"],
    ["objects", "objects"]].filter(([key]) => is_number(counts[key]))
    .map(([key, noun]) => `${count(counts[key])} ${noun}`);
  const repeated = is_number(counts.repeated_share)
    ? ` ${percent(counts.repeated_share, 0)} of the edges belong to repeated objects`
      + " (doors, windows, desks), which make locations look alike." : "";
  return paragraph(`The world${world.name ? ` “${world.name}”` : ""} has ${parts.join(", ")}.`
    + repeated);
}

function plan_words(cell) {
  const trials = cell.trial_list.map(trial_of);
  const number = (outcome) => trials.filter((t) => t.outcome === outcome).length;
  const first = cell.trials > trials.length ? `, the first of ${count(cell.trials)}` : "";
  return `${cell.label ? `${cell.label}: ` : ""}${count(trials.length)} queries shown${first}:`
    + ` ${count(number("success"))} localised within ${radius_words(cell)},`
    + ` ${count(number("failure"))} wrong and`
    + ` ${count(number("silent"))} unanswered.`;
}

/** Box around the world of a cell and the trials in it, of all cells: they are looked at in turn. */
function plan_extent(report, chosen) {
  const world = world_of(report, chosen);
  const points = (world?.segments ?? []).flatMap((s) => [[s[0], s[1]], [s[3], s[4]]]);
  for (const cell of report.study?.cells ?? []) {
    if (world_of(report, cell) !== world) continue;
    for (const row of cell.trial_list ?? []) points.push([row[1], row[2]]);
  }
  for (const leg of world?.route ?? []) points.push(...leg);
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) {
    box[0] = Math.min(box[0], x);
    box[1] = Math.min(box[1], y);
    box[2] = Math.max(box[2], x);
    box[3] = Math.max(box[3], y);
  }
  const [x0, y0, x1, y1] = points.length ? box : [0, 0, 1, 1];
  const edge = 0.03 * Math.max(x1 - x0, y1 - y0, 1);
  return { x: [x0 - edge, x1 + edge], y: [y0 - edge, y1 + edge] };
}

function plan_height(report, cell) {
  const { x, y } = plan_extent(report, cell);
  const width = room_px() - 80;
  const legend = width < 500 ? 130 : 0;  // one legend entry per line
  const height = 110 + width * (y[1] - y[0]) / (x[1] - x[0]);
  return Math.round(Math.max(320, Math.min(860, height + legend)));
}

function plan_plot(report, cell) {
  const { x, y } = plan_extent(report, cell);
  const world = world_of(report, cell);
  const low = (world?.segments ?? [])
    .filter((s) => Math.max(s[2], s[5]) < PLAN_CUT_M);
  const data = [
    segments_trace(low.map((s) => [s[0], s[1], s[3], s[4]]),
      { name: "edges of the world", line: { color: COLOUR.light, width: 1 } }),
    route_trace(world?.route ?? []),
    ...trial_traces((cell?.trial_list ?? []).map(trial_of), marks_of(cell)),
  ];
  const layout = {
    xaxis: axis("x, m", { range: x, showgrid: false, showline: false, constrain: "domain" }),
    yaxis: axis("y, m", { range: y, showgrid: false, showline: false, scaleanchor: "x",
      constrain: "domain" }),
    hovermode: "closest",
  };
  return { data: data.filter((trace) => trace.x.length), layout };
}

function route_trace(legs) {
  const x = legs.flatMap((leg) => [...leg.map((p) => p[0]), null]);
  const y = legs.flatMap((leg) => [...leg.map((p) => p[1]), null]);
  return { type: "scatter", mode: "lines", name: "recorded route", x, y, hoverinfo: "skip",
    line: { color: COLOUR.green, width: 2, dash: "dot" } };
}

function trial_traces(trials, marks) {
  const answered = trials.filter((t) => is_number(t.answer_x));
  const lines = (chosen, name, color, width) => segments_trace(
    chosen.map((t) => [t.x, t.y, t.answer_x, t.answer_y]),
    { name, line: { color, width }, opacity: 0.65 });
  return [
    lines(answered.filter((t) => t.outcome === "failure"), "to the wrong estimate", COLOUR.red, 1),
    lines(answered.filter((t) => t.outcome === "success" && t.error_m > SHOWN_ERROR_M),
      "error above 0.1 m", COLOUR.blue, 1.5),
    ...Object.keys(marks).map((outcome) =>
      dots_trace(trials.filter((t) => t.outcome === outcome), marks[outcome])),
  ];
}

function dots_trace(trials, { name, color, symbol, size }) {
  return {
    type: "scatter", mode: "markers", name, x: trials.map((t) => t.x), y: trials.map((t) => t.y),
    marker: { color, symbol, size, line: { color: symbol === "circle" ? "#fff" : color,
      width: symbol.endsWith("open") ? 2 : 0.6 } },
    text: trials.map((t) => `trial ${t.trial}<br>`
      + (is_number(t.error_m) ? `error ${metres(t.error_m)}` : "no answer")),
    hovertemplate: "%{text}<extra></extra>",
  };
}
