// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The pages that page_test.mjs makes of one that the program wrote, by putting other data in.
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

import { system_samples } from "./page_systems.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));

/** A page that the program wrote, with other data (JSON text), or without plotly's script. */
function with_data(page, report, { plotly }) {
  const data = report.replaceAll("<", "\\u003c");
  const other = page.replace(/(<script [^>]*id="data">)[^<]*/, (_, tag) => tag + data);
  return plotly ? other : other.replace(/<script id="plotly">[^]*?<\/script>/, "");
}

/** Pages to check: file, and whether it must have plots. */
export function sample_pages(folder, page) {
  const sample = fs.readFileSync(path.join(here, "report_sample.json"), "utf8");
  const full = JSON.parse(sample);
  const study = full.study;
  const made = {
    "sample": [sample, true],
    "sample-without-plotly": [sample, false],
    "title-only": [JSON.stringify({ title: "Only a </script><b>title</b>" }), true],
    "bare-rig": [JSON.stringify({ title: "A rig", rigs: [bare_rig(full.rigs[0])] }), true],
    "one-rig": [JSON.stringify({ title: "A calibration", rigs: [full.rigs[0]] }), true],
    "odd-rigs": [JSON.stringify({ title: "Odd", rigs: odd_rigs(full.rigs[0]) }), true],
    "one-cell": [JSON.stringify({ ...full, view: undefined, rigs: [], study: { ...study,
      sweep: null, world_ceiling: null, comparisons: [],
      cells: [bare_cell(study.cells[2])] } }), true],
    "no-sweep": [JSON.stringify({ title: "Methods", study: { ...study, sweep: null } }), true],
    ...gap_samples(study),
    "adjusted": [JSON.stringify({ title: "Adjusted", study: adjusted(study) }), true],
    "true-bound": [JSON.stringify({ title: "Bound", rigs: [true_bound(full.rigs[0])] }), true],
    "reliability": [JSON.stringify({ title: "Reliability", study: with_reliability(study) }), true],
    "two-keys": [JSON.stringify({ title: "Two keys", study: swept_by(study, 2) }), true],
    "three-keys": [JSON.stringify({ title: "Three keys", study: swept_by(study, 3) }), true],
    "one-at-a-time": [JSON.stringify({ title: "Designs", study: designed(study) }), true],
    "several-studies": [JSON.stringify({ ...full, study: undefined, world: undefined, view: undefined,
      studies: ["a", "b"].map((name) => ({ name, study: swept_by(study, 1), world: full.world,
        view: full.view })) }), true],
    "sweep-with-zero": [JSON.stringify({ title: "Zero", study: with_zero(study) }), true],
    ...system_samples(study),
  };
  return Object.entries(made).map(([name, [report, plotly]]) => {
    const file = path.join(folder, `${name}.html`);
    fs.writeFileSync(file, with_data(page, report, { plotly }));
    return { file, plotly };
  });
}

/** As of a rig file without evidence. */
const bare_rig = ({ corners, projection, view_influence, proof, ...rig }) => ({ ...rig,
  sigma_mvb: null, kind: "mvb", calibration: null, values: rig.values.map(() => null),
  missing: "no evidence" });

/** Rigs with what seldom happens: nothing proved, holes in a map, a view that decides alone. */
function odd_rigs(rig) {
  const holes = { ...rig.projection, cameras: rig.projection.cameras.map((one) => ({ ...one,
    maps: one.maps.map((map) => ({ ...map, sd_px: map.sd_px.map((row, y) =>
      y < 2 ? row.map(() => null) : row) })) })) };
  const alone = rig.view_influence.map((view, i) => i ? view
    : { ...view, images: [], influence_left_out: null, largest_share: 1 });
  const many = Array.from({ length: 200 }, (_, frame) => ({ frame, images: [],
    ...rig.view_influence[frame % rig.view_influence.length] }));
  const corners = rig.corners.map((one) => ({ ...one, outliers: [[20, 30, 41.5, 3, 7]],
    points: one.points.slice(0, 50) }));
  return [
    { ...rig, corners, view_influence: many,
      proof: { notes: ["Lens models were not compared: <b>why</b>."] } },
    { ...rig, file: "odd.rig.json", projection: holes, view_influence: alone, proof: undefined,
      calibration: { ...rig.calibration, doubts: ["residuals of 1.2 px"], prior_dof: 2,
        prior_chi2: 1.5, held: ["left.ax"], warp_m: [1e-3, -2e-4] } },
  ];
}

const bare_cell = (cell) => ({ ...cell, success_interval_95: null, median_error_m: null,
  cpu_ms_p95: null, world_ceiling: null });

/** As of the shipped rig: its views scatter as the white noise does that the bound speaks of. */
const true_bound = (rig) => ({ ...rig, kind: "mvb", true_bound: true, sigma_mvb: rig.sigma });

/** Pages with null where there is nothing to tell: a gap of a plot and a dash of a table, not 0. */
function gap_samples(study) {
  const cells = study.cells.map((cell, i) => i !== 1 ? cell : { ...cell, success: null,
    success_interval_95: null, success_interval_binomial_95: null, median_error_m: null });
  return {
    "gap-in-study": [JSON.stringify({ title: "Gap", study: { ...study, cells } }), true],
    "gap-in-evaluation": [JSON.stringify({ title: "Gap", evaluation: evaluation_with_gaps() }), true],
  };
}

/** Two matchers on two pairs; "none" finds nothing where "some" does. */
function evaluation_with_gaps() {
  const figures = (bad) => ({ density: bad === null ? 0 : 0.9, bad_0_5: bad, bad_1: bad, bad_2: bad,
    mismatch: bad, rms_inlier_px: bad, bias_inlier_px: bad, bad_1_discontinuity: bad,
    coverage_95: null, time_ms: 12 });
  const by_angle = (bad) => Array.from({ length: 9 }, (_, i) => ({ from_deg: 10 * i,
    to_deg: 10 * i + 10, edges: i ? 100 : 0, density: i ? 0.9 : null,
    bad_1: i === 4 ? null : bad, rms_inlier_px: i === 5 ? null : 0.2 }));
  const matchers = { some: figures(0.05), none: figures(null) };
  const scene = (name) => ({ name, left: `${name}.png`, matchers: {
    some: { ...matchers.some, by_angle: by_angle(0.05) },
    none: { ...matchers.none, by_angle: by_angle(0.1) } } });
  const cell = (psi_c, mismatch) => ({ psi_c, rows_moved_px: 0, repair: false, repaired: 0, pairs: 2,
    rows_rms_px: psi_c, geometric_bias_rms_px: null, matchers: {
      some: { density: 0.9, bad_1: 0.1, mismatch, mismatch_interval_95: mismatch && [0.01, 0.2],
        disparity_error_rms_px: 1 },
      none: { density: 0, bad_1: null, mismatch: 0.5, mismatch_interval_95: null,
        disparity_error_rms_px: null } } });
  return { matchers, scenes: [scene("one"), scene("two")], outline: "either", doubts: [],
    settings: { command: "vernier evaluate --scenes 'two pairs.toml'", repair: false },
    curves: { some: [[0.5, 0.01], [0.7, null], [0.9, 0.05]], none: [[0.4, 0.1], [0.6, 0.2]] },
    calibration_error: { draws: 2, seed: 1, rigs: ["nominal"],
      cells: [cell(0.1, 0.02), cell(1, null), cell(10, 0.1)] } };
}

/** Four p below 0.05, of which Holm leaves two, and one that there are too few maps for. */
function adjusted(study) {
  const p = [[0.04, 0.06], [0.0123, 0.0369], [0.03, 0.06], [0.0011, 0.0044], [null, null]];
  const [row] = study.comparisons;
  return { ...study, comparisons: p.map(([p_value, p_value_holm]) => ({ ...row,
    test: "paired t over maps", p_value, p_value_holm })) };
}

/** One cell states probabilities; a range of them has no wrong answer. */
function with_reliability(study) {
  const bin = (stated_error, wrong, answers, interval) => ({ stated_error, wrong, answers,
    error: wrong / answers, error_interval_95: interval });
  const reliability = [bin(0.0001, 0, 700, [0, 0.0053]), bin(0.004, 1, 120, [0.0002, 0.0456]),
    bin(0.3, 22, 80, [0.182, 0.3866])];
  const thresholds = [[1, 900, 23], [0.1, 820, 1], [0.001, 700, 0]].map(
    ([max_error_rate, answered, wrong]) =>
      ({ max_error_rate, answered, wrong, coverage: answered / 900 }));
  return { ...study, cells: study.cells.map((cell, i) =>
    i ? cell : { ...cell, reliability, thresholds }) };
}

/** Cells of a grid of up to three keys. */
function swept_by(study, keys) {
  const grid = [["sources.calibration", [0.1, 1, 10]], ["localiser.method", ["lines", "pgh", "corners"]],
    ["study.protocol", ["near_path", "anywhere"]]].slice(0, keys);
  let all = [{}];
  for (const [key, values] of grid) {
    all = all.flatMap((one) => values.map((value) => ({ ...one, [key]: value })));
  }
  const cells = all.map((swept, i) => ({ ...study.cells[i % study.cells.length], swept,
    label: Object.entries(swept).map(([key, value]) => `${key} = ${value}`).join(", "),
    settings: { ...study.cells[0].settings, ...swept }, trial_list: undefined }));
  return { ...study, cells, comparisons: [], sweep: null,
    swept_keys: grid.map(([key]) => ({ key, label: key })) };
}

/** Cells of one source at a time. */
function designed(study) {
  const rows = [["as set", "", ""], ["no source", "", ""], ["only", "edge_loss", 0.1],
    ["all but", "stereo_mismatch_of_a_long_name", 0], ["swept", "edge_loss", 0.2]];
  const cells = rows.map(([design, source, value], i) => ({ ...study.cells[i % 3],
    swept: { design, source, value }, label: `${design} ${source} = ${value}`, trial_list: undefined }));
  return { ...study, cells, comparisons: [], sweep: null,
    swept_keys: ["design", "source", "value"].map((key) => ({ key, label: key })) };
}

function with_zero(study) {
  const cells = study.cells.map((cell, i) => i ? cell
    : { ...cell, label: "ψ_c = 0", settings: { ...cell.settings, "sources.calibration": 0 } });
  return { ...study, cells };
}
