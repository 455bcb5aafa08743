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

const FROM_SCATTER = "They are estimated from the scatter between frames, corrected for their"
  + " number and shrunk towards the shape of the bound (cluster-robust sandwich covariance), so"
  + " they include model and target errors that vary from frame to frame.";

const KIND_MEANING = {
  mvb: "They are the minimum variance bound, which only includes corner noise and is too small"
    + " for real images.",
  clustered: FROM_SCATTER,
  jackknife: FROM_SCATTER,
  prior: "They are assumed, not measured.",
  combined: "They combine a prior with measurements.",
};

const TRUE_BOUND = "They are the minimum variance bound, and here it holds: the scatter of the"
  + " views agrees with white noise, as for simulated views.";

const CONVENTION = "x points right, y down, z forward.";

/** Whether the covariance is the bound itself, so that a comparison with the bound is pointless. */
export const is_bound = (rig) => rig.kind === "mvb";

export function parameter_table(rig) {
  if (!rig.names) return null;
  const beside = is_bound(rig) ? null : rig.sigma_mvb;
  const rows = rig.names.map((name, i) => ({ name, value: rig.values?.[i], sigma: rig.sigma?.[i],
    bound: beside?.[i] }));
  const meaning = rig.true_bound ? TRUE_BOUND : KIND_MEANING[rig.kind] ?? "";
  const caption = "Parameters with their marginal standard deviations σ." + ` ${meaning}`
    + ` ${CONVENTION}`
    + (beside ? " For comparison: the minimum variance bound, from corner noise only; the ratio"
    + " shows how much the bound underestimates σ." : "");
  return element("div", {}, element("h3", {}, "Parameters"), table(caption, [
    { head: "Parameter", text: true, cell: (row) => element("code", {}, row.name) },
    { head: "Meaning", text: true, cell: (row) => parameter_meaning(row.name) },
    { head: "Value", cell: (row) => value_beside_sigma(row.value, row.sigma) },
    { head: "σ", cell: (row) => row.sigma === 0 ? "fixed" : significant(row.sigma, 2) },
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
  const condition = is_number(rig.scaled_condition) ? " The condition number of the covariance"
    + ` is ${significant(rig.raw_condition, 2)}, or ${significant(rig.scaled_condition, 2)}`
    + ` after scaling`
    + " each parameter by its standard deviation." : "";
  const rest = all.slice(DIRECTIONS_SHOWN);
  return element("div", {}, element("h3", {}, "Principal directions of the uncertainty"),
    element("p", { class: "reading" }, "Parameter errors are correlated. Scaled by the standard"
      + " deviations, the uncertainty splits into independent directions (singular vectors of the"
      + " scaled covariance); bars show the fraction of the total variance. A few large fractions"
      + " mean that a few combined errors dominate the uncertainty."
      + condition),
    bars(all.slice(0, DIRECTIONS_SHOWN)),
    rest.length > 0 && element("details", {}, element("summary", {}, `The other`
      + ` ${rest.length}, ${percent(sum_of(rest, (one) => one.share))} in`
      + ` total`), bars(rest)));
}
