// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/outside_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "cli/stereo/stereo_input.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/range_probe.h"
#include "stereo/rectified_images.h"

namespace vernier::cli {

bool doubt_range(const StereoInput& input, Session& session) {
  constexpr double some = 0.01, many = 0.05, enough_matched = 0.2;
  constexpr int least = 10;  // edges that are no chance
  const DisparityRange& range = input.range;
  const auto source_of = [](const std::optional<ValidPixels>& mask) {
    return mask ? HasSource(std::cref(*mask)) : HasSource();
  };
  const OutsideRange outside =
      outside_range(input.pair, range, source_of(input.left_valid), source_of(input.right_valid));
  // Images of different scenes match by chance, anywhere.
  if (outside.matched < enough_matched * outside.edges) return false;
  std::vector<std::string> what, remedies;
  double share = 0;
  const auto add = [&](int count, const char* side, const char* option, int limit_px,
                       int wider_px) {
    const double part = static_cast<double>(count) / std::max(1, outside.matched);
    if (count < least || part < some) return;
    share += part;
    what.push_back(fmt::format("{:.0f} % of the edges match {} {} px", 100 * part, side, limit_px));
    if (wider_px != limit_px) remedies.push_back(fmt::format("{} {}", option, wider_px));
  };
  add(outside.below, "below", "--min-disparity", range.min_px, outside.wider.min_px);
  add(outside.above, "above", "--max-disparity", range.max_px, outside.wider.max_px);
  if (what.empty()) return false;
  const std::string text = fmt::format(
      "{}, outside the range: what they match inside it is wrong{}{}, unless a texture repeats and "
      "is matched a period too far",
      fmt::join(what, " and "), remedies.empty() ? "" : "; give ", fmt::join(remedies, " and "));
  share >= many ? session.add_trust_warning(text) : session.warn(text);
  return share >= many;
}

}  // namespace vernier::cli
