// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vernier::sim::internal {

/// Features of false edges (VisibleEdge::feature): the uppermost of the 31 bits, which those of the
/// world's edges reach only in worlds of a million edges of which one is seen in two thousand
/// parts.
inline constexpr std::uint32_t first_false_feature = 0x7ff00000u;
inline constexpr std::uint32_t most_false_features = 0x00080000u;  ///< of each source of them

}  // namespace vernier::sim::internal
