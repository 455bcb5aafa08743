// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

const PARAMETER_MEANING = [
  [/f_px$/, "focal length, px"],
  [/\.ax$/, "aspect, fx over fy"],
  [/\.ox_px$/, "image centre, to the right, px"],
  [/\.oy_px$/, "image centre, down, px"],
  [/\.k(\d)$/, "radial distortion"],
  [/\.p(\d)$/, "tangential distortion"],
  [/\.w([xyz])_rad$/, "rotation about $1, rad"],
  [/\.t([xyz])_m$/, "offset along $1, m"],
];

const KIND_MEANING = {
  mvb: "They are the minimum variance bound: what the corners' noise alone would allow, which on"
    + " real images is too small.",
  clustered: "They come from how much whole views disagree (a sandwich covariance clustered by"
    + " view), so model and target errors that change from view to view are in them.",
  jackknife: "They come from leaving out one view at a time (a jackknife, shrunk towards the shape"
    + " of the bound), so model and target errors that change from view to view are in them.",
  prior: "They are assumed, not measured.",
  combined: "They combine a prior with measurements.",
};

const CONVENTION = "x points right, y down, z forward.";

const KIND_REASON = {
  jackknife: (frames, free) => "the small-sample form of the sandwich (kind jackknife), because"
    + ` ${frames} frames for ${free} parameters are fewer than three a parameter`,
  clustered: (frames, free) => "the sandwich clustered by frame, because"
    + ` ${frames} frames for ${free} parameters are three a parameter or more`,
  mvb: () => "the minimum variance bound itself: the corners' noise was taken to be white",
  prior: () => "as the rig file states it: assumed, not measured",
  combined: () => "of several calibrations or batches combined",
};

/** The sections of every rig; with several, a table of all before them. */
function rigs_sections(report) {
  const rigs = report.rigs ?? [];
  if (rigs.length > 1) calibrations_section(rigs);
  rigs.forEach((rig, i) => rig_sections(rig, i ? `rig-${i + 1}` : "rig", rigs.length > 1));
}

/** The sections that a rig has: [name of the part, heading, words in the contents, builder]. */
function rig_parts(rig) {
  return [
    [rig.corners?.length, "corners", "Corners and residuals", corners_content],
    [rig.projection || rig.depth?.length, "projection", "Uncertainty in pixels and in depth",
      projection_content],
    [rig.view_influence?.length, "views", "Influence of single views", views_content],
    [rig.proof, "proof", "Proof on views left out", proof_content],
  ].filter(([there]) => there).map(([, ...part]) => part);
}

function rig_sections(rig, id, several) {
  const of_rig = several ? ` · ${rig.file ?? id}` : "";
  const parts = rig_parts(rig);
  const first = section_named(id, `The stereo rig and how well it is known${of_rig}`,
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
    findings("Doubts", rig.calibration?.doubts),
    findings("Warnings of the calibration", rig.calibration?.warnings),
    calibration_tiles(rig.calibration), summary_table(rig),
    element("div", { class: "pair table-first" }, parameter_table(rig), directions_list(rig)),
    correlation_part(rig),
  ].filter(Boolean);
}

function findings(heading, list) {
  if (!list?.length) return null;
  return element("div", { class: "warning", role: "note" }, element("strong", {}, heading),
    element("ul", {}, list.map((words) => element("li", {}, words))));
}

/** How the calibration was made, in words. */
function summary_table(rig) {
  const { calibration } = rig;
  if (!calibration) return null;
  const all = calibration.corners_used + calibration.corners_left_out;
  const reason = KIND_REASON[rig.kind]?.(calibration.views, rig.free_parameters);
  const inflation = typical_inflation(rig);
  const warp = calibration.warp_m;
  const rows = [
    ["Views", `${counted(calibration.views, "frame")}${is_number(calibration.images)
      ? `, ${counted(calibration.images, "image")} with corners` : ""}`],
    ["Corners", is_number(calibration.corners_used) ? `${count(calibration.corners_used)} used,`
      + ` ${count(calibration.corners_left_out)} left out as outliers`
      + ` (${percent(calibration.corners_left_out / all)})` : DASH],
    ["Parameters", `${count(rig.free_parameters ?? rig.names?.length)} estimated; `
      + (calibration.held?.length ? `held: ${calibration.held.join(", ")}` : "none held")],
    ["Degrees of freedom", `${count(calibration.dof)}: corner coordinates less parameters and six a`
      + " frame for the board's pose"],
    ["Prior", calibration.prior_dof > 0 ? `knows ${counted(calibration.prior_dof, "parameter")};`
      + ` the solution is χ² = ${significant(calibration.prior_chi2, 3)} from it` : "none"],
    ["Board", warp ? `bent by ${significant(1e3 * warp[0], 2)} mm along its rows and`
      + ` ${significant(1e3 * warp[1], 2)} mm along its columns, estimated too`
      : "taken as its file says, no warp estimated"],
    ["Covariance", reason ? reason + (inflation ? `. It is ${significant(inflation, 2)} times the`
      + " bound in standard deviation, on average" : "") : "none"],
  ];
  return table("How it was calibrated", [
    { head: "What", text: true, cell: ([name]) => name },
    { head: "Here", text: true, cell: ([, words]) => words },
  ], rows, { wide: false });
}

/** Geometric mean of σ over the bound's σ; nothing where the two are the same. */
function typical_inflation(rig) {
  if (rig.kind === "mvb") return null;
  const ratios = (rig.sigma ?? []).map((s, i) => s / (rig.sigma_mvb?.[i] ?? 0))
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
      "a coordinate of a corner"),
    tile("Corner noise", is_number(pixel_sigma_px) ? `${significant(pixel_sigma_px, 2)} px` : null,
      "standard deviation used as weight"),
    tile("χ² a degree of freedom", dof > 0 ? significant(chi2 / dof, 3) : null,
      `χ² = ${significant(chi2, 4)}, ${count(dof)} degrees; 1 is expected if the noise is as`
      + " stated"),
    tile("Views", count(views), "frames used"));
}

function parameter_table(rig) {
  if (!rig.names) return null;
  const rows = rig.names.map((name, i) => ({ name, value: rig.values?.[i], sigma: rig.sigma?.[i],
    bound: rig.sigma_mvb?.[i] }));
  const caption = "Parameters with their standard deviations σ, each with all others uncertain"
    + ` too. ${KIND_MEANING[rig.kind] ?? ""} ${CONVENTION}`
    + (rig.sigma_mvb ? " Beside them the minimum variance bound: what corner noise alone would"
      + " allow; the ratio says how much too sure the bound is." : "");
  return element("div", {}, element("h3", {}, "Parameters"), table(caption, [
    { head: "Parameter", text: true, cell: (row) => element("code", {}, row.name) },
    { head: "Meaning", text: true, cell: (row) => parameter_meaning(row.name) },
    { head: "Value", cell: (row) => value_beside_sigma(row.value, row.sigma) },
    { head: "σ", cell: (row) => row.sigma === 0 ? "held" : significant(row.sigma, 2) },
    { head: "σ of the bound", cell: (row) => row.bound > 0 ? significant(row.bound, 2) : DASH },
    { head: "Ratio", cell: (row) => row.bound > 0 ? significant(row.sigma / row.bound, 2) : DASH },
  ], rows, { wide: false }));
}

function parameter_meaning(name) {
  const found = PARAMETER_MEANING.find(([pattern]) => pattern.test(name));
  return found ? name.match(found[0])[0].replace(found[0], found[1]) : DASH;
}

function calibrations_section(rigs) {
  const left_out = (rig) => rig.proof?.models?.rows?.find((row) => row.in_use)?.held_out_rms_px;
  const covered = (rig, key) => rig.proof?.left_out?.rows?.[0]?.[key];
  section("calibrations", "Calibrations side by side", table(
    "A smaller residual alone does not make a model right: a richer one always fits its own views"
    + " better, so views left out are the judge. And no covariance covers what a model cannot"
    + " follow.", [
      { head: "Calibration", text: true, cell: (rig) => rig.name ?? rig.file ?? DASH },
      { head: "Views", cell: (rig) => count(rig.calibration?.views) },
      { head: "Residual RMS", small: "px",
        cell: (rig) => significant(rig.calibration?.rms_px, 3) },
      { head: "Corner noise", small: "px",
        cell: (rig) => significant(rig.calibration?.pixel_sigma_px, 3) },
      { head: "Views left out", small: "RMS, px", cell: (rig) => significant(left_out(rig), 3) },
      { head: "σ over bound", small: "on average",
        cell: (rig) => significant(typical_inflation(rig), 2) },
      { head: "Boards left out", small: "inside 95 %, honest",
        cell: (rig) => percent(covered(rig, "coverage_honest"), 0) },
      { head: "Boards left out", small: "inside 95 %, bound",
        cell: (rig) => percent(covered(rig, "coverage_mvb"), 0) },
    ], rigs, { wide: false }));
}

const DIRECTIONS_SHOWN = 8;

function directions_list(rig) {
  const all = (rig.directions ?? []).filter((d) => d.share > 1e-9);
  if (!all.length) return null;
  const bars = (list) => element("ul", { class: "bars" }, list.map(({ share, words }) =>
    element("li", {}, element("span", { class: "share" }, percent(share)),
      element("span", { class: "bar", "aria-hidden": "true" },
        element("i", { style: `width:${100 * Math.min(1, share)}%` })),
      element("span", {}, words))));
  const condition = is_number(rig.scaled_condition) ? " The covariance has condition number"
    + ` ${significant(rig.raw_condition, 2)}, and ${significant(rig.scaled_condition, 2)} once each`
    + " parameter is counted in its own standard deviation." : "";
  const rest = all.slice(DIRECTIONS_SHOWN);
  return element("div", {}, element("h3", {}, "Directions in which the calibration is loose"),
    element("p", { class: "reading" }, "Errors of parameters come together. Counted in standard"
      + " deviations, the uncertainty splits into independent directions (the singular vectors of"
      + " the scaled covariance); the bar is each one's share of the whole. A few large shares"
      + " mean that a few joint errors make up most of what is unknown."
      + condition),
    bars(all.slice(0, DIRECTIONS_SHOWN)),
    rest.length > 0 && element("details", {}, element("summary", {}, `The other ${rest.length},`
      + ` together ${percent(sum_of(rest, (one) => one.share))}`), bars(rest)));
}
