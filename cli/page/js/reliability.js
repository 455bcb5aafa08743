// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { element, paragraph, section } from "./elements.js";
import { count, percent, plot_text } from "./format.js";
import { is_number } from "./numbers.js";
import { COLOUR, axis, figure, log_axis, series_colour } from "./plot.js";

const with_reliability = (study) => study.cells.filter((cell) => cell.reliability?.length);
const with_thresholds = (study) => study.cells.filter((cell) => cell.thresholds?.length);

/** Whether the probabilities that a localiser states are true, and what abstaining gains. */
export function reliability_section(study) {
  if (!with_reliability(study).length) return;
  const made = section("reliability", "Stated and observed errors", paragraph(
    "The localiser states how probable it is that its answer is wrong, further than 1 m from the"
      + " truth. Answers are sorted by this"
      + " statement; where it is true, as many of them are wrong as it says."));
  const plots = [reliability_figure(study), threshold_figure(study)].filter(Boolean);
  if (plots.length) made.append(element("div", { class: "pair" }, plots));
}

function reliability_figure(study) {
  return figure("Reliability", "Dots: answers of one range of stated error rates; bars: 95 %"
    + " intervals of what was observed. Dashed line: statements that are true. Ranges without"
    + " wrong answers are drawn at the upper end of their interval, with an open symbol.",
    "Observed against stated error rates; true statements lie on the diagonal.", 400,
    () => reliability_plot(study));
}

/** Zero has no place on a logarithmic axis. */
const shown = (bin) => bin.wrong > 0 ? bin.error : bin.error_interval_95[1];

function reliability_plot(study) {
  const cells = with_reliability(study);
  const least = 1e-4;
  const data = cells.map((cell, i) => {
    const bins = cell.reliability;
    return {
      type: "scatter", mode: "lines+markers", name: plot_text(cell.label),
      x: bins.map((bin) => Math.max(least, bin.stated_error)), y: bins.map(shown),
      error_y: { type: "data", symmetric: false, thickness: 1, width: 4,
        array: bins.map((bin) => bin.error_interval_95[1] - shown(bin)),
        arrayminus: bins.map((bin) => bin.wrong > 0 ? bin.error - bin.error_interval_95[0] : 0) },
      line: { color: series_colour(i), width: 1 },
      marker: { size: 8, symbol: bins.map((bin) => bin.wrong > 0 ? "circle" : "circle-open") },
      showlegend: cells.length > 1,
      customdata: bins.map((bin) => [plot_text(cell.label), count(bin.wrong), count(bin.answers)]),
      hovertemplate: "%{customdata[0]}<br>stated %{x:.2g}<br>%{customdata[1]} of %{customdata[2]}"
        + " wrong<extra></extra>",
    };
  });
  data.push({ type: "scatter", mode: "lines", x: [least, 1], y: [least, 1], hoverinfo: "skip",
    showlegend: false, line: { color: COLOUR.ink, width: 1.2, dash: "dash" } });
  const layout = { xaxis: log_axis("stated error rate", [least, 1]),
    yaxis: log_axis("observed error rate", [least, 1]) };
  return { data, layout };
}

function threshold_figure(study) {
  if (!with_thresholds(study).length) return null;
  return figure("Abstaining", "How many of the answers are wrong, against how many queries are"
    + " answered, as the threshold of the stated error rate moves.",
    "Error rate of the answers against the share of queries answered.", 400,
    () => threshold_plot(study));
}

function threshold_plot(study) {
  const cells = with_thresholds(study);
  const rate = (at) => at.answered > 0 ? 100 * at.wrong / at.answered : null;
  const data = cells.map((cell, i) => ({
    type: "scatter", mode: "lines+markers", name: plot_text(cell.label),
    x: cell.thresholds.map((at) => 100 * at.coverage), y: cell.thresholds.map(rate),
    line: { color: series_colour(i), width: 1.5 }, marker: { size: 6, symbol: i },
    showlegend: cells.length > 1,
    customdata: cell.thresholds.map((at) => [plot_text(cell.label), percent(at.max_error_rate, 3),
      count(at.wrong), count(at.answered), percent(at.stated_error, 3)]),
    hovertemplate: "%{customdata[0]}<br>each stated at most %{customdata[1]}, together"
      + " %{customdata[4]}<br>%{customdata[2]} of %{customdata[3]} wrong<extra></extra>",
  }));
  const lowest = Math.min(...data.flatMap((trace) => trace.x.filter(is_number)));
  return { data, layout: { xaxis: axis("queries answered, %", { range: [lowest - 1, 100.5] }),
    yaxis: axis("wrong answers, %", { rangemode: "tozero" }) } };
}
