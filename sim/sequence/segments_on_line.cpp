// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/segments_on_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "sim/sequence/line_in_view.h"
#include "sim/sequence/sequence_samples.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;

namespace {

/// A segment beside the line: first and last sample.
struct Along {
  int segment = 0, first = 0, last = 0;
  int length() const { return last - first + 1; }
};

int shown_between(const LineInView& line, int first, int last) {
  return static_cast<int>(std::count(line.shown.begin() + first, line.shown.begin() + last + 1, 1));
}

}  // namespace

LineCover segments_on(const LineInView& line,
                      std::span<const SequenceSegment> segments,
                      double off_px,
                      const SequenceOptions& options) {
  constexpr double least_px = 8;
  const double least = std::min(least_px, 0.5 * line.shown_count());
  const double sine = std::sin(options.turn_rad);
  std::vector<Along> along;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    Vector2d a = segments[i].image_px.a_px - line.from_px;
    Vector2d b = segments[i].image_px.b_px - line.from_px;
    double u0 = line.along.dot(a), u1 = line.along.dot(b);
    double v0 = line.across.dot(a) - off_px, v1 = line.across.dot(b) - off_px;
    const double length = (b - a).norm();
    if (length < options.min_length_px || std::abs(v1 - v0) > sine * length) continue;
    if (u0 > u1) {
      std::swap(u0, u1);
      std::swap(v0, v1);
    }
    const double last = line.length_px() - 1;
    const double from = std::max(u0, 0.0), to = std::min(u1, last);
    if (!(to > from)) continue;
    const auto across_at = [&](double u) { return v0 + (v1 - v0) * (u - u0) / (u1 - u0); };
    if (std::max(std::abs(across_at(from)), std::abs(across_at(to))) > options.across_px) continue;
    const Along part{static_cast<int>(i), static_cast<int>(std::ceil(from - 0.5)),
                     static_cast<int>(std::floor(to + 0.5))};
    if (shown_between(line, part.first, part.last) >= least) along.push_back(part);
  }
  std::stable_sort(along.begin(), along.end(),
                   [](const Along& a, const Along& b) { return a.length() > b.length(); });
  LineCover cover;
  std::vector<char> found(line.shown.size(), 0);
  for (const Along& part : along) {
    const int taken =
        static_cast<int>(std::count(found.begin() + part.first, found.begin() + part.last + 1, 1));
    if (2 * taken <= part.length()) cover.segments.push_back(part.segment);
    std::fill(found.begin() + part.first, found.begin() + part.last + 1, 1);
  }
  for (std::size_t i = 0; i < found.size(); ++i) cover.found_px += found[i] && line.shown[i];
  return cover;
}

}  // namespace vernier::sim::internal
