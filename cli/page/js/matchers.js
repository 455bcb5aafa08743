// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section, small, table } from "./elements.js";
import { percent, significant } from "./format.js";
import { pictures_section } from "./matcher_pictures.js";
import { calibration_error_section } from "./matchers_under_error.js";
import { in_percent, is_number, ratio, times } from "./numbers.js";
import { axis, figure, have_plots, series_colour } from "./plot.js";

/** The sections of an evaluation of matchers against ground truth. */
export function evaluation_sections(evaluation) {
  const names = Object.keys(evaluation.matchers);
  scores_section(evaluation, names);
  if (evaluation.curves && Object.keys(evaluation.curves).length) density_section(evaluation);
  angle_section(evaluation, names);
  if (evaluation.calibration_error) calibration_error_section(evaluation, names);
  if (evaluation.scenes.some((scene) => scene.pictures)) pictures_section(evaluation);
}

const OUTLINES = {
  either: "Within a pixel of a depth discontinuity, the disparity of either surface counts as"
    + " correct.",
  foreground: "Within a pixel of a depth discontinuity, only the foreground disparity counts as"
    + " correct.",
};

const pairs_counted = (evaluation) => evaluation.scenes.length === 1 ? "one pair"
  : `${evaluation.scenes.length} pairs`;

function score_columns(first) {
  const share = (head, key, small) => ({ head, small, cell: (row) => percent(row[key], 2) });
  return [
    ...first,
    { head: "Density", small: "matched", cell: (row) => percent(row.density) },
    share("Bad 0.5", "bad_0_5", "of matched"), share("Bad 1", "bad_1", "of matched"),
    share("Bad 2", "bad_2", "of matched"), share("Mismatch", "mismatch", "incl. occluded edges"),
    { head: "RMS px", small: "of errors up to 1"
      + " px", cell: (row) => significant(row.rms_inlier_px) },
    { head: "Bias px", cell: (row) => significant(row.bias_inlier_px, 2) },
    share("Bad 1", "bad_1_discontinuity", "at discontinuities"),
    share("In 95 %", "coverage_95", "of stated intervals"),
    { head: "CPU ms", small: "one thread", cell: (row) => significant(row.time_ms) },
  ];
}

function scores_section(evaluation, names) {
  const made = section("scores", "Matchers at edges", paragraph(
    `Evaluated at the edges of the left image of ${pairs_counted(evaluation)}, excluding edges`
    + " within 5° of the row. Bad 1: fraction of matched edges with a disparity error above 1 px."
    + " Mismatch: error above 3 px, including matches of edges occluded in the right image. ",
    OUTLINES[evaluation.outline]));
  made.append(table(evaluation.scenes.length > 1 ? "Means over the pairs" : "Scores",
    score_columns([{ head: "Matcher", text: true, cell: (row) => row.name }]),
    names.map((name) => ({ name, ...evaluation.matchers[name] }))));
  if (evaluation.scenes.length > 1) {
    const rows = evaluation.scenes.flatMap((scene) => names.map((name) =>
      ({ scene: scene.name, name, ...scene.matchers[name] })));
    made.append(element("details", {}, element("summary", {}, "Every pair"),
      table("Scores by pair", score_columns([
        { head: "Pair", text: true, cell: (row) => row.scene },
        { head: "Matcher", text: true, cell: (row) => row.name }]), rows)));
  }
}

function density_section(evaluation) {
  const against = Object.entries(evaluation.equal_density?.against || {});
  const made = section("density", "Errors against density", paragraph(
    "Rejecting uncertain matches lowers both density and errors, so a fair comparison needs equal"
      + " density. Lines show means over the pairs: OpenCV's matchers at their best setting with"
      + " the uniqueness ratio swept, the others thresholded by their own confidence."));
  made.append(figure(null, "Lower right is better.",
    "Fraction of errors above one pixel against fraction of edges matched, one line per"
      + " matcher.", 400,
    () => ({
      data: Object.entries(evaluation.curves).map(([name, points], i) => ({
        type: "scatter", mode: "lines+markers", name,
        x: points.map((p) => in_percent(p[0])), y: points.map((p) => in_percent(p[1])),
        line: { color: series_colour(i) }, marker: { size: 5 },
        hovertemplate: "%{y:.2f} % at %{x:.1f} %",
      })),
      layout: { xaxis: axis("edges matched, %"),
        yaxis: axis("errors above 1 px, % of matched", { rangemode: "tozero" }) },
    })) || "");
  if (!against.length) return;
  const own = evaluation.equal_density.matcher;
  made.append(table(`${own} against the others at equal density`, [
    { head: "Against", text: true, cell: ([name]) => name },
    { head: "Best setting", text: true, cell: ([, e]) => e.setting },
    { head: "Density", cell: ([, e]) => percent(e.density) },
    { head: "Bad 1", small: own, cell: ([, e]) => percent(e.bad_1, 2) },
    { head: "Bad 1", small: "other matcher", cell: ([, e]) => percent(e.peer_bad_1, 2) },
    { head: "Ratio", small: "95 % over pairs", cell: ([, e]) => [significant(e.ratio),
      is_number(e.ratio_interval_95[0]) && small(significant(e.ratio_interval_95[0])
        + (is_number(e.ratio_interval_95[1]) ? ` to ${significant(e.ratio_interval_95[1])}` : " or more"))] },
  ], against, { wide: false }));
}

const root = (x) => is_number(x) ? Math.sqrt(x) : null;

/** Means per angle bin over all pairs, weighted by edges. */
function angle_means(evaluation, name) {
  const bins = evaluation.scenes[0].matchers[name].by_angle.map((bin) =>
    ({ middle: 0.5 * (bin.from_deg + bin.to_deg), matched: 0, bad: 0, right: 0, squares: 0 }));
  for (const scene of evaluation.scenes) {
    scene.matchers[name].by_angle.forEach((bin, i) => {
      const matched = times(bin.edges, bin.density);
      if (!(matched > 0) || !is_number(bin.bad_1)) return;  // no matches in this bin
      const right = matched * (1 - bin.bad_1);
      bins[i].matched += matched;
      bins[i].bad += matched - right;
      if (!is_number(bin.rms_inlier_px)) return;
      bins[i].right += right;
      bins[i].squares += bin.rms_inlier_px ** 2 * right;
    });
  }
  return bins;
}

function angle_section(evaluation, names) {
  if (!have_plots() || !evaluation.scenes[0]?.matchers[names[0]]?.by_angle) return;
  const made = section("angles", "Dependence on edge angle", paragraph(
    "An edge along the row does not determine disparity, and one at a small angle to the row only"
      + " weakly. Bins of 10°, over all pairs."));
  const lines = (value) => names.map((name, i) => {
    const bins = angle_means(evaluation, name);
    return { type: "scatter", mode: "lines+markers", name, x: bins.map((bin) => bin.middle),
      y: bins.map(value), line: { color: series_colour(i) } };
  });
  const degrees = axis("angle to the row, degrees", { range: [0, 90], dtick: 10 });
  made.append(
    figure("Errors above 1 px", "Of matched edges.",
      "Fraction of errors above one pixel by the angle of the edge to the row.", 320,
      () => ({ data: lines((bin) => in_percent(ratio(bin.bad, bin.matched))),
        layout: { xaxis: degrees, yaxis: axis("errors, %", { rangemode: "tozero" }) } })),
    figure("Precision", "Root mean square of errors up to 1 px.",
      "Root mean square error by the angle of the edge to the row.", 320,
      () => ({ data: lines((bin) => root(ratio(bin.squares, bin.right))),
        layout: { xaxis: degrees, yaxis: axis("RMS, px", { rangemode: "tozero" }) } })));
}
