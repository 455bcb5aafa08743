// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { NBSP, metres, setting, significant } from "./format.js";
import { is_number } from "./numbers.js";

// What the trials of a study are called and how their error is told: a localiser's are queries,
// with an error in metres; another system (study.system) names its error and its unit, which may
// be empty.

const queries = (radius) => ({
  noun: "queries",
  only_one: `queries that only one of two cells localised within ${radius}`,
  one_both_neither: `Queries localised within ${radius} by one, both or neither of the two cells`,
});

const TRIALS = {
  noun: "trials",
  only_one: "trials that succeeded in only one of two cells",
  one_both_neither: "Trials that succeeded in one, both or neither of the two cells",
};

/** Up to which distance from its true position a query of the cell is localised: "1 m". */
export const radius_words = (cell) => `${setting(cell?.success_error ?? 1)}${NBSP}m`;

/** Whether all cells have one limit of success. */
export const one_limit = ({ cells }) => new Set(cells.map((cell) => cell.success_error)).size === 1;

/** The same distance in words for all cells of a study. */
export const radius_of_cells = (study) =>
  one_limit(study) ? radius_words(study.cells[0]) : "the cell's limit";

export const trial_words = (study) => study.system ? TRIALS : queries(radius_of_cells(study));

/** Other systems have blocks of trials where localisers have recorded maps. */
export const test_words = (study, test) => study.system ? test.replace("maps", "blocks") : test;

const beside_unit = (text, unit, gap) => unit ? `${text}${gap}${unit}` : text;

/**
 * The error of a study's trials: {title, spoken, key, axis, write}. `spoken` is its title for
 * screen readers, `key` that of its median in cells.
 */
export function error_of({ system }) {
  if (!system) {
    return { title: "error", spoken: "position error", key: "median_error_m",
      axis: "median error, m", write: metres };
  }
  const { title, unit } = system;
  return { title, spoken: title, key: "median_error",
    axis: beside_unit(`median ${title}`, unit, ", "),
    write: (x) => is_number(x) ? beside_unit(significant(x), unit, NBSP) : significant(x) };
}

/** "at most 0.05 m": up to which error a cell's trials succeed. */
export const limit_words = ({ system }, cell) =>
  `at most ${beside_unit(setting(cell.success_error), system.unit, NBSP)}`;

/** When a trial of the cell succeeds. */
export const success_words = (study, cell) =>
  study.system ? `${study.system.title} ${limit_words(study, cell)}`
    : `error at most ${radius_words(cell)}`;
