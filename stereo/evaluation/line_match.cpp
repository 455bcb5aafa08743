// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/line_match.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/error.h"
#include "calib/statistics/quantile.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/edge_error.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

std::vector<LineMatch> line_matches(const ImageEdges& left,
                                    const std::vector<EdgeDisparity>& found,
                                    const StereoTruth& truth,
                                    const LineMatchOptions& options) {
  if (found.size() != left.points.size()) {
    throw Error("line matches", "edges and disparities differ in number",
                "give one disparity per edge point");
  }
  const std::vector<TruthAtEdge> at = truth_at(truth, left.points);
  std::vector<LineMatch> lines;
  for (const EdgeSegment& segment : left.segments) {
    const Eigen::Vector2d along = (segment.segment.b_px - segment.segment.a_px).normalized();
    if (std::abs(along.y()) < std::sin(options.min_angle_rad)) continue;
    std::vector<double> errors, disparities;
    int occluded = 0;
    for (const int point : segment.points) {
      const auto i = static_cast<std::size_t>(point);
      if (!at[i].known) continue;
      disparities.push_back(at[i].disparity_px);
      occluded += is_occluded(at[i], DiscontinuityRule::either);
      if (!found[i].matched()) continue;
      errors.push_back(std::abs(error_px(found[i], at[i], DiscontinuityRule::either)));
    }
    const auto all = static_cast<double>(segment.points.size());
    const auto known = static_cast<double>(disparities.size());
    if (known == 0 || known < options.min_share * all) continue;
    LineMatch line;
    line.left_px = 0.5 * (segment.segment.a_px + segment.segment.b_px);
    line.disparity_px = median_or_zero(disparities);
    line.occluded = 2 * occluded > known;
    line.matched =
        !errors.empty() && static_cast<double>(errors.size()) >= options.min_share * known;
    if (line.matched) line.error_px = median_or_zero(errors);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace vernier::stereo::internal
