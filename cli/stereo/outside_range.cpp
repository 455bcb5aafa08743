// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/outside_range.h"

#include <fmt/format.h>

#include <string>

#include "cli/program/session.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/range_probe.h"

namespace vernier::cli {

bool tell_outside_range(const RectifiedPair& pair, const DisparityRange& range, Session& session) {
  constexpr double some = 0.01, many = 0.05;
  const OutsideRange outside = outside_range(pair, range);
  const double share = outside.below + outside.above;
  if (share < some) return false;
  const bool is_below = outside.below >= some, is_above = outside.above >= some;
  std::string text = fmt::format(
      "{:.2g} % of the edges match outside the range, {:.2g} % below {} px and {:.2g} % above {} "
      "px: "
      "what they match inside it is wrong; ",
      100 * share, 100 * outside.below, range.min_px, 100 * outside.above, range.max_px);
  if (is_below) text += fmt::format("give --min-disparity {}", outside.wider.min_px);
  if (is_below && is_above) text += " and ";
  if (is_above || !is_below) text += fmt::format("give --max-disparity {}", outside.wider.max_px);
  text += ", unless a texture that repeats is matched a period too far";
  share >= many ? session.add_trust_warning(text) : session.warn(text);
  return true;
}

}  // namespace vernier::cli
