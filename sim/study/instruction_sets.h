// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::sim::internal {

/// Whether results of processors with different instruction sets may be put together, though they
/// may differ in their last bits.
enum class OtherInstructionSets { refused, allowed };

/// Key of the note that says on which instruction sets (calib/base/instruction_set.h) the results
/// of a store were computed: one name, such as "AVX2", or several where that was allowed, "AVX2,
/// AVX3". Results of two sets may differ in their last bits.
inline constexpr const char* instruction_set_note = "instruction_set";

/// The names of both texts, each once, in the order of the alphabet.
std::string all_instruction_sets(const std::string& a, const std::string& b);

/// Whether every name of `part` is in `whole`.
bool has_instruction_sets(const std::string& whole, const std::string& part);

/// Whether results of two stores may stand side by side: one of them has all sets of the other, as
/// the second has where a mixture was allowed.
bool are_compatible_sets(const std::string& a, const std::string& b);

/// Whether there is more than one name.
bool is_mixture(const std::string& sets);

}  // namespace vernier::sim::internal
