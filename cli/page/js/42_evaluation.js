// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

/** Matchers against ground truth: the evaluation's sections. */
function evaluation_sections(evaluation) {
  const names = Object.keys(evaluation.matchers);
  scores_section(evaluation, names);
  if (evaluation.curves && Object.keys(evaluation.curves).length) density_section(evaluation);
  angle_section(evaluation, names);
  if (evaluation.calibration_error) calibration_error_section(evaluation, names);
  if (evaluation.scenes.some((scene) => scene.pictures)) pictures_section(evaluation);
}

const OUTLINES = {
  either: "Within a pixel of a step of the truth either surface counts as right.",
  foreground: "Within a pixel of a step of the truth only the foreground counts as right.",
};

const pairs_counted = (evaluation) => evaluation.scenes.length === 1 ? "one pair"
  : `${evaluation.scenes.length} pairs`;

function score_columns(first) {
  const share = (head, key, small) => ({ head, small, cell: (row) => percent(row[key], 2) });
  return [
    ...first,
    { head: "Density", small: "matched", cell: (row) => percent(row.density) },
    share("Bad 0.5", "bad_0_5", "of matched"), share("Bad 1", "bad_1", "of matched"),
    share("Bad 2", "bad_2", "of matched"), share("Mismatch", "mismatch", "hidden edges too"),
    { head: "RMS px", small: "of errors to 1 px", cell: (row) => significant(row.rms_inlier_px) },
    { head: "Bias px", cell: (row) => significant(row.bias_inlier_px, 2) },
    share("Bad 1", "bad_1_discontinuity", "at outlines"),
    share("In 95 %", "coverage_95", "of stated intervals"),
    { head: "CPU ms", small: "one thread", cell: (row) => significant(row.time_ms) },
  ];
}

function scores_section(evaluation, names) {
  const made = section("scores", "Matchers at edges", paragraph(
    `At the edges of the left image of ${pairs_counted(evaluation)}, those within 5° of the row`
    + " left out. Bad 1: share of matched edges whose disparity is wrong by more than 1 px."
    + " Mismatch: by more than 3 px, matches of edges that the right image hides counted as such. ",
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
    "Leaving out doubtful matches lowers both density and errors, so matchers compare fairly only"
    + " where they leave out as much. Each line joins means over the pairs: OpenCV's matchers with"
    + " their uniqueness ratio swept at their best setting, the others cut by their own"
    + " confidence."));
  made.append(figure(null, "Down and to the right is better.",
    "Share of errors above one pixel against the share of edges matched, a line a matcher.", 400,
    () => ({
      data: Object.entries(evaluation.curves).map(([name, points], i) => ({
        type: "scatter", mode: "lines+markers", name,
        x: points.map((p) => 100 * p[0]), y: points.map((p) => 100 * p[1]),
        line: { color: SERIES[i % SERIES.length] }, marker: { size: 5 },
        hovertemplate: "%{y:.2f} % at %{x:.1f} %",
      })),
      layout: { xaxis: axis("edges matched, %"),
        yaxis: axis("of them wrong by more than 1 px, %", { rangemode: "tozero" }) },
    })) || "");
  if (!against.length) return;
  const own = evaluation.equal_density.matcher;
  made.append(table(`${own} against the others at equal density`, [
    { head: "Against", text: true, cell: ([name]) => name },
    { head: "Best setting", text: true, cell: ([, e]) => e.setting },
    { head: "Density", cell: ([, e]) => percent(e.density) },
    { head: "Bad 1", small: own, cell: ([, e]) => percent(e.bad_1, 2) },
    { head: "Bad 1", small: "the other's", cell: ([, e]) => percent(e.peer_bad_1, 2) },
    { head: "Ratio", small: "95 % over pairs", cell: ([, e]) => [significant(e.ratio),
      is_number(e.ratio_interval_95[0]) && small(`${significant(e.ratio_interval_95[0])} to `
        + significant(e.ratio_interval_95[1]))] },
  ], against, { wide: false }));
}

/** Of one bin of angles, over all pairs: shares weighted by edges. */
function angle_means(evaluation, name) {
  const bins = evaluation.scenes[0].matchers[name].by_angle.map((bin) =>
    ({ middle: 0.5 * (bin.from_deg + bin.to_deg), edges: 0, matched: 0, bad: 0, squares: 0 }));
  for (const scene of evaluation.scenes) {
    scene.matchers[name].by_angle.forEach((bin, i) => {
      const matched = bin.density * bin.edges;
      bins[i].edges += bin.edges;
      bins[i].matched += matched;
      bins[i].bad += bin.bad_1 * matched;
      bins[i].squares += bin.rms_inlier_px ** 2 * matched * (1 - bin.bad_1);
    });
  }
  return bins.filter((bin) => bin.matched > 0);
}

function angle_section(evaluation, names) {
  if (!have_plots() || !evaluation.scenes[0]?.matchers[names[0]]?.by_angle) return;
  const made = section("angles", "By the angle of the edge", paragraph(
    "An edge along the row says nothing of disparity, and one that crosses it at a small angle"
    + " little. Bins of 10°, over all pairs."));
  const lines = (value) => names.map((name, i) => {
    const bins = angle_means(evaluation, name);
    return { type: "scatter", mode: "lines+markers", name, x: bins.map((bin) => bin.middle),
      y: bins.map(value), line: { color: SERIES[i % SERIES.length] } };
  });
  const degrees = axis("angle to the row, degrees", { range: [0, 90], dtick: 10 });
  made.append(
    figure("Errors above 1 px", "Of matched edges.",
      "Share of errors above one pixel by the angle of the edge to the row.", 320,
      () => ({ data: lines((bin) => 100 * bin.bad / bin.matched),
        layout: { xaxis: degrees, yaxis: axis("wrong, %", { rangemode: "tozero" }) } })),
    figure("Precision", "Root mean square of errors up to 1 px.",
      "Root mean square error by the angle of the edge to the row.", 320,
      () => ({ data: lines((bin) => Math.sqrt(bin.squares / Math.max(1, bin.matched - bin.bad))),
        layout: { xaxis: degrees, yaxis: axis("RMS, px", { rangemode: "tozero" }) } })));
}

const error_name = (cell) => cell.rows_moved_px ? `rows ${significant(cell.rows_moved_px, 2)} px`
  : `ψ_c = ${significant(cell.psi_c, 2)}`;

function calibration_error_section(evaluation, names) {
  const { cells, draws, rigs } = evaluation.calibration_error;
  const rig = [...new Set(rigs)].join(", ");
  const made = section("calibration-error", "Under calibration error", paragraph(
    `Every pair as ${draws === 1 ? "a rig" : `${draws} rigs`} drawn from the calibration's`
    + ` covariance (${rig}) would rectify it. ${PSI_MEANING} Matches are scored against the`
    + " disparities that the pair then has: a mismatch was matched to something else. What the"
    + " geometry itself does to disparities stands apart, as bias; the error in found disparities"
    + " holds both. Repair takes away what the rows differ by, found from corners of the pair."
    + " What the rows of the pair as given differ by is taken away before any error is put in, so"
    + " that ψ_c = 0 is the pair without it. An edge where rows are off may be found anywhere"
    + " between its point's disparity and the place where it crosses the row: all of that counts as"
    + " right."));
  const drawn = cells.filter((cell) => cell.psi_c > 0);
  if (drawn.length > 2) made.append(mismatch_figure(drawn, names) || "");
  const rows = cells.flatMap((cell) => names.map((name) =>
    ({ cell, name, ...cell.matchers[name] })));
  made.append(table("Figures under each error, means over pairs and draws", [
    { head: "Error", text: true, cell: (row) => error_name(row.cell) },
    { head: "Repair", small: "pairs repaired", text: true, cell: (row) =>
      row.cell.repair ? `${row.cell.repaired} of ${row.cell.pairs}` : "no" },
    { head: "Matcher", text: true, cell: (row) => row.name },
    { head: "Density", cell: (row) => percent(row.density) },
    { head: "Bad 1", cell: (row) => percent(row.bad_1, 2) },
    { head: "Mismatch", small: "95 % interval", cell: (row) => [percent(row.mismatch, 2),
      row.mismatch_interval_95 && small(range_percent(row.mismatch_interval_95))] },
    { head: "Rows px", small: "vertical, RMS", cell: (row) => significant(row.cell.rows_rms_px) },
    { head: "Bias px", small: "geometric, RMS", cell: (row) =>
      significant(row.cell.geometric_bias_rms_px) },
    { head: "Error px", small: "of found, RMS", cell: (row) =>
      significant(row.disparity_error_rms_px) },
  ], rows));
}

function mismatch_figure(cells, names) {
  const series = names.flatMap((name, i) => [false, true].map((repair) => {
    const own = cells.filter((cell) => cell.repair === repair);
    const of = (cell) => cell.matchers[name];
    const ends = own.map((cell) => of(cell).mismatch_interval_95 || [of(cell).mismatch,
      of(cell).mismatch]);
    return { type: "scatter", mode: "lines+markers",
      name: repair ? `${name}, repaired` : name,
      x: own.map((cell) => cell.psi_c), y: own.map((cell) => 100 * of(cell).mismatch),
      error_y: { type: "data", symmetric: false, thickness: 1, width: 3,
        array: own.map((cell, k) => 100 * (ends[k][1] - of(cell).mismatch)),
        arrayminus: own.map((cell, k) => 100 * (of(cell).mismatch - ends[k][0])) },
      line: { color: SERIES[i % SERIES.length], dash: repair ? "dot" : "solid" },
      hovertemplate: "%{y:.2f} %" };
  }));
  return figure("Mismatch against calibration error", "Bars: 95 % over the pairs.",
    "Share of mismatches against psi_c, with and without repair.", 400, () => ({ data: series,
      layout: { xaxis: log_axis("ψ_c", cells.map((cell) => cell.psi_c)),
        yaxis: axis("mismatch, %", { rangemode: "tozero" }) } }));
}

const ERROR_COLOURS = [["#14a03c", "to 0.5 px"], ["#e6c800", "to 1 px"], ["#ff7800", "to 3 px"],
  ["#dc1414", "more"], ["#1e5ae6", "no match"], ["#000000", "not judged"]];

function pictures_section(evaluation) {
  const scenes = evaluation.scenes.filter((scene) => scene.pictures);
  const made = section("pictures", "Pictures", paragraph(
    `Edges found by ${scenes[0].pictures.matcher}, over the faded left image.`));
  const place = element("div", {});
  const show_scene = (i) => place.replaceChildren(...scene_pictures(scenes[i]));
  if (scenes.length > 1) {
    made.append(chooser("Pair", scenes.map((scene) => scene.name), 0, show_scene));
  }
  made.append(place);
  show_scene(0);
}

function scene_pictures(scene) {
  const { disparity, error, least_px, most_px } = scene.pictures;
  const key = ERROR_COLOURS.map(([colour, words]) => element("span", { class: "key" },
    element("span", { class: "swatch", style: `background:${colour}` }), words));
  return [
    element("figure", {}, element("h3", {}, "Disparity"),
      element("figcaption", {}, `Blue ${least_px} px to red ${most_px} px; grey: no match.`),
      element("img", { src: disparity, class: "picture",
        alt: `Edges of ${scene.name} coloured by disparity` })),
    element("figure", {}, element("h3", {}, "Error"), element("figcaption", {}, key),
      element("img", { src: error, class: "picture",
        alt: `Edges of ${scene.name} coloured by error` }))];
}
