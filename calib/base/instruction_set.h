// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace vernier::internal {

/// The instruction set that SIMD kernels run on here, such as "AVX3": the best that was compiled in
/// and that this processor has. Results on two machines are the same to the bit only where this is
/// the same.
std::string_view instruction_set();

}  // namespace vernier::internal
