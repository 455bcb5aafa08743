// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::cli {

/// Checks of options for CLI11: what is wrong with the text, or nothing.

/// CLI::NonNegativeNumber lets "nan" pass.
std::string finite_and_not_negative(const std::string& text);

/// Without it -1 would wrap round to the largest seed.
std::string not_negative(const std::string& text);

}  // namespace vernier::cli
