// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { view_section } from "./camera_view.js";
import { element, in_part, section_named } from "./elements.js";
import { making_section } from "./making.js";
import { evaluation_sections } from "./matchers.js";
import { overview_section } from "./overview.js";
import { plan_section } from "./plan.js";
import {
  draw_waiting_plots, fit_plots_to_paper, fit_plots_to_window, follow_reader, have_plots,
} from "./plot.js";
import { reliability_section } from "./reliability.js";
import { rigs_sections } from "./rig.js";
import { cells_section, comparisons_section, headline } from "./study.js";
import { sweep_section } from "./sweep.js";
import { system_cells_section, system_headline } from "./system.js";

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
    "This page has no plots because vernier was built without plots (",
    element("code", {}, "-DVERNIER_PAGE_PLOTS=OFF"), "). All tables are included."));
}

function colophon(report) {
  const version = report.program?.version ? ` ${report.program.version}` : "";
  document.getElementById("colophon").append(`Written by vernier${version}. This file is complete:`
    + " it loads nothing from the network.");
}

/** What the page says of a study. */
function study_sections({ study, world, worlds }) {
  if (study?.cells?.length) {
    if (study.system) system_headline({ study });
    else headline({ study, world, worlds });
    if (study.cells.length > 1) sweep_section(study);
    if (study.system) system_cells_section(study);
    else cells_section({ study });
    reliability_section(study);
    if (study.comparisons?.length) comparisons_section(study);
  }
}

function map_sections({ study, world, worlds, view }) {
  if (world || study?.cells?.some((cell) => cell.trial_list?.length)) plan_section({ study, world, worlds });
  if (view) view_section(view);
}

/** Several studies: what they have together, then each for itself. */
function several_studies(studies) {
  overview_section(studies);
  studies.forEach((one, i) => {
    section_named(`study-${i + 1}`, `Study ${one.name}`, one.name);
    in_part(`-${i + 1}`, () => {
      study_sections(one);
      map_sections(one);
    });
  });
}

function show(report) {
  masthead(report);
  notice_without_plots();
  if (report.studies) several_studies(report.studies);
  study_sections(report);
  if (report.evaluation) evaluation_sections(report.evaluation);
  map_sections(report);
  rigs_sections(report);
  making_section(report);
  colophon(report);
  draw_waiting_plots();
  if (!have_plots()) return;
  follow_reader();
  window.addEventListener("beforeprint", fit_plots_to_paper);
  window.addEventListener("afterprint", fit_plots_to_window);
}

show(JSON.parse(document.getElementById("data").textContent));
