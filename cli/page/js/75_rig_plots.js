// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

/** Heat map of correlations, and the strongest of them in words. */
function correlation_part(rig) {
  const matrix = rig.correlation;
  if (!matrix?.length || !rig.correlation_names) return null;
  const n = rig.correlation_names.length;
  const strongest = strongest_correlations(rig, 8);
  return element("div", { class: "pair" },
    figure("Correlations", "Blue: two parameters err together in the same sense; orange: in"
      + " opposite senses; white: independently. Strong colours off the diagonal are pairs that"
      + " the calibration hardly tells apart, so that σ of one alone says little.",
      `Correlation matrix of ${n} parameters; the strongest are in the table beside it.`,
      Math.max(360, 150 + 23 * n), () => correlation_plot(rig)),
    element("div", {}, element("h3", {}, "Strongest correlations"),
      table("Pairs by size of correlation", [
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

/** Depth uncertainty against range: plot, and the numbers in a table. */
function depth_part(rig) {
  const rows = (rig.depth ?? []).filter((row) => is_number(row.range_m));
  if (!rows.length) return null;
  const numbers = element("div", {}, element("h3", {}, "Depth in numbers"), table(
    "Standard deviation of depth by calibration error alone (ψ_c = 1)", [
      { head: "Range, m", cell: (row) => setting(row.range_m) },
      { head: "Linear, m", cell: (row) => significant(row.sigma_linear_m, 2) },
      { head: "Sampled, m", cell: (row) => significant(row.sigma_sampled_m, 2) },
      { head: "Linear", small: "share of range",
        cell: (row) => percent(row.sigma_linear_m / row.range_m) },
      { head: "Non-physical", small: "draws without depth",
        cell: (row) => percent(row.non_physical_share) },
    ], rows));
  return element("div", { class: "pair" }, depth_figure(rows), numbers);
}

function depth_figure(rows) {
  const lost = rows.filter((row) => row.non_physical_share > 0.001);
  const warning = lost.length ? ` From ${setting(lost[0].range_m)} m on, some sampled rigs`
    + " put the point at no positive depth at all: there a standard deviation says little." : "";
  return figure("Depth uncertainty against range", "How far a point's depth may be off because of"
    + " calibration alone, on doubly logarithmic axes: a straight line of slope 2 is the growth"
    + " with the square of range that stereo expects. Linear: derivatives at the calibrated rig."
    + " Sampled: rigs drawn from the covariance. Where the two part, depth has left the range in"
    + ` which it is linear: trust the sampled one.${warning}`,
    "Standard deviation of depth against range, linear and sampled; the numbers are in the table"
    + " beside it.", 400, () => depth_plot(rows));
}

function depth_plot(rows) {
  const ranges = rows.map((row) => row.range_m);
  const line = (key, name, color, dash, symbol) => ({
    type: "scatter", mode: "lines+markers", name, x: ranges, y: rows.map((row) => row[key]),
    line: { color, dash, width: 2 }, marker: { size: 7, symbol },
    hovertemplate: `${name}: %{y:.2g} m at %{x:.3g} m<extra></extra>`,
  });
  const sigmas = rows.flatMap((row) => [row.sigma_linear_m, row.sigma_sampled_m]);
  return {
    data: [line("sigma_linear_m", "linear", COLOUR.blue, "solid", "circle"),
      line("sigma_sampled_m", "sampled", COLOUR.red, "dash", "square-open")],
    layout: { xaxis: log_axis("range, m", ranges), yaxis: log_axis("σ of depth, m", sigmas) },
  };
}
