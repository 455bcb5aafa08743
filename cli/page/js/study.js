// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, findings, paragraph, part_id, section, small, table } from "./elements.js";
import {
  DASH, count, counted, fixed, metres, milliseconds, p_value, percent, range_percent,
  significant,
} from "./format.js";
import { is_number } from "./numbers.js";
import { radius_of_cells, radius_words, test_words, trial_words } from "./trials.js";

const PROTOCOLS = {
  near_path: "queries up to 0.1 m from the recorded route, heading within ± 5° of it",
  path: "queries up to 0.3 m from the recorded route, heading within ± 15° of it",
  anywhere: "queries up to 0.6 m from the recorded route, any heading",
  free: "queries anywhere on the floor that can be reached from the route, any heading",
};

const METHODS = {
  lines: "recorded lines compared in the image",
  pgh: "pairwise geometric histograms, verified",
  pgh_baseline: "pairwise geometric histograms, baseline",
  pgh_baseline_vectorised: "pairwise geometric histograms, baseline with SIMD",
};

export const PSI_MEANING = "ψ_c is the scale factor for the standard deviations of the rig's"
  + " calibration: 1 uses its covariance unchanged, 0.1 is ten times better, 10 ten times worse.";

export const cell_key = (cell, key) => (cell.settings || {})[key];

/** Rigs whose error is given, or that are calibrated for a trial, are not drawn from a covariance. */
export const psi_note = (cell) => cell_key(cell, "sources.calibration") === 1
  && cell_key(cell, "rig.error") !== "given" && cell_key(cell, "calibration.views") === undefined
  && " ψ_c = 1 uses the covariance of the rig's calibration unchanged.";

/** The cell with ψ_c = 1, otherwise the first. */
export function headline_cell(study) {
  const nominal = study.cells.find((cell) => cell_key(cell, "sources.calibration") === 1);
  return nominal || study.cells[0];
}

/** The world of a cell: a study may sweep worlds. */
export const world_of = (report, cell) => report.worlds?.[cell?.world] ?? report.world;

export const ceiling_of = (study, cell) => cell.world_ceiling ?? study.world_ceiling;
const protocol_of = (study, cell) => cell.protocol || study.protocol;

export function headline(report) {
  const study = report.study;
  const cell = headline_cell(study);
  headline_box({
    study,
    heading: study.cells.length > 1 ? `Localisation success at ${at_words(cell)}`
      : "Localisation success",
    share: cell.success,
    of: `of queries localised within ${radius_words(cell)} of the true position`,
    words: headline_words(study, cell),
    tiles: headline_tiles(report, cell),
  });
}

/** The first section of a study: its success, in figures and in words, and tiles. */
export function headline_box({ study, heading, share, of, words, tiles }) {
  const id = part_id("headline");
  const box = element("section", { id, class: "headline", "aria-labelledby": `${id}-heading` },
    element("h2", { id: `${id}-heading` }, heading),
    element("div", {}, element("div", { class: "figure" }, percent(share)), paragraph(of)),
    element("div", { class: "words" }, words,
      findings("Reasons not to trust these results", study.doubts),
      findings("Warnings", study.warnings)),
    element("dl", { class: "tiles" }, tiles));
  document.getElementById("report").append(box);
}

export const at_words = (cell) => cell.label === "as set" ? "the settings of the study" : cell.label;

function headline_words(study, cell) {
  const words = [`In ${counted(cell.trials, "trial")}, the robot localised itself within`
    + ` ${radius_words(cell)} of its true position ${percent(cell.success)} of the time.`,
  interval_words(cell)];
  const clustered = cell.success_interval_95 && cell.success_interval_binomial_95;
  const notes = ["Unanswered queries count as failures; heading is not evaluated."];
  if (clustered) {
    notes.push(" The interval accounts for trials that share a recorded map.");
  }
  notes.push(psi_note(cell));
  return [element("p", {}, words), element("p", {}, notes)];
}

export function interval_words(cell) {
  const range = cell.success_interval_95;
  if (range) {
    return ` The 95 % confidence interval is ${percent(range[0])} to ${percent(range[1])}.`;
  }
  const missing = cell.success_interval_95_missing;
  return missing ? ` No confidence interval: ${missing}.` : null;
}

function headline_tiles(report, cell) {
  const study = report.study;
  const protocol = protocol_of(study, cell);
  const ceiling = ceiling_of(study, cell);
  const method = cell_key(cell, "localiser.method") ?? study.method;
  const world = world_of(report, cell)?.name ?? cell_key(cell, "world.file");
  return [
    tile("Query protocol", protocol, PROTOCOLS[protocol]),
    tile("World", world, is_number(ceiling) && `ceiling ${percent(ceiling)}: the most that`
      + ` one look at lines allows, within 1 m`),
    tile("Median error", metres(cell.median_error_m), is_number(cell.median_heading_error_deg)
      && `and ${significant(cell.median_heading_error_deg, 2)}° in heading, of answered queries`),
    tile("CPU time per query", milliseconds(cell.cpu_ms_mean), is_number(cell.cpu_ms_p95)
      && `mean; 95 % take less than ${milliseconds(cell.cpu_ms_p95)}`),
    tile("Trials", count(cell.trials), study.cells.length > 1
      && `in each of ${study.cells.length} cells`),
    tile("Method", method, METHODS[method]),
  ];
}

export function tile(name, value, rest) {
  if (value === undefined || value === null || value === DASH) return null;
  return element("div", {}, element("dt", {}, name), element("dd", {}, value),
    rest && element("dd", { class: "rest" }, rest));
}

export const cell_words = (study, shared) =>
  `A cell is one combination of settings${study.same_queries ? `; all cells ${shared}` : ""}. `;

/** Success over the worlds of a sweep of them. */
export function over_worlds_tables(study) {
  const rows = study.over_worlds ?? [];
  return rows.length === 0 ? [] : [table("Results over all worlds", [
    { head: "Cells", text: true, cell: (row) => row.label },
    { head: "Worlds", cell: (row) => count(row.worlds) },
    { head: "Success", small: "95 % interval for further worlds like these", cell: (row) => [
      percent(row.success), small(row.success_interval_95
        ? range_percent(row.success_interval_95) : row.success_interval_95_missing)] },
  ], rows, { wide: false })];
}

export function cells_section(report) {
  const study = report.study;
  const headline_of_study = headline_cell(study);
  const several = study.cells.length > 1;
  const made = section("cells", several ? "All cells" : "Results of the trials", paragraph(
    several && cell_words(study, "use the same queries"),
    `Success: position within ${radius_of_cells(study)} of the truth; unanswered queries count as`
      + " failures. Coverage:"
      + " fraction of answered queries. Errors are medians over answered queries. CPU time is"
      + " from features in memory to the answer."));
  made.append(table(cells_caption(study), cell_columns(study), study.cells,
    { chosen: (cell) => several && cell === headline_of_study }));
  made.append(...over_worlds_tables(study));
}

export const cells_caption = (study) => study.cells.length > 1
  ? `Results by cell; ${headline_cell(study).label} is the headline` : "Results";

export const share_column = (head, key, small) =>
  ({ head, small, cell: (cell) => percent(cell[key]) });

/** The first columns of every table of cells. */
export const outcome_columns = () => [
  { head: "Cell", text: true, cell: (cell) => cell.label ?? DASH },
  { head: "Trials", cell: (cell) => count(cell.trials) },
  { head: "Success", small: "95 % interval", cell: (cell) => [percent(cell.success),
    cell.success_interval_95 && small(range_percent(cell.success_interval_95))] },
  { head: "Binomial", small: "assuming independent trials",
    cell: (cell) => range_percent(cell.success_interval_binomial_95) },
];

export function time_columns() {
  const time = (head, key, small) =>
    ({ head, small, cell: (cell) => significant(cell[key]) });
  return [
    time("CPU ms", "cpu_ms_mean", "mean"), time("CPU ms", "cpu_ms_median", "median"),
    time("CPU ms", "cpu_ms_p95", "95 % below"), time("Wall ms", "wall_ms_mean", "mean"),
  ];
}

function cell_columns(study) {
  const one_ceiling = new Set(study.cells.map((cell) => ceiling_of(study, cell))).size === 1;
  return [
    ...outcome_columns(),
    { head: "Ceiling", small: "of the world, 1 m", cell: (cell) =>
      one_ceiling ? DASH : percent(ceiling_of(study, cell)) },
    share_column("Coverage", "coverage"),
    share_column("Success", "success_when_answered", "of answered"),
    share_column("Node found", "node_success", "map node within 1 m"),
    { head: "Error", small: "median", cell: (cell) => metres(cell.median_error_m) },
    { head: "Heading", small: "median error", cell: (cell) =>
      is_number(cell.median_heading_error_deg)
        ? `${significant(cell.median_heading_error_deg, 2)}°` : DASH },
    share_column("Recall", "recall_0_5m_5deg", "0.5 m, 5°"),
    share_column("Recall", "recall_0_25m_2deg", "0.25 m, 2°"),
    ...time_columns(),
  ];
}

export function comparisons_section(study) {
  const test = test_words(study,
    study.comparisons[0]?.test ?? "McNemar's test, assuming independent trials");
  const words = trial_words(study);
  const made = section("comparisons", "Paired comparisons", paragraph(
    `All cells use the same ${words.noun} and random numbers, so paired comparisons are more`
      + ` sensitive: they count ${words.only_one}. p is the probability of`
      + ` a difference at least this large if neither cell were better (${test}).`));
  if (study.comparisons.some((row) => "p_value_holm" in row)) {
    made.append(paragraph("With several comparisons a small p may occur by chance. Holm's p is"
      + " adjusted for their number: a cell is called better if it is below 0.05. If all cells are"
      + " equal, that happens anywhere in the table with a probability of at most 5 %."));
  } else if (study.comparisons.length > 3) {
    made.append(paragraph(`With ${study.comparisons.length} comparisons, a p below 0.05 may occur`
      + " by chance; p is not corrected for multiple comparisons."));
  }
  const both_count = (head, key) => ({ head, cell: (row) => count(row[key]) });
  made.append(table(words.one_both_neither, [
    { head: "Cell A against cell B", text: true, cell: (row) => `${row.a} against ${row.b}` },
    both_count("Both", "both"), both_count("Only A", "only_a"), both_count("Only B", "only_b"),
    both_count("Neither", "neither"),
    { head: "A minus B", small: "success, percentage points", cell: (row) => points(row) },
    { head: "p", small: "unadjusted", cell: (row) => p_value(p_of(row)) },
    { head: "p", small: "adjusted (Holm)", cell: (row) => p_value(row.p_value_holm) },
    { head: "Conclusion", text: true, cell: verdict },
  ], study.comparisons));
}

const difference = (row) =>
  (row.only_a - row.only_b) / (row.only_a + row.only_b + row.both + row.neither);

function points(row) {
  const d = 100 * difference(row);
  return is_number(d) ? `${d > 0 ? "+" : ""}${fixed(d, 1)}` : DASH;
}

/** p by map if available; older results only have McNemar's p. */
const p_of = (row) => ("p_value" in row ? row.p_value : row.mcnemar_p);

function verdict(row) {
  const p = "p_value_holm" in row ? row.p_value_holm : p_of(row);
  if (!is_number(p)) return DASH;
  if (p >= 0.05) return "no significant difference";
  return difference(row) > 0 ? `${row.a} is better` : `${row.b} is better`;
}
