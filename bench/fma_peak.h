// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vernier {

/// Runs `rounds` rounds of two steps of eight independent chains of fused multiply-adds on
/// registers of doubles, with the best available instruction set. Returns the number of
/// floating-point operations, two per lane; `sink` prevents removal by the compiler.
std::int64_t fma_chains(std::int64_t rounds, double& sink);

}  // namespace vernier
