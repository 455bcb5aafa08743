// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_comparison/compared_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string_view>

#include "calib/error.h"
#include "calib/statistics/quantile.h"
#include "sim/image_comparison/comparison_figures.h"
#include "sim/image_comparison/edge_sample.h"
#include "sim/images/true_edges.h"
#include "sim/sources.h"
#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {
namespace {

using SumsByPair = std::map<int, Sums>;

double default_of(std::string_view key) {
  if (const SourceParameter* found = source_parameter(key)) return SourceSettings{}.*found->value;
  throw Error("compared sources", "there is no setting '" + std::string(key) + "'",
              "use one of docs/simulation.md");
}

double share(const Sums& s) { return s.whole > 0 ? s.part / s.whole : std::nan(""); }

ComparedSource unseen(const ComparedEdges& compared, const MeasuringOptions& options) {
  SumsByPair sums;
  for (const EdgeSample& edge : compared.edges) {
    sums[edge.pair].part += is_unseen(edge) ? 1 : 0;
    sums[edge.pair].whole += 1;
  }
  return {"unseen", measured_ratio(sums, static_cast<int>(compared.edges.size()), options, share),
          default_of("unseen"), "true edges of which no part is on segments of both images"};
}

ComparedSource edge_loss(const ComparedEdges& compared, const MeasuringOptions& options) {
  SumsByPair sums;
  int edges = 0;
  for (const EdgeSample& edge : compared.edges) {
    if (is_unseen(edge)) continue;
    sums[edge.pair].part += edge.length_px - edge.both_found_px;
    sums[edge.pair].whole += edge.length_px;
    ++edges;
  }
  return {"edge_loss", measured_ratio(sums, edges, options, share), default_of("edge_loss"),
          "share of the length of the other true edges that is not on segments of both images"};
}

ComparedSource lateral_shift(const ComparedEdges& compared, const MeasuringOptions& options) {
  constexpr double mean_square = 13.0 / 12;  // of U(1/2, 3/2)
  SumsByPair sums;
  int edges = 0;
  for (const EdgeSample& edge : compared.edges) {
    const double product = edge.shift_px[0] * edge.shift_px[1];
    if (std::isnan(product)) continue;
    sums[edge.pair].part += product;
    sums[edge.pair].whole += 1;
    ++edges;
  }
  return {"lateral_shift_px",
          measured_ratio(sums, edges, options,
                         [](const Sums& s) {  // a share of nothing stays unknown
                           return share(s) < 0 ? 0 : std::sqrt(share(s) / mean_square);
                         }),
          default_of("lateral_shift_px"), "of the line from the true edge, common to both images"};
}

ComparedSource endpoint_sigma(const ComparedEdges& compared, const MeasuringOptions& options) {
  std::vector<double> all;
  const auto each = [&](const auto& visit) {
    for (const EdgeSample& edge : compared.edges) {
      for (const EndError& end : edge.ends) {
        if (end.found && end.kind == EdgeEnd::corner && edge.both_found_px > 0)
          visit(edge, end.across_px);
      }
    }
  };
  each([&](const EdgeSample&, double across) { all.push_back(across); });
  const double limit = 3 * robust_deviation(all);
  SumsByPair sums;
  int ends = 0;
  each([&](const EdgeSample& edge, double across) {
    if (std::abs(across) > limit) return;
    sums[edge.pair].part += across * across;
    sums[edge.pair].whole += 1;
    ++ends;
  });
  return {"endpoint_sigma_px",
          measured_ratio(sums, ends, options, [](const Sums& s) { return std::sqrt(share(s)); }),
          default_of("endpoint_sigma_px"), "across the line, at ends of the wire frame's segments"};
}

/// psi_s and its reach: the uniform range with the same median, as characterise defines it.
std::vector<ComparedSource> stereo_mismatch(const ComparedEdges& compared,
                                            std::size_t matcher,
                                            const MeasuringOptions& options) {
  constexpr double threshold_px = 3;
  SumsByPair sums;
  int matched = 0;
  std::vector<double> wrong;
  for (const EdgeSample& edge : compared.edges) {
    const MatchedEdge& match = edge.matches[matcher];
    if (!match.matched) continue;
    ++matched;
    sums[edge.pair].whole += 1;
    if (!match.is_wrong()) continue;
    sums[edge.pair].part += 1;
    wrong.push_back(std::abs(match.error_px));
  }
  MeasuredValue reach;
  reach.samples = static_cast<int>(wrong.size());
  double beyond = 1;
  if (reach.samples >= options.wrong_for_reach) {
    reach.value = 2 * vernier::internal::median_or_zero(wrong) - threshold_px;
    beyond = 1 - threshold_px / reach.value;
  }
  const std::string name = compared.matchers[matcher];
  return {{"stereo_mismatch",
           measured_ratio(sums, matched, options,
                          [=](const Sums& s) { return std::min(1.0, share(s) / beyond); }),
           default_of("stereo_mismatch"), fmt::format("of matched lines, matcher {}", name)},
          {"stereo_mismatch_px", reach, default_of("stereo_mismatch_px"),
           "± range with the median error of the mismatches"}};
}

ComparedSource clutter(const ComparedEdges& compared, const MeasuringOptions& options) {
  SumsByPair sums;
  for (int pair = 0; pair < compared.pairs(); ++pair) {
    sums[pair].part = static_cast<double>(compared.false_px[static_cast<std::size_t>(pair)].size());
  }
  for (const EdgeSample& edge : compared.edges) sums[edge.pair].whole += 1;
  return {"clutter", measured_ratio(sums, static_cast<int>(compared.edges.size()), options, share),
          default_of("clutter"), "segments that no edge of the world explains, per edge in view"};
}

}  // namespace

std::vector<ComparedSource> compared_sources(const ComparedEdges& compared,
                                             std::size_t matcher,
                                             const MeasuringOptions& options) {
  std::vector<ComparedSource> sources{
      unseen(compared, options), clutter(compared, options), lateral_shift(compared, options),
      edge_loss(compared, options), endpoint_sigma(compared, options)};
  for (ComparedSource& source : stereo_mismatch(compared, matcher, options)) {
    sources.push_back(std::move(source));
  }
  return sources;
}

std::string compared_sources_toml(const std::vector<ComparedSource>& sources,
                                  const std::string& how) {
  std::string text =
      "# Error sources as rendered images show them: vernier render --compare "
      "(docs/images.md)\n# " +
      how + "\n# Comments: the 95 % interval over pairs, and the simulator's default.\n[sources]\n";
  for (const ComparedSource& s : sources) {
    if (!s.shown.known()) {
      text += fmt::format("# {}: not measured, default {:g} kept\n", s.key, s.otherwise);
      continue;
    }
    const bool has_interval = !std::isnan(s.shown.interval.low);
    text += fmt::format("{} = {:.4g}  # {}default {:g}; {}\n", s.key, s.shown.value,
                        has_interval ? fmt::format("{:.4g} to {:.4g}, ", s.shown.interval.low,
                                                   s.shown.interval.high)
                                     : "",
                        s.otherwise, s.note);
    if (s.key == "lateral_shift_px") text += "lateral_shift_mode = \"common\"\n";
  }
  return text;
}

}  // namespace vernier::sim::internal
