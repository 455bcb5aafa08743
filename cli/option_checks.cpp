// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/option_checks.h"

#include <CLI/CLI.hpp>
#include <cmath>

namespace vernier::cli {

std::string finite_and_not_negative(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0) return "";
  return "\"" + text + "\" is not a finite number of 0 or more";
}

std::string not_negative(const std::string& text) {
  return text.find('-') == std::string::npos
             ? ""
             : "\"" + text + "\" is not a whole number of 0 or more";
}

}  // namespace vernier::cli
