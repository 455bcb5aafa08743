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

function rig_section(report) {
  const { rig } = report;
  const made = section("rig", "The stereo rig and how well it is known", cameras_words(rig));
  const warnings = rig.calibration?.warnings ?? [];
  if (warnings.length) {
    made.append(element("div", { class: "warning", role: "note" },
      element("strong", {}, warnings.length === 1 ? "Warning of the calibration"
        : "Warnings of the calibration"),
      element("ul", {}, warnings.map((words) => element("li", {}, words)))));
  }
  const residuals = (rig.residuals ?? []).map((one) => residual_figure(rig, one)).filter(Boolean);
  made.append(...[calibration_tiles(rig.calibration),
    element("div", { class: "pair table-first" },
      element("div", {}, parameter_table(rig), models_table(report.calibrations)),
      element("div", {}, directions_list(rig))),
    correlation_part(rig), depth_part(rig),
    residuals.length && element("div", { class: "pair" }, residuals),
  ].filter(Boolean));
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
    { head: "σ", cell: (row) => significant(row.sigma, 2) },
    { head: "σ of the bound", cell: (row) => significant(row.bound, 2) },
    { head: "Ratio", cell: (row) => row.bound > 0 ? significant(row.sigma / row.bound, 2) : DASH },
  ], rows, { wide: false }));
}

function parameter_meaning(name) {
  const found = PARAMETER_MEANING.find(([pattern]) => pattern.test(name));
  return found ? name.match(found[0])[0].replace(found[0], found[1]) : DASH;
}

function models_table(calibrations) {
  if (!calibrations?.length) return null;
  return element("div", {}, element("h3", {}, "Camera models and calibrations"), table(
    "A smaller residual alone does not make a model right: a richer one always fits its own views"
    + " better. And no covariance covers what a model cannot follow.", [
      { head: "Calibration", text: true, cell: (row) => row.name ?? DASH },
      { head: "Residual RMS, px", cell: (row) => significant(row.rms_px, 3) },
      { head: "Corner noise, px", cell: (row) => significant(row.pixel_sigma_px, 2) },
      { head: "Views", cell: (row) => count(row.views) },
    ], calibrations, { wide: false }));
}

function directions_list(rig) {
  const shown = (rig.directions ?? []).filter((d) => is_number(d.share));
  if (!shown.length) return null;
  const rows = shown.map(({ share, words }) => element("li", {},
    element("span", { class: "share" }, percent(share)),
    element("span", { class: "bar", "aria-hidden": "true" },
      element("i", { style: `width:${100 * Math.min(1, share)}%` })),
    element("span", {}, words)));
  const condition = is_number(rig.scaled_condition) ? " The covariance has condition number"
    + ` ${significant(rig.raw_condition, 2)}, and ${significant(rig.scaled_condition, 2)} once each`
    + " parameter is counted in its own standard deviation." : "";
  return element("div", {}, element("h3", {}, "Directions in which the calibration is loose"),
    element("p", { class: "reading" }, "Errors of parameters come together. Counted in standard"
      + " deviations, the uncertainty splits into independent directions; the bar is each"
      + " one's share of the whole. A few large shares mean that a few joint errors"
      + " make up most of what is unknown."
      + condition),
    element("ul", { class: "bars" }, rows));
}
