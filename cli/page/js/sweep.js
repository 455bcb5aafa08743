// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section } from "./elements.js";
import { count, percent, plot_text, range_percent } from "./format.js";
import { bars_in_percent, in_percent, is_number } from "./numbers.js";
import { figure } from "./plot.js";
import { multiples_height, multiples_plot, panel_count } from "./small_multiples.js";
import { PSI_MEANING, ceiling_of, cell_key } from "./study.js";
import { sweep_layout, swept_keys } from "./sweep_layout.js";
import { error_of, trial_words } from "./trials.js";

const SOURCE_MEANING = {
  "sources.calibration": PSI_MEANING,
  "sources.moved": "moved is the fraction of the furniture that stands elsewhere than on the map.",
  "sources.mount_height_m": "The camera's height differs from what is told by this standard deviation, in metres.",
  "sources.mount_pitch_deg": "The camera's pitch differs from what is told by this standard deviation, in degrees.",
  "sources.mount_roll_deg": "The camera's roll, told to be 0, has this standard deviation, in degrees.",
  "sources.unseen": "unseen is the fraction of the world's edges that no image shows.",
  "sources.clutter": "clutter is the number of false edges, as a fraction of the edges in view.",
  "sources.merge_px": "Parallel lines nearer than merge_px, in pixels, are detected as one.",
  "sources.lateral_shift_px": "ψ_l is the shift of edges by illumination, in pixels.",
  "sources.edge_loss": "ψ_e is the missing fraction of each edge's length.",
  "sources.endpoint_sigma_px": "ψ_g is the standard deviation of line endpoints, in pixels.",
  "sources.stereo_mismatch": "ψ_s is the fraction of edges with a wrong stereo match.",
  "sources.corner_loss": "ψ_cd is the fraction of corner pairs that are not detected.",
  "sources.corner_mismatch": "ψ_cm is the fraction of corner pairs with a wrong match.",
};

/** Success and median error against what is swept, or by cell without a sweep. */
export function sweep_section(study) {
  const keys = swept_keys(study);
  const names = keys.map(({ key, label }) => label ?? key);
  const by_design = keys.some(({ key }) => key === "design");
  const label = by_design ? "each source of error" : names.length ? and_list(names) : "the cell";
  const made = section("sweep", names.length ? `Effect of ${label}` : "Results by cell");
  for (const { key } of keys) if (SOURCE_MEANING[key]) made.append(paragraph(SOURCE_MEANING[key]));
  if (by_design) {
    made.append(paragraph("Every cell differs from its reference, the first row, in one source. All"
      + ` use the same ${trial_words(study).noun} and random numbers.`));
  }
  const plots = [success_figure(study, label), error_figure(study, label)].filter(Boolean);
  const side_by_side = panel_count(study) === 1;
  if (plots.length) made.append(element("div", { class: side_by_side ? "pair" : null }, plots));
  else made.append(paragraph("The values are in the table of all cells."));
}

const and_list = (names) => names.length < 2 ? names.join("")
  : `${names.slice(0, -1).join(", ")} and ${names[names.length - 1]}`;

export function varying_settings(cells) {
  const keys = [...new Set(cells.flatMap((cell) => Object.keys(cell.settings || {})))];
  return keys.filter((key) =>
    new Set(cells.map((cell) => JSON.stringify(cell_key(cell, key) ?? null))).size > 1);
}

/** The success of cells, as small multiples show it. */
export const success_of = (study) => ({
  title: "success, %", range: [0, 102], of: (cell) => in_percent(cell.success), bars: interval_bars,
  words: (cell) => `${plot_text(cell.label)}<br>success ${percent(cell.success)}<br>95 %: `
    + `${range_percent(cell.success_interval_95)}<br>${count(cell.trials)} trials`,
  marks: (cells) => ceiling_marks(study, cells),
});

function success_figure(study, label) {
  const ceilings = study.cells.map((cell) => ceiling_of(study, cell)).filter(is_number);
  const ceiling = ceilings.length ? " Dashed line: ceiling of the world, the most that"
    + " one look at lines allows, within 1 m." : "";
  return figure("Success", `${spread_words(study, SUCCESS)} Dots: success rate of`
    + ` a cell; bars: 95 % intervals.${ceiling}`,
    `Success rate with 95 per cent intervals against ${label}; values are in the table of`
      + " all cells.", () => multiples_height(study), () => multiples_plot(study, success_of(study)));
}

const SUCCESS = { what: "Success", key: "success", write: percent };

/** "Success ranges from 34 % (ψ_c = 10) to 89 % (ψ_c = 0.1)." */
function spread_words(study, { what, key, write }) {
  const cells = study.cells.filter((cell) => is_number(cell[key]));
  if (!cells.length) return "";
  const sorted = [...cells].sort((a, b) => a[key] - b[key]);
  const [low, high] = [sorted[0], sorted[sorted.length - 1]];
  if (cells.length === 1 || low[key] === high[key]) return `${what} is ${write(low[key])}.`;
  return `${what} ranges from ${write(low[key])} (${low.label}) to ${write(high[key])}`
    + ` (${high.label}).`;
}

function interval_bars(cells) {
  const ranges = cells.map((cell) => cell.success_interval_95);
  return bars_in_percent(cells.map((cell) => cell.success), ranges, { thickness: 1.5, width: 6 });
}

function ceiling_marks(study, cells) {
  if (!sweep_layout(study).x) return [];
  const ceilings = [...new Set(cells.map((cell) => ceiling_of(study, cell)))].filter(is_number);
  return ceilings.map((c) => ({ at: 100 * c, text: `ceiling ${percent(c)}` }));
}

function error_figure(study, label) {
  const error = error_of(study);
  if (!study.cells.some((cell) => is_number(cell[error.key]))) return null;
  const spread = spread_words(study, { ...error, what: `The median ${error.title}` });
  const { noun } = trial_words(study);
  return figure(`Median ${error.title}`, `${spread} Over all answered ${noun}, including wrong`
    + ` answers; unanswered ${noun} are excluded.`,
    `Median ${error.spoken} against ${label}; values are in the table of all cells.`,
    () => multiples_height(study),
    () => error_plot(study, error));
}

function error_plot(study, { title, key, axis, write }) {
  const values = study.cells.map((cell) => cell[key]).filter(is_number);
  const wide = Math.max(...values) / Math.min(...values) > 20 && Math.min(...values) > 0;
  return multiples_plot(study, { title: axis, log: wide, of: (cell) => cell[key],
    words: (cell) => `${plot_text(cell.label)}<br>median ${plot_text(title)}`
      + ` ${write(cell[key])}` });
}
