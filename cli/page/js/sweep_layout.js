// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { setting } from "./format.js";
import { is_number } from "./numbers.js";
import { cell_key } from "./study.js";

/**
 * How the cells of a sweep are shown: {x, lines, panels}. `x` is the key of the axis, the one with
 * most numbers; null without one, and for designs of one source at a time: cells are then rows.
 * `lines` is the key of the lines of a panel, `panels` a list of {title, cells, behind}: small
 * multiples, one for each value of the remaining keys. With two keys every panel has one line, with
 * those of the others in grey behind it.
 */
export function sweep_layout(study) {
  const keys = swept_keys(study);
  const numeric = keys.filter(({ key }) => key !== "value"
    && values_of(study, key).every(is_number));
  const is_design = keys.some(({ key }) => key === "design");
  if (is_design || !numeric.length) return { x: null, lines: null, panels: row_panels(study, keys) };
  const count = ({ key }) => values_of(study, key).length;
  const x = numeric.reduce((best, one) => count(one) > count(best) ? one : best);
  const rest = keys.filter((one) => one !== x);
  if (rest.length < 2) {
    const panels = groups(study.cells, rest);
    return { x, lines: null, panels: panels.map((panel) => ({ ...panel,
      behind: panels.filter((other) => other !== panel).map((other) => other.cells) })) };
  }
  const fitting = rest.filter((one) => count(one) <= 6);
  const lines = fitting.length ? fitting[fitting.length - 1] : rest[rest.length - 1];
  return { x, lines, panels: groups(study.cells, rest.filter((one) => one !== lines)) };
}

export function swept_keys(study) {
  if (study.swept_keys) return study.swept_keys;
  return study.sweep ? [study.sweep] : [];
}

/** A cell's value of a swept key. */
export const swept_value = (cell, key) => cell.swept?.[key] ?? cell_key(cell, key);

/** The different values of a key, in the order of the cells. */
export const values_of = (study, key) =>
  [...new Set(study.cells.map((cell) => swept_value(cell, key)))];

const label_of = ({ key, label }) => label ?? key;

/** Cells with the same values of some keys: {title, cells}. */
export function groups(cells, keys) {
  const found = new Map();
  for (const cell of cells) {
    const title = keys.map((one) => `${label_of(one)} = ${setting(swept_value(cell, one.key))}`)
      .join(", ");
    if (!found.has(title)) found.set(title, []);
    found.get(title).push(cell);
  }
  return [...found].map(([title, of]) => ({ title, cells: of, behind: [] }));
}

const DESIGNS = { only: "only this source", "all but": "all but this source",
  swept: "this source swept, beside all others" };

/** Rows: one panel of all cells; for designs, one for each of them, below its reference. */
function row_panels(study, keys) {
  if (!keys.some(({ key }) => key === "design")) {
    const of_studies = study.cells.filter((cell) => cell.swept?.study);
    return groups(study.cells, of_studies.length ? [{ key: "study" }] : []);
  }
  const others = keys.filter(({ key }) => !["design", "source", "value"].includes(key));
  return groups(study.cells, others).flatMap(({ title, cells }) => {
    const of = (design) => cells.filter((cell) => cell.swept.design === design);
    return Object.entries(DESIGNS).filter(([design]) => of(design).length).map(([design, words]) => ({
      title: [title, words].filter(Boolean).join(": "), behind: [],
      cells: [...of(design === "only" ? "no source" : "as set"), ...of(design)] }));
  });
}

/** What a row is called. */
export function row_name(cell) {
  if (!cell.swept?.design) return cell.label;
  const { design, source, value } = cell.swept;
  if (!source) return design === "as set" ? "all sources as set" : "no source";
  return design === "all but" ? `without ${source}` : `${source} = ${setting(value)}`;
}
