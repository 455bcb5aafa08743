// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

function masthead(report) {
  const title = report.title || "Vernier report";
  document.title = title;
  document.getElementById("masthead").append(
    element("p", { class: "kind" }, "Vernier report"),
    element("h1", {}, title),
    element("nav", { "aria-label": "Contents" }, element("ul", { id: "contents" })));
}

function notice_without_plots() {
  if (have_plots()) return;
  document.getElementById("report").append(element("p", { class: "notice" },
    "Plots are missing from this page because plotly was not installed when the program was built"
    + " (", element("code", {}, "npm ci"), " in cli/page, then build again). All tables"
    + " are here."));
}

/** How the page was made: program, study file and the settings of every cell. */
function making_section(report) {
  const { program, study, evaluation } = report;
  if (!program && !study && !evaluation) return;
  const rows = [
    ["Program", program?.version && `vernier ${program.version}`],
    ["Processor's instruction set", program?.instruction_set],
    ["Study file", study?.file], ["Method", study?.method],
    ["Trials a cell", study && count(study.trials)],
    ["Seed", is_number(study?.seed) ? String(study.seed) : null],
    ["Pairs", evaluation?.settings?.list ?? evaluation?.scenes.map((scene) => scene.left).join(", ")],
    ["Rows repaired before", evaluation?.settings && (evaluation.settings.repair ? "yes" : "no")],
    ["Programs as matchers", evaluation?.settings?.commands?.join("; ")],
    ["Rigs drawn of each pair", evaluation?.calibration_error
      && `${evaluation.calibration_error.draws}, seed ${evaluation.calibration_error.seed}`],
    ["Rig", report.rigs?.map((rig) => rig.file).filter(Boolean).join(", ")],
  ].filter(([, value]) => value).map(([name, value]) => ({ name, value }));
  const made = section("making", "How this was made", paragraph("The same program, files and seed"
    + " give the same results on a processor of the same class, timings apart, however many"
    + " threads or machines share the work."));
  made.append(table("Program and inputs", [
    { head: "What", text: true, cell: (row) => row.name },
    { head: "Used", text: true, cell: (row) => row.value },
  ], rows, { wide: false }));
  const commands = [evaluation?.settings?.command, program?.command].filter(Boolean);
  if (commands.length) made.append(element("pre", {}, element("code", {}, commands.join("\n"))));
  if (study?.cells?.some((cell) => cell.settings)) made.append(settings_details(study.cells));
}

function settings_details(cells) {
  const varying = varying_settings(cells);
  const common = Object.entries(cells[0].settings || {}).filter(([key]) => !varying.includes(key));
  const details = element("details", {}, element("summary", {}, "Settings of every cell"));
  if (varying.length) {
    details.append(table("Settings that differ between cells", [
      { head: "Cell", text: true, cell: (cell) => cell.label ?? DASH },
      ...varying.map((key) => ({ head: element("code", {}, key), text: true,
        cell: (cell) => setting(cell_key(cell, key)) })),
    ], cells, { wide: false }));
  }
  details.append(table(varying.length ? "Settings that all cells share" : "Settings", [
    { head: "Setting", text: true, cell: ([key]) => element("code", {}, key) },
    { head: "Value", text: true, cell: ([, value]) => setting(value) },
  ], common, { wide: false }));
  return details;
}

function colophon(report) {
  const version = report.program?.version ? ` ${report.program.version}` : "";
  document.getElementById("colophon").append(`Written by vernier${version}. This file is complete:`
    + " it loads nothing from the network.");
}

function show(report) {
  masthead(report);
  notice_without_plots();
  const study = report.study?.cells?.length ? report.study : null;
  if (study) {
    headline(report);
    if (study.cells.length > 1) sweep_section(study);
    cells_section(report);
    if (study.comparisons?.length) comparisons_section(study);
  }
  if (report.evaluation) evaluation_sections(report.evaluation);
  if (report.world || study?.cells.some((cell) => cell.trial_list?.length)) plan_section(report);
  if (report.view) view_section(report.view);
  rigs_sections(report);
  making_section(report);
  colophon(report);
  draw_waiting_plots();
  if (!have_plots()) return;
  window.addEventListener("beforeprint", fit_plots_to_paper);
  window.addEventListener("afterprint", fit_plots_to_window);
}

show(JSON.parse(document.getElementById("data").textContent));
