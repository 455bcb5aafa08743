// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace vernier::sim::internal {

/// Identity of a visible run of a segment, `run` counting from 0: with S segments in the world
///
///     32 (S (run div 32) + segment) + run mod 32
///
/// so that no two runs share their draws. Throws Error if it exceeds 31 bits.
std::uint32_t stretch_feature(int segment, int run, std::size_t segments);

}  // namespace vernier::sim::internal
