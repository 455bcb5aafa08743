// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { plot_text, setting } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, axis, log_axis, room_px, half_room_px, series_colour } from "./plot.js";
import { row_name, sweep_layout, swept_value } from "./sweep_layout.js";

const PANEL_PX = 270;  // a panel is not narrower

const TOP_PX = 56, BELOW_PX = 52;  // margins: titles and the bar of buttons; the axis
const GAP_PX = 62;  // between panels: an axis, its title, the next one's title

/** Number of panels beside each other. */
function columns_for(panels, room) {
  return Math.max(1, Math.min(panels, Math.floor(room / PANEL_PX)));
}

export const panel_count = (study) => sweep_layout(study).panels.length;

const room_of = (panels) => panels > 1 ? room_px() : half_room_px();

/** Height of the plot in the room there is. */
export function multiples_height(study) {
  const { x, panels } = sweep_layout(study);
  if (!x) {
    const rows = panels.reduce((sum, { cells }) => sum + cells.length, 0);
    return TOP_PX + BELOW_PX + GAP_PX * (panels.length - 1) + row_px(panels) * rows;
  }
  if (panels.length === 1) return 400;
  const rows = Math.ceil(panels.length / columns_for(panels.length, room_of(panels.length)));
  return TOP_PX + BELOW_PX + 210 * rows + GAP_PX * (rows - 1);
}

/** Height of a row, for the longest of the names. */
const row_px = (panels) => 8 + 16 * Math.max(...panels.flatMap(({ cells }) =>
  cells.map((cell) => in_lines(row_name(cell)).split("<br>").length)));

/**
 * A quantity of the cells against what is swept, in small multiples, or as rows. The quantity:
 * {title, of: cell => number, bars: cells => error bars or undefined, range, log, words: cell => text,
 * marks: cells => [{at, text}]}.
 */
export function multiples_plot(study, quantity) {
  const { x, lines, panels } = sweep_layout(study);
  return x ? against_axis(study, x, lines, panels, quantity) : as_rows(panels, quantity);
}

function against_axis(study, x, lines, panels, quantity) {
  const across = x_axis(study, x, panels.length > 1);
  const columns = columns_for(panels.length, room_of(panels.length));
  const rows = Math.ceil(panels.length / columns);
  const gap_x = columns > 1 ? 0.06 : 0;
  const gap_y = rows > 1 ? GAP_PX / (multiples_height(study) - TOP_PX - BELOW_PX) : 0;
  const wide = (1 - gap_x * (columns - 1)) / columns, high = (1 - gap_y * (rows - 1)) / rows;
  const data = [], layout = { annotations: [], shapes: [] };
  panels.forEach((panel, i) => {
    const column = i % columns, row = Math.floor(i / columns);
    const name = i ? String(i + 1) : "";
    const left = column * (wide + gap_x), top = 1 - row * (high + gap_y);
    const below = i + columns >= panels.length;
    layout[`xaxis${name}`] = { ...across.axis, domain: [left, left + wide], anchor: `y${name}`,
      ...(below ? {} : { title: { text: "" } }), ...(panels.length > 1 ? { nticks: 6 } : {}) };
    layout[`yaxis${name}`] = { ...quantity_axis(quantity, study.cells), domain: [top - high, top],
      anchor: `x${name}`, ...(column ? { title: { text: "" } } : {}) };
    const on = { xaxis: `x${name}`, yaxis: `y${name}` };
    for (const cells of panel.behind) {
      data.push({ type: "scatter", mode: "lines", ...on, x: cells.map(across.at),
        y: cells.map(quantity.of), line: { color: COLOUR.light, width: 1.5 }, hoverinfo: "skip",
        showlegend: false });
    }
    for (const line of lines_of(panel, lines, i)) {
      data.push({ ...line_trace(line, across, quantity), ...on,
        showlegend: line.name !== "" && i === 0, legendgroup: line.name });
    }
    add_marks(layout, panel.cells, quantity, name);
    if (panel.title) {
      layout.annotations.push({ xref: `x${name} domain`, yref: `y${name} domain`, x: 0, y: 1,
        xanchor: "left", yanchor: "bottom", yshift: 2, showarrow: false,
        text: `<b>${plot_text(panel.title)}</b>`, font: { size: 13 } });
    }
  });
  const several = panels.length > 1;
  layout.margin = { l: 62, r: 14, t: several ? TOP_PX : 24, b: BELOW_PX };
  if (several) {  // above the titles of the panels
    layout.legend = { orientation: "h", x: 0, xanchor: "left", yanchor: "bottom",
      y: 1 + 20 / (multiples_height(study) - TOP_PX - BELOW_PX) };
  }
  return { data, layout };
}

/** The lines of a panel: one, or one for each value of a key. */
function lines_of(panel, key, i) {
  if (!key) return [{ name: "", cells: panel.cells, colour: i }];
  const values = [...new Set(panel.cells.map((cell) => swept_value(cell, key.key)))];
  return values.map((value, k) => ({ name: `${key.label ?? key.key} = ${setting(value)}`, colour: k,
    cells: panel.cells.filter((cell) => swept_value(cell, key.key) === value) }));
}

function line_trace({ name, cells, colour }, across, quantity) {
  return { type: "scatter", mode: "lines+markers", name: plot_text(name), x: cells.map(across.at),
    y: cells.map(quantity.of), error_y: quantity.bars?.(cells),
    line: { color: series_colour(colour), width: 1.5 },
    marker: { size: 8, symbol: colour % 6, color: series_colour(colour) },
    text: cells.map(quantity.words), hovertemplate: "%{text}<extra></extra>" };
}

/** Dashed lines across a panel, with their words. */
function add_marks(layout, cells, quantity, name) {
  for (const { at, text } of quantity.marks?.(cells) ?? []) {
    layout.shapes.push({ type: "line", xref: `x${name} domain`, yref: `y${name}`, x0: 0, x1: 1,
      y0: at, y1: at, line: { color: COLOUR.ink, width: 1.2, dash: "dash" } });
    layout.annotations.push({ xref: `x${name} domain`, yref: `y${name}`, x: 1, xanchor: "right",
      y: at, yanchor: "top", yshift: -1, showarrow: false, text, font: { size: 12 } });
  }
}

/** The axis of a quantity, the same in all panels. */
function quantity_axis({ title, range, log, of }, cells) {
  const values = cells.map(of).filter(is_number);
  if (range || !values.length) return axis(title, { range: range ?? [0, 1], ...long_title(title) });
  const high = Math.max(...values);
  if (!log) return axis(title, { range: [0, high > 0 ? 1.08 * high : 1], ...long_title(title) });
  const whole = `${title} (logarithmic)`;
  return log_axis(whole, values, { ...long_title(whole),
    range: [Math.log10(Math.min(...values)) - 0.12, Math.log10(high) + 0.12] });
}

/** A title has the room of a panel's height: a long one takes several lines. */
const long_title = (title) => title.length > 32
  ? { title: { text: in_lines(title, /(?<= )/), standoff: 8 } } : {};

/** The x axis and the position of cells on it: {axis, at: cell => x}. */
function x_axis(study, { key, label }, sparse) {
  const title = label ?? key;
  const at = (cell) => swept_value(cell, key);
  const values = study.cells.map(at);
  const positive = values.filter((x) => x > 0);
  const wide = Math.max(...positive) / Math.min(...positive) > 20;
  // A logarithmic axis cannot show zero: such values are evenly spaced.
  if (wide && values.some((x) => x <= 0)) {
    return { axis: axis(title, { type: "category" }), at: (cell) => setting(at(cell)) };
  }
  if (!wide) return { axis: axis(title), at };
  return { axis: log_axis(`${title} (logarithmic)`, values, { sparse }), at };
}

/** Every cell a row with its name to the left, so that no label is turned. */
function as_rows(panels, quantity) {
  const data = [], layout = { annotations: [], shapes: [] };
  const rows = panels.reduce((sum, { cells }) => sum + cells.length, 0);
  const inner_px = GAP_PX * (panels.length - 1) + row_px(panels) * rows;
  const gap = GAP_PX / inner_px;
  let top = 1;
  panels.forEach((panel, i) => {
    const name = i ? String(i + 1) : "";
    const high = row_px(panels) * panel.cells.length / inner_px;
    const last = i + 1 === panels.length;
    layout[`yaxis${name}`] = axis("", { type: "category", autorange: "reversed", ticks: "",
      domain: [Math.max(0, top - high), top], anchor: `x${name}` });
    layout[`xaxis${name}`] = { ...quantity_axis(quantity, panels.flatMap(({ cells }) => cells)), anchor: `y${name}`,
      ...(last ? {} : { title: { text: "" } }) };
    const names = unique_names(panel.cells.map((cell) => in_lines(row_name(cell))));
    data.push({ type: "scatter", mode: "markers", xaxis: `x${name}`, yaxis: `y${name}`,
      x: panel.cells.map(quantity.of), y: names, error_x: quantity.bars?.(panel.cells),
      marker: { size: 8, symbol: i % 6, color: series_colour(i) }, showlegend: false,
      text: panel.cells.map(quantity.words), hovertemplate: "%{text}<extra></extra>" });
    if (panel.title) {
      layout.annotations.push({ xref: "paper", yref: `y${name} domain`, x: 0, y: 1, xanchor: "left",
        yanchor: "bottom", yshift: 2, showarrow: false, text: `<b>${plot_text(panel.title)}</b>`,
        font: { size: 13 } });
    }
    top -= high + gap;
  });
  layout.margin = { l: 62, r: 14, t: TOP_PX, b: BELOW_PX };
  return { data, layout };
}

/** Breaks long names: a row's label takes at most a third of a phone. */
function in_lines(text, gap = /(?<=, )/) {
  const lines = [];
  for (const word of String(text).split(gap)) {
    if (lines.length && (lines[lines.length - 1] + word).length <= 26) lines[lines.length - 1] += word;
    else lines.push(word);
  }
  return lines.map(plot_text).join("<br>");
}

/** Plotly would put rows of the same name into one. */
function unique_names(names) {
  return names.map((name, i) => name + "\u200b".repeat(names.slice(0, i).filter((n) => n === name).length));
}
