// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { corners_content } from "./corners.js";
import { correlation_part } from "./correlations.js";
import { element, findings, paragraph, section, section_named, table } from "./elements.js";
import { DASH, count, counted, percent, significant } from "./format.js";
import { is_number, ratio } from "./numbers.js";
import { directions_list, is_bound, parameter_table } from "./parameters.js";
import { projection_content } from "./projection.js";
import { proof_content } from "./proof.js";
import { tile } from "./study.js";
import { views_content } from "./view_influence.js";

const KIND_REASON = {
  jackknife: (frames, free) => "from the scatter of the frames, shrunk (kind jackknife:"
    + ` ${frames} frames for ${free} parameters are fewer than three per parameter)`,
  clustered: (frames, free) => "from the scatter of the frames, shrunk (kind clustered:"
    + ` ${frames} frames for ${free} parameters)`,
  mvb: (frames, free, rig) => "minimum variance bound: corner noise is assumed to be"
    + ` white${rig.true_bound ? ", which agrees with the scatter of the views" : ""}`,
  prior: () => "from the rig file: assumed, not measured",
  combined: () => "combined from several calibrations or batches",
};

/** The sections of all rigs, preceded by a comparison table if there are several. */
export function rigs_sections(report) {
  const rigs = report.rigs ?? [];
  if (rigs.length > 1) calibrations_section(rigs);
  rigs.forEach((rig, i) => rig_sections(rig, i ? `rig-${i + 1}` : "rig", rigs.length > 1));
}

/** The available sections of a rig: [name, heading, builder]. */
function rig_parts(rig) {
  return [
    [rig.corners?.length, "corners", "Corners and residuals", corners_content],
    [rig.projection || rig.depth?.length, "projection", "Projection and depth uncertainty",
      projection_content],
    [rig.view_influence?.length, "views", "Influence of individual views", views_content],
    [rig.proof, "proof", "Cross-validation on held-out views", proof_content],
  ].filter(([there]) => there).map(([, ...part]) => part);
}

function rig_sections(rig, id, several) {
  const of_rig = several ? ` · ${rig.file ?? id}` : "";
  const parts = rig_parts(rig);
  const first = section_named(id, `The stereo rig and its uncertainty${of_rig}`,
    several ? rig.file ?? id : "The rig");
  if (several && parts.length) {
    first.append(element("ul", { class: "parts" }, parts.map(([name, heading]) =>
      element("li", {}, element("a", { href: `#${id}-${name}` }, heading)))));
  }
  first.append(...rig_content(rig));
  for (const [name, heading, build] of parts) {
    const made = section_named(`${id}-${name}`, heading + of_rig, several ? null : heading);
    made.append(...build(rig).filter(Boolean));
  }
}

function rig_content(rig) {
  return [
    cameras_words(rig),
    rig.missing && element("p", { class: "notice" }, rig.missing),
    findings("Reasons not to trust this calibration", rig.calibration?.doubts),
    findings("Calibration warnings", rig.calibration?.warnings),
    calibration_tiles(rig.calibration), summary_table(rig),
    element("div", { class: "pair table-first" }, parameter_table(rig), directions_list(rig)),
    correlation_part(rig),
  ].filter(Boolean);
}

/** Summary of the calibration settings and data. */
function summary_table(rig) {
  const { calibration } = rig;
  if (!calibration) return null;
  const all = calibration.corners_used + calibration.corners_left_out;
  const reason = KIND_REASON[rig.kind]?.(calibration.views, rig.free_parameters, rig);
  const inflation = typical_inflation(rig);
  const warp = calibration.warp_m;
  const rows = [
    ["Views", `${counted(calibration.views, "frame")}${is_number(calibration.images)
      ? `, ${counted(calibration.images, "image")} with corners` : ""}`],
    ["Corners", is_number(calibration.corners_used) ? `${count(calibration.corners_used)} used,`
      + ` ${count(calibration.corners_left_out)} rejected as outliers`
      + ` (${percent(ratio(calibration.corners_left_out, all))})` : DASH],
    ["Parameters", `${count(rig.free_parameters ?? rig.names?.length)} estimated; `
      + (calibration.held?.length ? `fixed: ${calibration.held.join(", ")}` : "none fixed")],
    ["Degrees of freedom", `${count(calibration.dof)}: corner coordinates minus parameters and`
      + ` six per frame for the board pose`],
    ["Prior", calibration.prior_dof > 0 ? `of`
      + ` ${counted(calibration.prior_dof, "parameter")}; χ² =`
      + ` ${significant(calibration.prior_chi2, 3)} at the solution` : "none"],
    ...(calibration.effects ? [["Random effects", effects_words(calibration.effects)]] : []),
    ["Board", warp ? `estimated warp: ${significant(1e3 * warp[0], 2)} mm along rows,`
      + ` ${significant(1e3 * warp[1], 2)} mm along columns`
      : "as specified; no warp estimated"],
    ...(calibration.board_aspect ? [["Board aspect", `estimated:`
      + ` ${significant(100 * calibration.board_aspect.value, 2)} % longer along x than along y,`
      + ` ± ${significant(100 * calibration.board_aspect.sigma, 1)} %`]] : []),
    ["Covariance", reason ? reason + (inflation ? `. On average, its σ is`
      + ` ${significant(inflation, 2)} times that of the bound` : "") : "none"],
  ];
  return table("Calibration summary", [
    { head: "Item", text: true, cell: ([name]) => name },
    { head: "Value", text: true, cell: ([, words]) => words },
  ], rows, { wide: false });
}

/** What was estimated beside the rig, and what of the page is without it. */
function effects_words(effects) {
  const { motion_baseline_m, motion_m, motion_rad, shape_height_m, shape_plane_m } = effects;
  const words = [];
  if (shape_height_m > 0) {
    words.push(`an uneven board, ${significant(1e3 * shape_height_m, 2)} mm in height and`
      + ` ${significant(1e3 * shape_plane_m, 2)} mm in its plane (RMS)`);
  }
  if (motion_m > 0) {
    const along = motion_baseline_m > 0
      ? `${significant(1e3 * motion_baseline_m, 2)} mm along the baseline, ` : "";
    words.push(`motion between the exposures, ${along}${significant(1e3 * motion_m, 2)} mm`
      + `${along && " across it"} and`
      + ` ${significant(1e3 * motion_rad, 2)} mrad (RMS about each axis)`);
  }
  return `${words.join("; ")}. Residuals, influence of views, lens models and held-out boards are`
    + " those of the calibration without";
}

/** Geometric mean of σ divided by the bound's σ; null if the covariance is the bound. */
function typical_inflation(rig) {
  if (is_bound(rig)) return null;
  const ratios = (rig.sigma ?? []).map((s, i) => ratio(s, rig.sigma_mvb?.[i]))
    .filter((r) => is_number(r) && r > 0);
  if (!ratios.length) return null;
  return Math.exp(ratios.reduce((sum, r) => sum + Math.log(r), 0) / ratios.length);
}

function cameras_words(rig) {
  const cameras = (rig.cameras ?? []).map((camera) => `${camera.name} (${camera.model}`
    + `${camera.size_px ? `, ${camera.size_px[0]} × ${camera.size_px[1]} px` : ""})`);
  return paragraph(rig.file && [element("code", {}, rig.file), ": "], "cameras ",
    cameras.join(" and "), ".");
}

function calibration_tiles(calibration) {
  if (!calibration) return null;
  const { rms_px, pixel_sigma_px, chi2, dof, views } = calibration;
  return element("dl", { class: "tiles" },
    tile("Residual, RMS", is_number(rms_px) ? `${significant(rms_px, 3)} px` : null,
      "per corner coordinate"),
    tile("Corner noise", is_number(pixel_sigma_px) ? `${significant(pixel_sigma_px, 2)} px` : null,
      "standard deviation used for weighting"),
    tile("χ² per degree of freedom", dof > 0 ? significant(ratio(chi2, dof), 3) : null,
      `χ² = ${significant(chi2, 4)}, ${count(dof)} degrees; 1 is expected if the noise is`
        + " correct"),
    tile("Views", count(views), "frames used"));
}

function calibrations_section(rigs) {
  const left_out = (rig) => rig.proof?.models?.rows?.find((row) => row.in_use)?.held_out_rms_px;
  const covered = (rig, key, row = 0) => rig.proof?.left_out?.rows?.[row]?.[key];
  const beside = (rig) => is_bound(rig) ? null : covered(rig, "coverage_mvb");
  section("calibrations", "Comparison of calibrations", table(
    "A smaller residual alone does not mean a better model: a richer model always fits its own"
      + " views better, so compare held-out views. No covariance includes lens model error.", [
      { head: "Calibration", text: true, cell: (rig) => rig.name ?? rig.file ?? DASH },
      { head: "Views", cell: (rig) => count(rig.calibration?.views) },
      { head: "Residual RMS", small: "px",
        cell: (rig) => significant(rig.calibration?.rms_px, 3) },
      { head: "Corner noise", small: "px",
        cell: (rig) => significant(rig.calibration?.pixel_sigma_px, 3) },
      { head: "Held-out views", small: "RMS, px", cell: (rig) => significant(left_out(rig), 3) },
      { head: "σ over bound", small: "on average",
        cell: (rig) => significant(typical_inflation(rig), 2) },
      { head: "Held-out boards", small: "lengths inside 95 %",
        cell: (rig) => percent(covered(rig, "coverage_components"), 0) },
      { head: "Held-out boards", small: "sizes inside 95 %",
        cell: (rig) => percent(covered(rig, "coverage_components", 1), 0) },
      { head: "Held-out boards", small: "sizes, white noise",
        cell: (rig) => percent(covered(rig, "coverage_honest", 1), 0) },
      { head: "Held-out boards", small: "lengths, bound",
        cell: (rig) => percent(beside(rig), 0) },
    ], rigs, { wide: false }));
}
