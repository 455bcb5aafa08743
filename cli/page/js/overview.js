// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { paragraph, section, small, table } from "./elements.js";
import { DASH, count, percent, range_percent } from "./format.js";
import { figure } from "./plot.js";
import { multiples_height, multiples_plot } from "./small_multiples.js";
import { cell_key, world_of } from "./study.js";
import { success_of } from "./sweep.js";
import { swept_keys } from "./sweep_layout.js";
import { error_of, success_words } from "./trials.js";

/** More cells make a figure that nobody reads; each study has its own below. */
const MOST_ROWS = 40;

/** All cells of several studies in one figure and one table. */
export function overview_section(studies) {
  const others = studies.some(({ study }) => study.system);
  const made = section("studies", "All studies", paragraph(`Each study has its own`
    + ` ${others ? "trials" : "queries"}: only cells of one study are compared in pairs.`));
  const together = joined(studies);
  if (together.cells.length <= MOST_ROWS) {
    const drawn = figure("Success in all studies", "Dots: success rate of a cell; bars: 95 %"
      + " intervals.", "Success rate with 95 per cent intervals of all cells of all studies; values"
      + " are in the table below.", () => multiples_height(together),
    () => multiples_plot(together, success_of(together)));
    if (drawn) made.append(drawn);
  }
  made.append(table("Cells of all studies", overview_columns(others), studies.flatMap((one) =>
    one.study.cells.map((cell) => ({ ...one, cell })))));
}

/** `others`: there are other systems than localisers, with a success and an error of their own. */
function overview_columns(others) {
  const of_others = (text) => others ? text : DASH;
  return [
    { head: "Study", text: true, cell: ({ name }) => name },
    { head: "Cell", text: true, cell: ({ cell }) => cell.label ?? DASH },
    { head: "System", text: true,
      cell: ({ study }) => of_others(study.system?.name ?? "localiser") },
    { head: "World", text: true, cell: (one) => world_of(one, one.cell)?.name
      ?? cell_key(one.cell, "world.file") ?? DASH },
    { head: "Protocol", text: true,
      cell: ({ cell }) => cell.protocol ?? cell_key(cell, "study.protocol") ?? DASH },
    { head: "Trials", cell: ({ cell }) => count(cell.trials) },
    { head: "Success", small: "95 % interval", cell: ({ cell }) => [percent(cell.success),
      cell.success_interval_95 && small(range_percent(cell.success_interval_95))] },
    { head: "Success means", text: true,
      cell: ({ study, cell }) => of_others(success_words(study, cell)) },
    { head: "Error", small: "median", cell: ({ study, cell }) => median_error(study, cell) },
  ];
}

function median_error(study, cell) {
  const { key, write } = error_of(study);
  return write(cell[key]);
}

/** One study of the cells of all, with the study as a swept key, the last. */
function joined(studies) {
  const keys = new Map();
  for (const { study } of studies) for (const one of swept_keys(study)) keys.set(one.key, one);
  const shared = [...keys.values()].filter(({ key }) => studies.every(({ study }) =>
    swept_keys(study).some((one) => one.key === key)));
  const same = shared.length === keys.size;
  const cells = studies.flatMap(({ name, study }) => study.cells.map((cell) => ({ ...cell,
    swept: { ...cell.swept, study: name } })));
  if (!same) return { cells, swept_keys: [] };
  return { cells, swept_keys: [...keys.values(), { key: "study", label: "study" }] };
}
