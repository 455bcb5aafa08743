// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/straight_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_line.h"
#include "stereo/edges/edge_segments.h"

namespace vernier::stereo::internal {
namespace {

constexpr double min_cosine = 0.7;   // minimum, between a point's normal and the mean of its part
constexpr int min_break_points = 2;  // on either side of a break
constexpr int max_rounding_points = 4;  // at an end, excluded to fit the line of the others
constexpr double max_deviations = 3;    // maximum, of a point at an end from that line

class StraightParts {
 public:
  StraightParts(const std::vector<EdgePoint>& points,
                std::span<const int> chain,
                const EdgeSegmentOptions& options)
      : points_(points), chain_(chain), options_(options), sums_(1) {
    for (int i = 0; i < static_cast<int>(chain.size()); ++i) {
      sums_.push_back(sums_.back());
      sums_.back().add(place(i));
    }
  }

  std::vector<ChainPart> find() const {
    std::vector<ChainPart> parts;
    const int size = static_cast<int>(chain_.size());
    for (int begin = 0; begin + options_.min_points <= size;) {
      const ChainPart part = grow(begin);
      if (part.size() > 0) parts.push_back(part);
      begin += std::max(1, part.size());
    }
    for (int sweep = 0; sweep < 2; ++sweep) {
      for (std::size_t k = 0; k + 1 < parts.size(); ++k) move_break(parts[k], parts[k + 1]);
    }
    for (ChainPart& part : parts) part = without_rounding(part);
    std::erase_if(parts, [&](const ChainPart& part) { return part.size() < options_.min_points; });
    return parts;
  }

 private:
  /// Relative to the first point of the chain, for precision.
  Eigen::Vector2d place(int i) const {
    return (points_[chain_[i]].pixel_px - points_[chain_[0]].pixel_px).cast<double>();
  }

  LineRegression regression(int begin, int end) const { return sums_[end].since(sums_[begin]); }

  /// Empty if not even the minimum number of points is straight.
  ChainPart grow(int begin) const {
    const int size = static_cast<int>(chain_.size()), least = begin + options_.min_points;
    Eigen::Vector2d brighter(0, 0);
    int end = begin;
    for (; end < size; ++end) {
      const Eigen::Vector2d normal = points_[chain_[end]].normal.cast<double>();
      if (normal.dot(brighter) < min_cosine * brighter.norm()) break;
      if (end + 1 >= least && regression(begin, end + 1).rms() > options_.max_rms_px) break;
      brighter += normal;
    }
    return {begin, end >= least ? end : begin};
  }

  /// Between adjacent parts only.
  void move_break(ChainPart& part, ChainPart& next) const {
    if (next.begin - part.end > options_.min_points) return;
    int best = part.end;
    double least = -1;
    for (int at = part.begin + min_break_points; at <= next.end - min_break_points; ++at) {
      const LineRegression before = regression(part.begin, at), after = regression(at, next.end);
      if (std::max(before.rms(), after.rms()) > options_.max_rms_px) continue;
      const double squares = before.squares() + after.squares();
      if (least < 0 || squares < least) {
        least = squares;
        best = at;
      }
    }
    if (least >= 0) part.end = next.begin = best;
  }

  /// Two consecutive points, so that a single noisy one is not taken for rounding. If little would
  /// be left the edge is a curve, and all points are kept.
  ChainPart without_rounding(const ChainPart& all) const {
    ChainPart part = all;
    for (int pass = 0; pass < 3; ++pass) {
      const int aside = std::min(max_rounding_points, part.size() / 4);
      ChainPart kept{part.begin + aside, part.end - aside};
      if (kept.size() < 3) break;
      const LineRegression line = regression(kept.begin, kept.end);
      const Eigen::Vector2d d = line.direction(), across(-d.y(), d.x());
      const auto off = [&](int i) {
        const double deviation = std::max<double>(line.rms(), points_[chain_[i]].sigma_px);
        return std::abs(across.dot(place(i) - line.centroid())) > max_deviations * deviation;
      };
      const auto off_before = [&](int i) { return i < part.begin || off(i); };
      const auto off_after = [&](int i) { return i >= part.end || off(i); };
      while (!(off_before(kept.begin - 1) && off_before(kept.begin - 2))) --kept.begin;
      while (!(off_after(kept.end) && off_after(kept.end + 1))) ++kept.end;
      if (kept.size() == part.size()) break;
      part = kept;
    }
    return 3 * part.size() >= 2 * all.size() && part.size() >= options_.min_points ? part : all;
  }

  const std::vector<EdgePoint>& points_;
  std::span<const int> chain_;
  const EdgeSegmentOptions& options_;
  std::vector<LineRegression> sums_;  ///< of the points before each
};

}  // namespace

std::vector<ChainPart> straight_parts(const std::vector<EdgePoint>& points,
                                      std::span<const int> chain,
                                      const EdgeSegmentOptions& options) {
  return StraightParts(points, chain, options).find();
}

}  // namespace vernier::stereo::internal
