// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sim/sequence/line_in_view.h"
#include "sim/sequence/sequence_samples.h"

namespace vernier::sim::internal {

/// What the segments of a view cover of a line.
struct LineCover {
  std::vector<int> segments;  ///< indices, those that do not overlap each other
  int found_px = 0;           ///< shown samples that one of them covers
};

/// Lines displaced across by this much are tried as well: what covers them does so by chance.
inline constexpr double displaced_px[] = {-12, -8, 8, 12};

/// The segments that run along a line displaced across by `off_px`, where it is shown, for at least
/// 8 px or half of it. Of segments that overlap, the longest counts.
LineCover segments_on(const LineInView& line,
                      std::span<const SequenceSegment> segments,
                      double off_px,
                      const SequenceOptions& options);

}  // namespace vernier::sim::internal
