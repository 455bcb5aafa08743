// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vernier::internal {

/// The finite numbers between the blanks of a line. A lost line end leaves the last number of one
/// line and the first of the next as one word, such as 0.0e+007.07e+02; numbers in the form of C's
/// %e are taken apart there, behind the two digits of their exponents (three only where two leave
/// no number, beyond 1e±99). Throws Error(`place`) for a word that is neither.
std::vector<double> joined_numbers(std::string_view line, const std::string& place);

}  // namespace vernier::internal
