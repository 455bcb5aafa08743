// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section, small, table } from "./elements.js";
import {
  DASH, count, counted, fixed, metres, milliseconds, p_value, percent, range_percent,
  significant,
} from "./format.js";
import { is_number } from "./numbers.js";

const PROTOCOLS = {
  near_path: "queries up to 0.1 m off the recorded route, heading within ± 5° of it",
  path: "queries up to 0.3 m off the recorded route, heading within ± 15° of it",
  anywhere: "queries up to 0.6 m off the recorded route, any heading",
};

const METHODS = {
  pgh: "pairwise geometric histograms, verified",
  pgh_baseline: "pairwise geometric histograms, baseline",
};

export const PSI_MEANING = "ψ_c is the factor on the standard deviations of the rig's calibration: 1"
  + " takes the calibration to be as uncertain as its covariance says, 0.1 ten times better,"
  + " 10 ten times worse.";

export const cell_key = (cell, key) => (cell.settings || {})[key];

/** The cell with ψ_c as calibrated, else the first. */
export function headline_cell(study) {
  const nominal = study.cells.find((cell) => cell_key(cell, "sources.calibration") === 1);
  return nominal || study.cells[0];
}

export const ceiling_of = (study, cell) => cell.world_ceiling ?? study.world_ceiling;
const protocol_of = (study, cell) => cell.protocol || study.protocol;

export function headline(report) {
  const study = report.study;
  const cell = headline_cell(study);
  const box = element("section", { id: "headline", "aria-labelledby": "headline-heading" },
    element("h2", { id: "headline-heading" },
      study.cells.length > 1 ? `Localisation success at ${cell.label}` : "Localisation success"),
    element("div", {}, element("div", { class: "figure" }, percent(cell.success)),
      paragraph("of queries answered within 1 m of the truth")),
    element("div", { class: "words" }, headline_words(study, cell)),
    element("dl", { class: "tiles" }, headline_tiles(report, cell)));
  document.getElementById("report").append(box);
}

function headline_words(study, cell) {
  const range = cell.success_interval_95;
  const words = [`In ${counted(cell.trials, "trial")} the robot placed itself within 1 m of where`
    + ` it stood ${percent(cell.success)} of the time.`];
  if (range) {
    words.push(` With 95 % confidence the rate lies between ${percent(range[0])} and`
      + ` ${percent(range[1])}.`);
  } else if (cell.success_interval_95_missing) {
    words.push(` The rate has no interval: it ${cell.success_interval_95_missing}.`);
  }
  const clustered = cell.success_interval_95 && cell.success_interval_binomial_95;
  const notes = ["An unanswered query counts as a failure; heading is not judged."];
  if (clustered) {
    notes.push(" The interval allows for trials that share a recorded map.");
  }
  if (cell_key(cell, "sources.calibration") === 1) {
    notes.push(" ψ_c = 1 takes the rig's calibration to be as uncertain as its covariance says.");
  }
  return [element("p", {}, words), element("p", {}, notes)];
}

function headline_tiles(report, cell) {
  const study = report.study;
  const protocol = protocol_of(study, cell);
  const ceiling = ceiling_of(study, cell);
  const method = cell_key(cell, "localiser.method") ?? study.method;
  const world = report.world?.name ?? cell_key(cell, "world.file");
  return [
    tile("Query protocol", protocol, PROTOCOLS[protocol]),
    tile("World", world, is_number(ceiling) && `its ceiling is ${percent(ceiling)}: what an `
      + "exhaustive search without noise reaches"),
    tile("Median error", metres(cell.median_error_m), is_number(cell.median_heading_error_deg)
      && `and ${significant(cell.median_heading_error_deg, 2)}° in heading, of answered queries`),
    tile("CPU time a query", milliseconds(cell.cpu_ms_mean), is_number(cell.cpu_ms_p95)
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

export function cells_section(report) {
  const study = report.study;
  const headline_of_study = headline_cell(study);
  const several = study.cells.length > 1;
  const made = section("cells", several ? "All cells" : "Figures of the trials", paragraph(
    several && "A cell is one choice of settings, run on the same queries as the others. ",
    "Success: the answer lies within 1 m of the truth, unanswered queries counting as"
    + " failures. Coverage: the share of queries that got an answer."
    + " Errors are medians over answered queries. CPU time runs from features in memory to"
    + " the answer."));
  made.append(table(several ? `Results by cell; ${headline_of_study.label} is the headline`
    : "Results", cell_columns(study), study.cells,
    { chosen: (cell) => several && cell === headline_of_study }));
}

function cell_columns(study) {
  const share = (head, key, small) =>
    ({ head, small, cell: (cell) => percent(cell[key]) });
  const time = (head, key, small) =>
    ({ head, small, cell: (cell) => significant(cell[key]) });
  const one_ceiling = new Set(study.cells.map((cell) => ceiling_of(study, cell))).size === 1;
  return [
    { head: "Cell", text: true, cell: (cell) => cell.label ?? DASH },
    { head: "Trials", cell: (cell) => count(cell.trials) },
    { head: "Success", small: "95 % interval", cell: (cell) => [percent(cell.success),
      cell.success_interval_95 && small(range_percent(cell.success_interval_95))] },
    { head: "Binomial", small: "if trials were independent",
      cell: (cell) => range_percent(cell.success_interval_binomial_95) },
    { head: "Ceiling", small: "of the world", cell: (cell) =>
      one_ceiling ? DASH : percent(ceiling_of(study, cell)) },
    share("Coverage", "coverage"),
    share("Success", "success_when_answered", "of answered"),
    share("Place found", "node_success", "map place within 1 m"),
    { head: "Error", small: "median", cell: (cell) => metres(cell.median_error_m) },
    { head: "Heading", small: "median error", cell: (cell) =>
      is_number(cell.median_heading_error_deg)
        ? `${significant(cell.median_heading_error_deg, 2)}°` : DASH },
    share("Recall", "recall_0_5m_5deg", "0.5 m, 5°"),
    share("Recall", "recall_0_25m_2deg", "0.25 m, 2°"),
    time("CPU ms", "cpu_ms_mean", "mean"), time("CPU ms", "cpu_ms_median", "median"),
    time("CPU ms", "cpu_ms_p95", "95 % below"), time("Wall ms", "wall_ms_mean", "mean"),
  ];
}

export function comparisons_section(study) {
  const test = study.comparisons[0]?.test ?? "McNemar's test, trials taken as independent";
  const made = section("comparisons", "Paired comparisons", paragraph(
    "Cells ran on the same queries with the same random numbers, so the sharper question is where"
    + " they disagree: queries that only one of the two answered within 1 m. p is the chance"
    + ` of a split at least this uneven if neither cell were better (${test}).`));
  if (study.comparisons.some((row) => "p_value_holm" in row)) {
    made.append(paragraph("Where cells are compared several times, one small p is to be expected by"
      + " chance. The p of Holm is adjusted for the number of comparisons: a cell is called the better"
      + " one where it is below 0.05. If all cells are alike, that happens in any row with a"
      + " probability of at most 5 %."));
  } else if (study.comparisons.length > 3) {
    made.append(paragraph(`With ${study.comparisons.length} comparisons, one p below 0.05 is to be`
      + " expected now and then by chance; p is not corrected for their number."));
  }
  const both_count = (head, key) => ({ head, cell: (row) => count(row[key]) });
  made.append(table("Queries by which of the two cells answered within 1 m", [
    { head: "Cell A against cell B", text: true, cell: (row) => `${row.a} against ${row.b}` },
    both_count("Both", "both"), both_count("Only A", "only_a"), both_count("Only B", "only_b"),
    both_count("Neither", "neither"),
    { head: "A less B", small: "points of success", cell: (row) => points(row) },
    { head: "p", small: "by itself", cell: (row) => p_value(p_of(row)) },
    { head: "p", small: "adjusted, Holm", cell: (row) => p_value(row.p_value_holm) },
    { head: "In words", text: true, cell: verdict },
  ], study.comparisons));
}

const difference = (row) =>
  (row.only_a - row.only_b) / (row.only_a + row.only_b + row.both + row.neither);

function points(row) {
  const d = 100 * difference(row);
  return is_number(d) ? `${d > 0 ? "+" : ""}${fixed(d, 1)}` : DASH;
}

/** By map where the study says so; older results have McNemar's alone. */
const p_of = (row) => ("p_value" in row ? row.p_value : row.mcnemar_p);

function verdict(row) {
  const p = "p_value_holm" in row ? row.p_value_holm : p_of(row);
  if (!is_number(p)) return DASH;
  if (p >= 0.05) return "no difference shown";
  return difference(row) > 0 ? `${row.a} is better` : `${row.b} is better`;
}
