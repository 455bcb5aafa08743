// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section, table } from "./elements.js";
import { DASH, count, setting } from "./format.js";
import { is_number } from "./numbers.js";
import { cell_key } from "./study.js";
import { varying_settings } from "./sweep.js";

/** How the results were produced: program, study file and the settings of every cell. */
export function making_section(report) {
  const { program, evaluation } = report;
  const studies = report.studies ?? (report.study ? [{ study: report.study }] : []);
  if (!program && !studies.length && !evaluation) return;
  const rows = [
    ["Page written by", program?.machine ?? (program?.version && `vernier ${program.version}`)],
    ["Processor's instruction set", program?.instruction_set],
    ...studies.flatMap(study_rows),
    ["Pairs", evaluation?.settings?.list ?? evaluation?.scenes.map((scene) => scene.left).join(","
      + " ")],
    ["Row alignment repaired", evaluation?.settings && (evaluation.settings.repair ? "yes" : "no")],
    ["External matchers", evaluation?.settings?.commands?.join("; ")],
    ["Sampled rigs per pair", evaluation?.calibration_error
      && `${evaluation.calibration_error.draws}, seed ${evaluation.calibration_error.seed}`],
    ["Rig", report.rigs?.map((rig) => rig.file).filter(Boolean).join(", ")],
  ].filter(([, value]) => value).map(([name, value]) => ({ name, value }));
  const made = section("making", "How to reproduce", paragraph("The same program, files and seed"
    + " give the same results, except for timings, on processors of the same class, for any"
    + " number of threads or machines.", commands_words(studies)));
  made.append(table("Program and inputs", [
    { head: "Item", text: true, cell: (row) => row.name },
    { head: "Value", text: true, cell: (row) => row.value },
  ], rows, { wide: false }));
  const commands = [...studies.flatMap(({ study }) => study.commands ?? []),
    evaluation?.settings?.command, program?.command].filter(Boolean);
  if (commands.length) made.append(element("pre", {}, element("code", {}, commands.join("\n"))));
  for (const { name, study } of studies) {
    if (study.cells?.some((cell) => cell.settings)) made.append(settings_details(study.cells, name));
  }
}

/** Of programs that vernier only calls. */
function commands_words(studies) {
  const commands = new Set(studies.flatMap(({ study }) => (study.cells ?? [])
    .map((cell) => cell_key(cell, "system.command")).filter(Boolean)));
  if (!commands.size) return null;
  return [" They also need this command, with the same answers: ",
    [...commands].map((command, i) => [i ? ", " : "", element("code", {}, command)]), "."];
}

/** What a study was made with; of several, each under its name. */
function study_rows({ name, study }) {
  const of = (item) => name ? `${name}: ${item.toLowerCase()}` : item;
  return [
    [of("Study file"), study.file], [of("Method"), study.method],
    [of("System"), study.system?.name],
    [of("Trials per cell"), count(study.trials)],
    [of("Seed"), is_number(study.seed) ? String(study.seed) : null],
    [of("Computed by"), study.machines?.join("; ")],
  ];
}

function settings_details(cells, name) {
  const varying = varying_settings(cells);
  const common = Object.entries(cells[0].settings || {}).filter(([key]) => !varying.includes(key));
  const details = element("details", {}, element("summary", {},
    name ? `Settings of every cell of ${name}` : "Settings of every cell"));
  if (varying.length) {
    details.append(table("Settings that differ between cells", [
      { head: "Cell", text: true, cell: (cell) => cell.label ?? DASH },
      ...varying.map((key) => ({ head: element("code", {}, key), text: true,
        cell: (cell) => setting(cell_key(cell, key)) })),
    ], cells, { wide: false }));
  }
  details.append(table(varying.length ? "Settings common to all cells" : "Settings", [
    { head: "Setting", text: true, cell: ([key]) => element("code", {}, key) },
    { head: "Value", text: true, cell: ([, value]) => setting(value) },
  ], common, { wide: false }));
  return details;
}
