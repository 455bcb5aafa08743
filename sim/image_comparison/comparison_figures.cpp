// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_comparison/comparison_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "calib/statistics/quantile.h"
#include "sim/image_comparison/edge_sample.h"
#include "sim/images/true_edges.h"
#include "sim/images/wire_paint.h"

namespace vernier::sim::internal {

using vernier::internal::median_or_zero;

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double mean_square_of_shift = 13.0 / 12;  // of U(1/2, 3/2)

double ratio(double part, double whole) { return whole > 0 ? part / whole : nothing; }

/// Mean and standard deviation without what is beyond three robust standard deviations.
struct Spread {
  double mean = nothing, deviation = nothing;
};
Spread clipped(const std::vector<double>& values) {
  const double middle = median_or_zero(values), limit = 3 * robust_deviation(values);
  double sum = 0, sum2 = 0;
  int n = 0;
  for (const double x : values) {
    if (std::abs(x - middle) > limit) continue;
    sum += x;
    sum2 += x * x;
    ++n;
  }
  if (n < 2) return {};
  return {sum / n, std::sqrt(std::max(0.0, (sum2 - sum * sum / n) / (n - 1)))};
}

class EndErrors {
 public:
  explicit EndErrors(EdgeEnd kind) : kind_(kind) {}

  void add(const EdgeSample& edge) {
    for (const EndError& end : edge.ends) {
      if (end.kind != kind_ || edge.both_found_px == 0) continue;
      ++ends_;
      if (!end.found) continue;
      across_.push_back(end.across_px);
      along_.push_back(end.along_px);
    }
  }

  EndFigures figures() const {
    const Spread across = clipped(across_), along = clipped(along_);
    return {ends_, ratio(static_cast<double>(across_.size()), ends_), across.deviation,
            along.deviation, along.mean};
  }

 private:
  EdgeEnd kind_;
  int ends_ = 0;
  std::vector<double> across_, along_;
};

void add_loss(
    const EdgeSample& edge, EdgeFigures& f, int& partly, double& lost, double& in_longest) {
  constexpr double hardly = 0.02;
  const double loss = edge.length_px - edge.both_found_px;
  f.length_px += edge.length_px;
  f.left_loss += edge.length_px - edge.left_found_px;
  f.pair_loss += loss;
  if (loss <= hardly * edge.length_px) {
    ++f.kept_whole;
  } else if (is_unseen(edge)) {
    ++f.lost_whole;
  } else {
    ++partly;
    f.gaps += edge.gaps;
    lost += loss;
    in_longest += edge.longest_gap_px;
  }
}

/// Shifts of the edges found in both eyes.
struct Shifts {
  std::vector<double> size, to_brighter;
  double product = 0, difference2 = 0;

  void add(const EdgeSample& edge) {
    const double l = edge.shift_px[0], r = edge.shift_px[1];
    if (std::isnan(l) || std::isnan(r)) return;
    size.push_back(std::abs(l));
    to_brighter.push_back(edge.brighter * l);
    product += l * r;
    difference2 += (l - r) * (l - r);
  }

  void write(EdgeFigures& f) const {
    f.shifted = static_cast<int>(size.size());
    f.common_px = f.shifted > 0
                      ? std::sqrt(std::max(0.0, ratio(product, f.shifted)) / mean_square_of_shift)
                      : nothing;
    f.independent_px = std::sqrt(ratio(difference2, f.shifted) / (2 * mean_square_of_shift));
    f.median_shift_px = f.shifted > 0 ? median_or_zero(size) : nothing;
    f.towards_brighter_px = f.shifted > 0 ? median_or_zero(to_brighter) : nothing;
  }
};

MatchFigures match_figures(const ComparedEdges& compared,
                           const EdgeFilter& of,
                           std::size_t matcher) {
  MatchFigures figures;
  std::vector<double> wrong;
  for (const EdgeSample& edge : compared.edges) {
    if (!of(edge) || !edge.matches[matcher].asked) continue;
    ++figures.lines;
    if (!edge.matches[matcher].matched) continue;
    ++figures.matched;
    if (edge.matches[matcher].is_wrong()) wrong.push_back(std::abs(edge.matches[matcher].error_px));
  }
  figures.wrong = static_cast<int>(wrong.size());
  figures.wrong_px = wrong.empty() ? nothing : median_or_zero(wrong);
  return figures;
}

/// Groups by intervals of a quantity; the last one is open.
ComparisonTable by_interval(const ComparedEdges& compared,
                            const std::string& by,
                            const std::string& unit,
                            const std::vector<double>& limits,
                            const std::function<double(const EdgeSample&)>& quantity) {
  ComparisonTable table{by, {}};
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const bool open = k + 1 == limits.size();
    const double low = limits[k],
                 high = open ? std::numeric_limits<double>::infinity() : limits[k + 1];
    table.groups.push_back({open ? fmt::format("{:g} {} and more", low, unit)
                                 : fmt::format("{:g} to {:g} {}", low, high, unit),
                            edge_figures(compared, [&](const EdgeSample& edge) {
                              const double x = quantity(edge);
                              return x >= low && (open || x < high);
                            })});
  }
  return table;
}

}  // namespace

double robust_deviation(const std::vector<double>& values) {
  const double middle = median_or_zero(values);
  std::vector<double> distances;
  for (const double x : values) distances.push_back(std::abs(x - middle));
  return 1.4826 * median_or_zero(distances);
}

double unseen_again(const ComparedEdges& compared) {
  struct Views {
    double all = 0, unseen = 0;
  };
  std::map<int, Views> of_segment;
  for (const EdgeSample& edge : compared.edges) {
    ++of_segment[edge.segment].all;
    if (is_unseen(edge)) ++of_segment[edge.segment].unseen;
  }
  double again = 0, pairs = 0;
  for (const auto& [segment, views] : of_segment) {
    again += views.unseen * (views.unseen - 1);
    pairs += views.unseen * (views.all - 1);
  }
  return ratio(again, pairs);
}

EdgeFigures edge_figures(const ComparedEdges& compared, const EdgeFilter& of) {
  EdgeFigures f;
  EndErrors corners(EdgeEnd::corner), occlusions(EdgeEnd::occluded);
  Shifts shifts;
  int partly = 0;
  double lost = 0, in_longest = 0;
  for (const EdgeSample& edge : compared.edges) {
    if (!of(edge)) continue;
    ++f.edges;
    add_loss(edge, f, partly, lost, in_longest);
    corners.add(edge);
    occlusions.add(edge);
    shifts.add(edge);
  }
  f.left_loss = ratio(f.left_loss, f.length_px);
  f.pair_loss = ratio(f.pair_loss, f.length_px);
  f.kept_whole = ratio(f.kept_whole, f.edges);
  f.lost_whole = ratio(f.lost_whole, f.edges);
  f.gaps = ratio(f.gaps, partly);
  f.longest_gap = ratio(in_longest, lost);
  f.corners = corners.figures();
  f.occlusions = occlusions.figures();
  shifts.write(f);
  for (std::size_t m = 0; m < compared.matchers.size(); ++m) {
    f.matchers.push_back(match_figures(compared, of, m));
  }
  return f;
}

bool is_clear(const EdgeSample& edge) {
  constexpr double least_contrast = 20, least_length_px = 40, least_distance_px = 6;
  const bool step =
      edge.appearance == EdgeAppearance::border || edge.appearance == EdgeAppearance::outline;
  return step && edge.contrast >= least_contrast && edge.length_px >= least_length_px &&
         edge.neighbour_px >= least_distance_px;
}

std::vector<ComparisonTable> comparison_tables(const ComparedEdges& compared) {
  constexpr double degree = std::numbers::pi / 180;
  ComparisonTable shown{"shown as", {}};
  for (int k = 0; k < appearance_count; ++k) {
    const auto kind = static_cast<EdgeAppearance>(k);
    shown.groups.push_back(
        {std::string(name(kind)),
         edge_figures(compared, [&](const EdgeSample& edge) { return edge.appearance == kind; })});
  }
  const ComparisonTable clear{
      "clear steps",
      {{"clear", edge_figures(compared, is_clear)},
       {"others", edge_figures(compared, [](const EdgeSample& e) { return !is_clear(e); })}}};
  return {shown,
          clear,
          by_interval(compared, "contrast", "grey levels", {0, 5, 10, 20, 40},
                      [](const EdgeSample& e) { return e.contrast; }),
          by_interval(compared, "angle to the rows", "deg", {0, 5, 30, 60},
                      [](const EdgeSample& e) { return e.angle_rad / degree; }),
          by_interval(compared, "depth", "m", {0, 2, 4, 8},
                      [](const EdgeSample& e) { return e.depth_m; }),
          by_interval(compared, "distance of the nearest edge along it", "px", {0, 1, 3, 6},
                      [](const EdgeSample& e) { return e.neighbour_px; }),
          by_interval(compared, "length", "px", {10, 20, 40, 80},
                      [](const EdgeSample& e) { return e.length_px; })};
}

}  // namespace vernier::sim::internal
