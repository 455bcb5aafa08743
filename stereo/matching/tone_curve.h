// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "stereo/matching/edge_support.h"
#include "stereo/matching/side_levels.h"

namespace vernier::stereo::internal {

/// For each grey level of one image, that of the same surface in another one, which may have
/// another exposure or response.
using ToneCurve = std::array<std::uint8_t, 256>;

/// A grey level of one image and of the other one, where both may be of the same surface.
struct LevelPair {
  int from = 0, to = 0;
};

/// What is known of the levels of a surface in two images.
struct Tones {
  ToneCurve curve;
  /// What the levels of a surface may differ by after it, where light and view change them: one and
  /// a half times the upper quartile of the pairs' differences.
  int tolerance = 0;
};

/// The curve goes through the mean differences of the pairs in eighths of the range of `from`, of
/// those with at least 15; linear between, constant beyond them. Means are of the middle half,
/// which bears wrong pairs. std::nullopt if there are too few: nothing is known of the tones.
std::optional<Tones> tones_of(const std::vector<LevelPair>& pairs);

/// Pairs of levels beside points, from the other image to the points' own, where the census alone
/// tells the place in the other image: of at most 600 points, those with a cost below 0.7 of the
/// best one elsewhere in the image. `searched` disparities of `costs` count.
std::vector<LevelPair> level_pairs(const CensusCosts& costs, const SideLevels& sides, int searched);

LevelImage toned(LevelImage levels, const ToneCurve& curve);

}  // namespace vernier::stereo::internal
