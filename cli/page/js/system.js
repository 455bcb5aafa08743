// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section, small, table } from "./elements.js";
import { DASH, count, counted, milliseconds, percent, setting, significant } from "./format.js";
import { is_number } from "./numbers.js";
import {
  at_words, cell_key, cell_words, cells_caption, headline_box, headline_cell, interval_words,
  outcome_columns, over_worlds_tables, psi_note, share_column, tile, time_columns,
} from "./study.js";
import { error_of, limit_words, one_limit } from "./trials.js";

// Studies of other systems than localisers: calibrations, matchers, servoing robots, programs.

const upper_first = (text) => text.charAt(0).toUpperCase() + text.slice(1);

export function system_headline({ study }) {
  const cell = headline_cell(study);
  headline_box({
    study,
    heading: study.cells.length > 1 ? `Success at ${at_words(cell)}` : "Success",
    share: cell.success,
    of: `of trials whose ${study.system.title} is ${limit_words(study, cell)}`,
    words: headline_words(study, cell),
    tiles: headline_tiles(study, cell),
  });
}

function headline_words(study, cell) {
  const notes = ["Trials without an answer count as failures."];
  if (cell.success_interval_95 && is_number(cell.blocks)) {
    notes.push(` The interval takes ${count(cell.blocks)} blocks of trials as independent.`);
  }
  notes.push(psi_note(cell));
  return [element("p", {}, `In ${percent(cell.success)} of ${counted(cell.trials, "trial")}, the`
    + ` ${study.system.title} was ${limit_words(study, cell)}.`, interval_words(cell)),
  element("p", {}, notes)];
}

function headline_tiles(study, cell) {
  const error = error_of(study);
  const title = upper_first(error.title);
  return [
    tile("System", study.system.name, system_detail(study, cell)),
    tile("World", cell_key(cell, "world.file")),
    tile(`${title}, median`, error.write(cell.median_error), "of answered trials"),
    tile(`${title}, 95 % below`, error.write(cell.p95_error), "of answered trials"),
    tile("CPU time per trial", milliseconds(cell.cpu_ms_mean), is_number(cell.cpu_ms_p95)
      && `mean; 95 % take less than ${milliseconds(cell.cpu_ms_p95)}`),
    tile("Trials", count(cell.trials), study.cells.length > 1
      && `in each of ${study.cells.length} cells`),
    tile("Failed", cell.failed ? counted(cell.failed, "trial") : null, "without a result"),
  ];
}

/** What most tells one system of a kind from another. */
function system_detail(study, cell) {
  const of = (key) => cell_key(cell, `system.${key}`);
  const details = {
    calibration: () => is_number(of("range_m")) && `depth at ${setting(of("range_m"))} m`,
    matcher: () => of("matcher") === "program" ? of("command") : of("matcher"),
    program: () => of("command"),
    servoing: () => of("goal") && `goal: ${of("goal")}`,
  };
  return details[study.system.name]?.();
}

export function system_cells_section(study) {
  const several = study.cells.length > 1;
  const { title } = study.system;
  const limit = one_limit(study) ? limit_words(study, study.cells[0]) : "at most the cell's limit";
  const made = section("cells", several ? "All cells" : "Results of the trials", paragraph(
    several && cell_words(study, "have the same trials"),
    `Success: ${title} ${limit}; trials without an answer count as failures. Coverage: fraction of`
      + ` trials with an answer. Failed: trials without a result. Error: ${title} of answered`
      + " trials. CPU time: mean of the trials."));
  const headline_of_study = headline_cell(study);
  made.append(table(cells_caption(study), cell_columns(study), study.cells,
    { chosen: (cell) => several && cell === headline_of_study }));
  made.append(...over_worlds_tables(study), ...failures_tables(study), ...measured_tables(study));
}

function cell_columns(study) {
  const { write } = error_of(study);
  const error = (key, small) => ({ head: "Error", small, cell: (cell) => write(cell[key]) });
  return [
    ...outcome_columns(),
    { head: "Limit", small: "of the error",
      cell: (cell) => one_limit(study) ? DASH : limit_words(study, cell) },
    share_column("Coverage", "coverage"),
    share_column("Success", "success_when_answered", "of answered"),
    { head: "Failed", cell: (cell) => count(cell.failed) },
    error("median_error", "median"), error("p95_error", "95 % below"),
    ...time_columns(),
  ];
}

function failures_tables(study) {
  const rows = study.cells.filter((cell) => cell.failed > 0 && cell.why_failed);
  return rows.length === 0 ? [] : [table("Why trials failed", [
    { head: "Cell", text: true, cell: (cell) => cell.label ?? DASH },
    { head: "Failed", cell: (cell) => count(cell.failed) },
    { head: "Reason", small: "of the first", text: true, cell: (cell) => cell.why_failed },
  ], rows, { wide: false })];
}

const MOST_QUANTITIES = 7;  // beside each other, on paper

function measured_tables(study) {
  const { cells } = study;
  const names = [...new Set(cells.flatMap((cell) => Object.keys(cell.measured ?? {})))];
  const tables = [];
  for (let i = 0; i < names.length; i += MOST_QUANTITIES) {
    const rest = i ? ", continued"
      : " (each over the trials in which it is known; RMS: root mean square)";
    tables.push(table(`What the trials measured${rest}`, [
      { head: "Cell", text: true, cell: (cell) => cell.label ?? DASH },
      ...names.slice(i, i + MOST_QUANTITIES).map(measured_column),
    ], cells, { wide: false }));
  }
  const meanings = study.system.measured ?? {};
  const explained = names.filter((name) => Object.hasOwn(meanings, name));
  if (explained.length) {
    tables.push(table("What these quantities are", [
      { head: "Quantity", text: true, cell: (name) => element("code", {}, name) },
      { head: "Meaning", text: true, cell: (name) => meanings[name] },
    ], explained, { wide: false }));
  }
  return tables;
}

const measured_column = (name) => ({
  head: element("code", {}, name), small: "median",
  cell: (cell) => measured_words(cell.measured?.[name], cell.trials),
});

function measured_words(measured, trials) {
  if (!measured?.trials) return DASH;
  return [significant(measured.median), small(`mean ${significant(measured.mean)}`),
    small(`RMS ${significant(measured.rms)}`),
    measured.trials < trials && small(counted(measured.trials, "trial"))];
}
