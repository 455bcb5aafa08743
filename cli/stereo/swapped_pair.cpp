// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/swapped_pair.h"

#include <fmt/format.h>

#include <algorithm>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::cli {

double matched_share(const std::vector<EdgeDisparity>& found) {
  const auto matched =
      std::count_if(found.begin(), found.end(), [](const auto& d) { return d.matched(); });
  return static_cast<double>(matched) / std::max<double>(1, static_cast<double>(found.size()));
}

void check_not_swapped(const Matcher& matcher,
                       const std::vector<EdgeDisparity>& found,
                       const DisparityRange& range,
                       const std::function<RectifiedPair()>& exchanged,
                       const std::string& place) {
  constexpr double min_matched = 0.5, min_swapped = 0.3, min_ratio = 2;
  const double given = matched_share(found);
  if (given >= min_matched || !exchanged) return;
  const RectifiedPair other = exchanged();
  const std::vector<EdgePoint> edges = canny_edges(other.left);
  if (edges.empty()) return;
  const double swapped = matched_share(matcher.match(other, edges, range));
  if (swapped < min_swapped || swapped < min_ratio * given) return;
  throw Error(place,
              fmt::format("left and right appear to be swapped, or disparities to be below {} px: "
                          "{:.0f} % of the edges match as given, {:.0f} % after swapping",
                          range.min_px, 100 * given, 100 * swapped),
              "swap --left and --right; or, if the right principal point is further to the right "
              "than the left one, give a smaller --min-disparity");
}

}  // namespace vernier::cli
