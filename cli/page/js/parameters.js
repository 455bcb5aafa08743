// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, table } from "./elements.js";
import { DASH, percent, significant, value_beside_sigma } from "./format.js";
import { is_number, ratio, sum_of } from "./numbers.js";

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
  clustered: "They come from how much whole frames disagree (a sandwich covariance clustered by"
    + " frame), so model and target errors that change from frame to frame are in them.",
  jackknife: "They come from how much whole frames disagree, corrected for few frames and shrunk"
    + " towards the shape of the bound (a small-sample, jackknife-type covariance), so model and"
    + " target errors that change from frame to frame are in them.",
  prior: "They are assumed, not measured.",
  combined: "They combine a prior with measurements.",
};

const TRUE_BOUND = "They are the minimum variance bound, and here it holds: the views scatter as white"
  + " noise does, as simulated ones do.";

const CONVENTION = "x points right, y down, z forward.";

/** Whether the covariance is the bound itself, so that there is nothing to compare it with. */
export const is_bound = (rig) => rig.kind === "mvb";

export function parameter_table(rig) {
  if (!rig.names) return null;
  const beside = is_bound(rig) ? null : rig.sigma_mvb;
  const rows = rig.names.map((name, i) => ({ name, value: rig.values?.[i], sigma: rig.sigma?.[i],
    bound: beside?.[i] }));
  const meaning = rig.true_bound ? TRUE_BOUND : KIND_MEANING[rig.kind] ?? "";
  const caption = "Parameters with their standard deviations σ, each with all others uncertain"
    + ` too. ${meaning} ${CONVENTION}`
    + (beside ? " Beside them the minimum variance bound: what corner noise alone would"
      + " allow; the ratio says how much too sure the bound is." : "");
  return element("div", {}, element("h3", {}, "Parameters"), table(caption, [
    { head: "Parameter", text: true, cell: (row) => element("code", {}, row.name) },
    { head: "Meaning", text: true, cell: (row) => parameter_meaning(row.name) },
    { head: "Value", cell: (row) => value_beside_sigma(row.value, row.sigma) },
    { head: "σ", cell: (row) => row.sigma === 0 ? "held" : significant(row.sigma, 2) },
    { head: "σ of the bound", cell: (row) => row.bound > 0 ? significant(row.bound, 2) : DASH },
    { head: "Ratio", cell: (row) => row.bound > 0 ? significant(ratio(row.sigma, row.bound), 2) : DASH },
  ], rows, { wide: false }));
}

function parameter_meaning(name) {
  const found = PARAMETER_MEANING.find(([pattern]) => pattern.test(name));
  return found ? name.match(found[0])[0].replace(found[0], found[1]) : DASH;
}

const DIRECTIONS_SHOWN = 8;

export function directions_list(rig) {
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
