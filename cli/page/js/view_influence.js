// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, table } from "./elements.js";
import { DASH, count, fixed, percent, significant } from "./format.js";
import { is_number, ratio, sum_of } from "./numbers.js";
import { COLOUR, axis, figure } from "./plot.js";

const view_name = ({ images, frame }) => images?.length ? images[0].replace(/\.\w+$/, "")
  : `frame ${frame}`;

/** Influence of every frame on the estimate. */
export function views_content(rig) {
  const views = rig.view_influence;
  const together = Math.sqrt(sum_of(views, (v) => v.influence ** 2)
    / sum_of(views, (v) => v.influence_noise ** 2));
  return [
    element("p", {}, "The influence of a view is the change of the estimate without this view's"
      + " residuals, as a single length over all parameters in standard deviations of the minimum"
      + " variance bound. For comparison, the value expected from independent noise alone is"
      + " shown. A view with a much larger influence than this, and than the other views, has a"
      + " specific error: bent or moving board, blur, wrong corners, or a pose at which the"
      + " camera model fails. Inspect the image before removing the view: informative views have"
      + " a large influence, and a set without them may only appear to be better."),
    element("p", {}, `The overall influence is ${significant(together, 2)} times that expected`
      + " from independent noise"
      + (together > 1.2 ? ": the covariance from the scatter of the views is wider than the bound"
      + " by about this factor." : ".")),
    influence_figure(views, standing_out(views, together)), rms_figure(rig), views_table(views),
  ];
}

const views_axis = (views) => axis("", { type: "category", tickangle: views.length > 8 ? -60 : 0,
  showgrid: false, tickfont: { size: 11 }, dtick: Math.ceil(views.length / 50) });

const MOST_BARS = 60;

/** The ratio to the noise expectation above which a view is highlighted. */
const standing_out = (views, together) =>
  Math.max(views.length > MOST_BARS ? 3 : 2, 1.5 * together);

function influence_figure(views, far) {
  const many = views.length > MOST_BARS;
  const reading = "Change of the estimate without the view's residuals, in standard deviations of"
    + " the bound"
    + (many ? ", against the expectation from independent noise (root mean square). Line: equality."
      : ". Marks: expected from independent noise (root mean square).")
    + ` Orange: more than ${significant(far, 2)} times that, which is unlikely for noise and 1.5`
    + " times the overall ratio.";
  return figure("Influence of every view", reading,
    "Influence of every view; the largest are in the table below.", many ? 440 : 360,
    () => (many ? influence_cloud : influence_bars)(views, far));
}

function influence_bars(views, far) {
  const x = views.map(view_name);
  const stands_out = (v) => v.influence > far * v.influence_noise;
  const bars = (name, color, wanted) => ({ type: "bar", name, x, marker: { color },
    y: views.map((v) => wanted(v) ? v.influence : null),
    hovertemplate: "%{x}: %{y:.2f}<extra></extra>" });
  const data = [bars("influence", COLOUR.sky, (v) => !stands_out(v)),
    bars("high influence", COLOUR.red, stands_out)]
    .filter((trace) => trace.y.some(is_number));
  return {
    data: [...data, { type: "scatter", mode: "markers", name: "independent noise", x,
      y: views.map((v) => v.influence_noise), marker: { symbol: "line-ew", size: 12,
        line: { color: COLOUR.ink, width: 2.4 } },
      hovertemplate: "expected from noise: %{y:.2f}<extra></extra>" }],
    layout: { bargap: 0.25, barmode: "overlay", xaxis: { ...views_axis(views),
      categoryorder: "array", categoryarray: x },
    yaxis: axis("influence, standard deviations", { rangemode: "tozero" }) },
  };
}

/** For many views: a point per view instead of bars. */
function influence_cloud(views, far) {
  const stands_out = (v) => v.influence > far * v.influence_noise;
  const points = (name, color, list) => ({ type: "scatter", mode: "markers", name,
    x: list.map((v) => v.influence_noise), y: list.map((v) => v.influence),
    text: list.map(view_name), marker: { color, size: 6, opacity: 0.8 },
    hovertemplate: "%{text}: %{y:.3f}, noise %{x:.3f}<extra></extra>" });
  const end = Math.max(...views.map((v) => v.influence_noise));
  return {
    data: [points("view", COLOUR.blue, views.filter((v) => !stands_out(v))),
      points("view with high influence", COLOUR.red, views.filter(stands_out)),
      { type: "scatter", mode: "lines", name: "expected from noise", x: [0, end], y: [0, end],
        line: { color: COLOUR.ink, width: 1.4, dash: "dot" }, hoverinfo: "skip" }]
      .filter((trace) => trace.x.length),
    layout: { hovermode: "closest",
      xaxis: axis("expected from independent noise, standard deviations", { rangemode: "tozero" }),
      yaxis: axis("influence, standard deviations", { rangemode: "tozero" }) },
  };
}

function rms_figure(rig) {
  const views = rig.view_influence;
  const whole = rig.calibration?.rms_px;
  return figure("Residual of every view", "Root mean square residual per coordinate; line: all"
    + " views. A view with a small residual may still have a large influence, and vice versa.",
    "Residual of every view; values are in the table below.", 300, () => ({
      data: [{ type: "bar", name: "rms", x: views.map(view_name), y: views.map((v) => v.rms_px),
        marker: { color: COLOUR.grey }, hovertemplate: "%{x}: %{y:.3f} px<extra></extra>" }],
      layout: { bargap: views.length > MOST_BARS ? 0 : 0.25, xaxis: views_axis(views),
        showlegend: false,
        yaxis: axis("rms residual, px", { rangemode: "tozero" }),
        shapes: is_number(whole) ? [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: whole,
          y1: whole, line: { color: COLOUR.ink, width: 1.4, dash: "dot" } }] : [] },
    }));
}

function views_table(views) {
  const most = 20;
  const rows = [...views].sort((a, b) => b.influence / b.influence_noise
    - a.influence / a.influence_noise).slice(0, most);
  const caption = (views.length > most ? `The ${most} of ${count(views.length)} views` : "Views")
    + " sorted by influence relative to noise. Leverage: information of the view in units of"
    + " parameters (all views together: the number of parameters). Best determined direction: the"
    + " view's fraction of the information in that direction; near 100 % no other view"
    + " contributes. If removed: change of the estimate without the view and its information, and"
    + " the parameter that changes most (in its honest σ).";
  return table(caption, [
    { head: "Frame", text: true, cell: (v) => v.images?.length
      ? `${v.frame}: ${v.images.join(", ")}` : String(v.frame) },
    { head: "Corners", cell: (v) => count(v.corners) },
    { head: "RMS", small: "px", cell: (v) => significant(v.rms_px, 3) },
    { head: "Influence", cell: (v) => significant(v.influence, 3) },
    { head: "Expected", small: "from noise", cell: (v) => significant(v.influence_noise, 3) },
    { head: "Ratio", cell: (v) => significant(ratio(v.influence, v.influence_noise), 2) },
    { head: "Leverage", cell: (v) => significant(v.leverage, 3) },
    { head: "Best determined", small: "direction", cell: (v) => percent(v.largest_share, 0) },
    { head: "If removed", small: "bound's σ", cell: (v) => significant(v.influence_left_out, 3) },
    { head: "Largest change", text: true, cell: ({ largest_move: m }) => m
      ? `${m.name} by ${m.sigmas > 0 ? "+" : ""}${fixed(m.sigmas, 2)} σ` : DASH },
  ], rows);
}
