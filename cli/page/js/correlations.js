// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, table } from "./elements.js";
import { fixed, plot_text } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, axis, figure } from "./plot.js";

/** Heat map of correlations and a table of the strongest ones. */
export function correlation_part(rig) {
  const matrix = rig.correlation;
  if (!matrix?.length || !rig.correlation_names) return null;
  const n = rig.correlation_names.length;
  const strongest = strongest_correlations(rig, 8);
  return element("div", { class: "pair" },
    figure("Correlations", "Blue: positive correlation; orange: negative; white: none. Strong"
      + " colours off the diagonal mark pairs of parameters that the calibration can barely"
      + " separate, so the σ of one alone is not meaningful.",
      `Correlation matrix of ${n} parameters; the strongest are listed in the table.`,
      Math.max(360, 150 + 23 * n), () => correlation_plot(rig)),
    element("div", {}, element("h3", {}, "Strongest correlations"),
      table("Pairs with the largest correlation", [
        { head: "Parameter", text: true, cell: (row) => element("code", {}, row.a) },
        { head: "with", text: true, cell: (row) => element("code", {}, row.b) },
        { head: "Correlation", cell: (row) => fixed(row.value, 3) },
      ], strongest)));
}

function strongest_correlations({ correlation_names: names, correlation }, number) {
  const pairs = [];
  for (let i = 0; i < names.length; ++i) {
    for (let j = 0; j < i; ++j) {
      pairs.push({ a: names[j], b: names[i], value: correlation[i][j] });
    }
  }
  return pairs.filter((pair) => is_number(pair.value))
    .sort((p, q) => Math.abs(q.value) - Math.abs(p.value)).slice(0, number);
}

function correlation_plot({ correlation_names: names, correlation }) {
  const labels = names.map(plot_text);
  return {
    data: [{
      type: "heatmap", x: labels, y: labels, z: correlation, zmin: -1, zmax: 1, xgap: 1, ygap: 1,
      colorscale: [[0, COLOUR.red], [0.5, "#ffffff"], [1, COLOUR.blue]],
      colorbar: { thickness: 10, len: 0.9, tickvals: [-1, -0.5, 0, 0.5, 1],
        ticktext: ["−1", "−0.5", "0", "0.5", "1"], outlinewidth: 0 },
      hovertemplate: "%{x}<br>%{y}<br>correlation %{z:.3f}<extra></extra>",
    }],
    layout: {
      margin: { l: 10, r: 10, t: 10, b: 10 },
      xaxis: axis("", { tickangle: -60, tickfont: { size: 11 }, showgrid: false, ticks: "" }),
      yaxis: axis("", { autorange: "reversed", tickfont: { size: 11 }, showgrid: false,
        ticks: "" }),
    },
  };
}
