// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What page_test.mjs checks of studies of other systems than localisers.

/** Pages of such studies: name to [JSON text, whether it has plots]. */
export function system_samples(study) {
  const page = (of, plotly) => [JSON.stringify({ title: "Systems", ...of }), plotly];
  const program = { ...system_study(study, PROGRAM), doubts: ["<it> failed in 3 of 31 trials"] };
  const [first] = program.cells;
  const alone = { ...program, cells: [{ ...first, label: "as set", success_interval_95: null,
    success_interval_95_missing: "needs 6 blocks, has 1", measured: {}, median_error: null,
    p95_error: null }], comparisons: [], sweep: null };
  const several = [["localisers", study], ["programs", program]]
    .map(([name, one]) => ({ name, study: one }));
  return {
    "system": page({ study: system_study(study, DEPTHS) }, true),
    "odd-system": page({ study: program }, true),
    "odd-system-without-plotly": page({ study: program }, false),
    "one-cell-system": page({ study: alone }, true),
    "several-systems": page({ studies: several }, true),
  };
}

const DEPTHS = { system: { name: "calibration", error: "depth_error_m", title: "depth error",
  unit: "m" }, limits: [0.05], measured: ["signed_depth_error_m"], more: {} };

/** A program's: no unit, a limit by cell, failures, more quantities than a table has room for. */
const PROGRAM = { system: { name: "program", error: "error",
  title: "share of <edges> without a right disparity", unit: "" }, limits: [0.2, 0.3],
measured: Array.from({ length: 9 }, (_, i) => `quantity_${i}`),
more: { failed: 3, why_failed: "the program ended" } };

/** A study of localisers as one of another system. */
function system_study(study, { system, limits, measured, more }) {
  const { protocol, method, world_ceiling, ...rest } = study;
  const quantities = (i) => Object.fromEntries(measured.map((name, k) => [name, k === 8
    ? { trials: 0, mean: null, rms: null, median: null }
    : { trials: k ? 30 : 31, mean: 0.01 * k, rms: 0.5 + i, median: -1e-7 * k }]));
  return { ...rest, system, cells: study.cells.map((cell, i) => ({
    label: cell.label, settings: { ...cell.settings, "system.command": "./try --all" },
    trials: 31, blocks: 8, success: 0.1 * i, success_interval_95: [0, 0.1 * i + 0.05],
    success_interval_binomial_95: [0, 0.1 * i + 0.1], coverage: 0.9,
    success_when_answered: 0.1 * i, success_error: limits[i % limits.length],
    median_error: 0.04 * (i + 1), p95_error: 0.1 * (i + 1), failed: 0, why_failed: null,
    cpu_ms_mean: 2, cpu_ms_median: 1.5, cpu_ms_p95: 3, wall_ms_mean: 2, measured: quantities(i),
    trial_list: [], ...(i === 1 ? more : {}) })) };
}

/** Runs in the page: its studies of such systems, and what it shows of them. */
export function inspect_systems() {
  const report = JSON.parse(document.getElementById("data").textContent);
  const all = [[report, ""], ...(report.studies ?? []).map((one, i) => [one, `-${i + 1}`])];
  const text_of = (selector) =>
    [...document.querySelectorAll(selector)].map((one) => one.textContent).join("\n");
  return all.filter(([one]) => one.study?.system).map(([{ study }, end]) => ({
    study,
    headline: text_of(`#headline${end}`),
    words: text_of(["headline", "sweep", "cells", "comparisons"]
      .map((id) => `#${id}${end}`).join()),
    captions: text_of(`#cells${end} caption, #comparisons${end} caption`),
    heads: text_of(`#cells${end} thead`),
    figures: text_of(`#sweep${end} h3`),
    axes: [...document.querySelectorAll(`#sweep${end} div.plot`)].flatMap(({ layout }) =>
      [layout.xaxis, layout.yaxis].map((axis) => axis.title.text.replaceAll("<br>", ""))),
    overview: text_of("#studies thead"),
    making: text_of("#making"),
    stuck: [...document.querySelectorAll(`#cells${end} .scroll`)].filter((box) =>
      box.scrollWidth > box.clientWidth && getComputedStyle(box).overflowX !== "auto").length,
  }));
}

export function faults_of_systems(shown, { plotly }) {
  return shown.flatMap((one) => [
    ...faults_of_words(one), ...faults_of_tables(one), ...(plotly ? faults_of_sweep(one) : []),
  ]).filter(Boolean);
}

const spaced = (text) => text.replaceAll("\u00a0", " ");

function faults_of_words({ study, headline, words, making, overview }) {
  const { name, title, unit } = study.system;
  const foreign = words.match(/\b(quer(y|ies)|localis\w*|robots?|maps?|ceiling)\b/i);
  const limit = new RegExp(`of trials whose ${title} is at most [0-9.]+${unit && ` ${unit}`}`);
  return [
    foreign && `"${foreign[0]}" in a study of a ${name}`,
    !limit.test(spaced(headline)) && `the headline does not say when a ${name} succeeds`,
    !headline.includes("CPU time per trial") && "no tile of the CPU time per trial",
    !making.toLowerCase().includes("system") && "the system is not said under How to reproduce",
    ...(study.doubts ?? []).filter((doubt) => !headline.includes(doubt))
      .map((doubt) => `the doubt "${doubt}" is not shown`),
    overview && !/System.*Success means/s.test(overview) && "systems are not told apart",
  ];
}

function faults_of_tables({ study, captions, heads, words, stuck }) {
  const names = Object.keys(study.cells[0].measured);
  const limits = new Set(study.cells.map((cell) => cell.success_error));
  const failures = study.cells.some((cell) => cell.failed > 0);
  return [
    ...names.filter((name) => study.cells.some((cell) => cell.measured[name].trials > 0)
      && !heads.includes(name)).map((name) => `${name} is not shown`),
    names.length > 0 !== captions.includes("What the trials measured") && "measured: no table",
    names.length > 0 && !/mean.*RMS/s.test(words) && "measured: no mean or RMS",
    (limits.size > 1) !== heads.includes("Limit") && "a limit by cell is not shown as such",
    failures !== captions.includes("Why trials failed") && "why trials failed is not said",
    study.comparisons?.length && !captions.includes("Trials that succeeded in one")
      && "comparisons are not of trials",
    stuck && `${stuck} wide tables do not scroll in their box`,
  ];
}

function faults_of_sweep({ study, figures, axes }) {
  if (study.cells.length < 2) return [];
  const { title, unit } = study.system;
  const axis = `median ${title}${unit && `, ${unit}`}`.replace("<", "&lt;").replace(">", "&gt;");
  return [
    !figures.includes(`Median ${title}`) && "no figure of the error",
    !axes.includes(axis) && `no axis "${axis}" among "${axes.join('", "')}"`,
  ];
}
