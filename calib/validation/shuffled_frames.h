// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "calib/statistics/draw_sources.h"

namespace vernier::internal {

/// The frames in a random order that depends on (seed, split, source) only. All orders are equally
/// probable (Fisher and Yates 1938).
std::vector<int> shuffled_frames(std::vector<int> frames,
                                 std::uint64_t seed,
                                 int split,
                                 DrawSource source);

}  // namespace vernier::internal
