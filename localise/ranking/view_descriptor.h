// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Bins of a view descriptor: bearing x (upright or not, height, logarithm of the range). Turning
/// the robot moves a descriptor along its bearings.
struct DescriptorBins {
  int bearings = 28;
  static constexpr double bearing_rad = 0.05;  ///< width of a bin
  static constexpr int ranges = 12;            ///< in equal ratios from nearest_m to furthest_m
  static constexpr double nearest_m = 0.4, furthest_m = 10;
  static constexpr int heights = 5;
  static constexpr double highest_m = 2.5;
  static constexpr int channels = 128;  ///< 2 x heights x ranges, and a rest that is empty

  int size() const { return bearings * channels; }
};

/// Bins that the views of a map fill: their horizontal field of view.
DescriptorBins descriptor_bins(const TopologicalMap& map);

/// What is where around the robot: the length of lines in the image, shared out among the bins (in
/// proportion to their nearness), smoothed over bearings, square-rooted and of unit length, so that
/// a dot product is a Bhattacharyya coefficient. All 0 without lines. bearings x channels.
std::vector<float> view_descriptor(std::span<const PlaceLine> lines, const DescriptorBins& bins);

/// A descriptor with the upper half of each number's bits.
std::vector<std::uint16_t> shortened_descriptor(std::span<const float> descriptor);

/// Largest turn between descriptors that is tried, in bins to either side.
inline constexpr int most_turn_bins = 7;

struct TurnedProduct {
  float product = 0;
  int turn_bins = 0;  ///< heading of the query minus that of the node
};

/// The largest dot product of a query's descriptor with each stored one over turns. SIMD selected
/// at run time (calib/base/instruction_set.h).
void turned_products(std::span<const float> query,
                     std::span<const std::uint16_t> stored,
                     const DescriptorBins& bins,
                     std::span<TurnedProduct> products);

}  // namespace vernier::localise::internal
