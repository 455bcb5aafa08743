// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace vernier::internal {

/// The instruction set used by the SIMD kernels, such as "AVX3": the best one that was compiled in
/// and that this processor supports. Results of two machines are bitwise equal only if this is.
std::string_view instruction_set();

}  // namespace vernier::internal
