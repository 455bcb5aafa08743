// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "calib/base/plane_vectors.h"
#include "sim/sources.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace stereo;
using vernier::internal::cross;

namespace {

/// Lines nearly parallel within this angle, of which at least half of the shorter one runs beside
/// the longer one, may be detected as one.
constexpr double parallel_rad = 5 * std::numbers::pi / 180;
constexpr double least_overlap = 0.5;

Eigen::Vector2d direction(const ImageSegment& s) { return (s.b_px - s.a_px).normalized(); }

/// How far a point lies from a line, positive on the side of its left normal.
double across_px(const ImageSegment& line, const Eigen::Vector2d& point_px) {
  return cross(direction(line), point_px - line.a_px);
}

/// Where along the shorter line, from 0 to 1, the middle of the part is that runs beside the longer
/// one; none if they are not parallel or hardly overlap.
std::optional<double> beside(const ImageSegment& longer, const ImageSegment& shorter) {
  static const double most_sine = std::sin(parallel_rad);
  const Eigen::Vector2d d = direction(longer), e = direction(shorter);
  if (!(std::abs(cross(d, e)) <= most_sine)) return std::nullopt;
  const double a = d.dot(shorter.a_px - longer.a_px), b = d.dot(shorter.b_px - longer.a_px);
  const double from = std::max(0.0, std::min(a, b)),
               to = std::min(longer.length_px(), std::max(a, b));
  if (!(to - from >= least_overlap * std::abs(b - a))) return std::nullopt;
  return (0.5 * (from + to) - a) / (b - a);
}

/// Close parallel lines are detected as one: the longest keeps its ends along the line, and moves
/// across it to the mean of all, weighted by length.
class LineMerging : public UncertaintySource {
 public:
  explicit LineMerging(const SourceSettings& s) : reach_px_(s.merge_px) {}
  std::string_view name() const override { return "merge_px"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    const std::size_t count = view.edges.size();
    std::array<std::vector<ImageSegment>, 2> seen;
    for (int eye = 0; eye < 2; ++eye) {
      for (const SensedEdge& edge : view.edges) {
        seen[eye].push_back(image_of(context.rig, edge, eye));
      }
    }
    std::vector<std::size_t> order(count);  // the longest first, whatever the list's order
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) {
      return std::tuple(-seen[0][i].length_px(), view.edges[i].truth.feature, view.edges[i].piece);
    };
    std::sort(order.begin(), order.end(), [&](auto i, auto j) { return key(i) < key(j); });

    std::vector<char> merged(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = order[k];
      if (merged[i]) continue;
      double length = seen[0][i].length_px();
      std::array<double, 2> moment{};
      for (std::size_t l = k + 1; l < count; ++l) {
        const std::size_t j = order[l];
        if (merged[j]) continue;
        const auto across = distances({&seen[0][i], &seen[1][i]}, {&seen[0][j], &seen[1][j]});
        if (!across) continue;
        merged[j] = 1;
        const double weight = seen[0][j].length_px();
        length += weight;
        for (int eye = 0; eye < 2; ++eye) moment[eye] += weight * (*across)[eye];
      }
      for (int eye = 0; eye < 2; ++eye) {
        if (moment[eye] == 0) continue;
        const Eigen::Vector2d d = direction(seen[eye][i]);
        const Eigen::Vector2d shift = moment[eye] / length * Eigen::Vector2d(-d.y(), d.x());
        for (Eigen::Vector2d& offset : view.edges[i].offset_px[eye]) offset += shift;
      }
    }
    std::vector<SensedEdge> kept;
    for (std::size_t i = 0; i < count; ++i) {
      if (!merged[i]) kept.push_back(std::move(view.edges[i]));
    }
    view.edges = std::move(kept);
  }

 private:
  using BothEyes = std::array<const ImageSegment*, 2>;

  /// Of the shorter line from the longer one, in each eye; none if they stay two lines.
  std::optional<std::array<double, 2>> distances(const BothEyes& longer,
                                                 const BothEyes& shorter) const {
    const std::optional<double> at = beside(*longer[0], *shorter[0]);
    if (!at) return std::nullopt;
    std::array<double, 2> across{};
    for (int eye = 0; eye < 2; ++eye) {
      const ImageSegment& s = *shorter[eye];
      across[eye] = across_px(*longer[eye], s.a_px + *at * (s.b_px - s.a_px));
    }
    if (!(std::abs(across[0]) < reach_px_)) return std::nullopt;
    return across;
  }

  double reach_px_;
};

}  // namespace

SourcePointer make_line_merging(const SourceSettings& s) {
  return std::make_unique<LineMerging>(s);
}

}  // namespace vernier::sim::internal
