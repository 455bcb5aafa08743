// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { view_section } from "./camera_view.js";
import { element } from "./elements.js";
import { making_section } from "./making.js";
import { evaluation_sections } from "./matchers.js";
import { plan_section } from "./plan.js";
import { draw_waiting_plots, fit_plots_to_paper, fit_plots_to_window, have_plots } from "./plot.js";
import { reliability_section } from "./reliability.js";
import { rigs_sections } from "./rig.js";
import { cells_section, comparisons_section, headline } from "./study.js";
import { sweep_section } from "./sweep.js";

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

function show(report) {
  masthead(report);
  notice_without_plots();
  const study = report.study?.cells?.length ? report.study : null;
  if (study) {
    headline(report);
    if (study.cells.length > 1) sweep_section(study);
    cells_section(report);
    reliability_section(study);
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
