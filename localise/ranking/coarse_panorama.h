// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "localise/ranking/panorama.h"

namespace vernier::localise::internal {

/// Bins of panoramas, two and two added up in bearing, height and range. Since
/// sqrt(ab) + sqrt(cd) <= sqrt((a + c)(b + d)), coarse bins of a window are never less alike than
/// its fine ones. A choice by them is a heuristic all the same: they compare every second window,
/// and stand for places beside their own (docs/localisation.md has how often that misleads).
struct CoarseBins {
  static constexpr int bearings = PanoramaBins::bearings / 2;
  static constexpr int heights = PanoramaBins::heights / 2;
  static constexpr int ranges = PanoramaBins::ranges / 2;
  static constexpr int channels = 2 * heights * ranges;
};

/// A view's descriptor in coarse bins, in steps of 1 / CoarseView::steps; as long as a multiple of
/// 32, filled up with 0.
struct CoarseView {
  static constexpr int steps = 16383;
  explicit CoarseView(std::span<const float> view_descriptor);
  std::vector<std::int16_t> bins;  ///< bearings x channels
};

/// A field of view of a place of the map that may look like a view.
struct CoarseMatch {
  int place = 0;
  int bearing = 0;     ///< at which the window begins, in fine bins of the world
  float likeness = 0;  ///< Bhattacharyya coefficient of coarse bins
};

/// Panoramas of many places in coarse bins, one after the other in memory: about 30 bytes a window.
class CoarsePanoramas {
 public:
  /// Adds the next place.
  void add(const Panorama& panorama);

  int places() const { return places_; }

  /// Compares the view with all of them: the windows that are more alike than their neighbours of
  /// the same place, the `most` best first; ties keep the order of places.
  std::vector<CoarseMatch> best(const CoarseView& view, std::size_t most) const;

 private:
  /// Windows of a place that lie next to each other.
  struct Run {
    std::size_t bins = 0, per_norms = 0;  // where they begin
    int place = 0;
    std::int16_t bearing = 0, windows = 0;
  };
  void add_run(const Panorama& panorama, std::size_t first, std::size_t end, int in_view);

  int places_ = 0;
  std::vector<Run> runs_;
  std::vector<std::uint8_t> bins_;
  std::vector<float> per_norms_;
};

/// Dot products of a view with `products.size()` windows of a run, whole numbers and so the same on
/// every machine. SIMD selected at run time; reads up to 32 bytes beyond the last window.
void coarse_products(std::span<const std::int16_t> view,
                     const std::uint8_t* run,
                     std::span<std::int32_t> products);

}  // namespace vernier::localise::internal
