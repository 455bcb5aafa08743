// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/shuffled_frames.h"

#include <cstddef>
#include <utility>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier::internal {

std::vector<int> shuffled_frames(std::vector<int> frames,
                                 std::uint64_t seed,
                                 int split,
                                 DrawSource source) {
  RandomStream draws({.seed = seed,
                      .trial = static_cast<std::uint32_t>(split),
                      .source = static_cast<std::uint32_t>(source)});
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    std::swap(frames[i], frames[i + draws.below(static_cast<std::uint32_t>(frames.size() - i))]);
  }
  return frames;
}

}  // namespace vernier::internal
