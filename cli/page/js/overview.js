// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { paragraph, section, small, table } from "./elements.js";
import { DASH, count, metres, percent, range_percent } from "./format.js";
import { figure } from "./plot.js";
import { multiples_height, multiples_plot } from "./small_multiples.js";
import { world_of } from "./study.js";
import { success_of } from "./sweep.js";
import { swept_keys } from "./sweep_layout.js";

/** More cells make a figure that nobody reads; each study has its own below. */
const MOST_ROWS = 40;

/** All cells of several studies in one figure and one table. */
export function overview_section(studies) {
  const made = section("studies", "All studies", paragraph("Each study has its own queries: only"
    + " cells of one study are compared in pairs."));
  const together = joined(studies);
  if (together.cells.length <= MOST_ROWS) {
    const drawn = figure("Success in all studies", "Dots: success rate of a cell; bars: 95 %"
      + " intervals.", "Success rate with 95 per cent intervals of all cells of all studies; values"
      + " are in the table below.", () => multiples_height(together),
    () => multiples_plot(together, success_of(together)));
    if (drawn) made.append(drawn);
  }
  made.append(table("Cells of all studies", [
    { head: "Study", text: true, cell: ({ study }) => study },
    { head: "Cell", text: true, cell: ({ cell }) => cell.label ?? DASH },
    { head: "World", text: true, cell: ({ world }) => world ?? DASH },
    { head: "Protocol", text: true, cell: ({ cell }) => cell.protocol ?? DASH },
    { head: "Trials", cell: ({ cell }) => count(cell.trials) },
    { head: "Success", small: "95 % interval", cell: ({ cell }) => [percent(cell.success),
      cell.success_interval_95 && small(range_percent(cell.success_interval_95))] },
    { head: "Error", small: "median", cell: ({ cell }) => metres(cell.median_error_m) },
  ], studies.flatMap((one) => one.study.cells.map((cell) =>
    ({ study: one.name, world: world_of(one, cell)?.name, cell })))));
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
