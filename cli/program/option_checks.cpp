// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/option_checks.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>

#include "calib/error.h"

namespace vernier::cli {

std::string finite_and_not_negative(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0) return "";
  return "\"" + text + "\" is not a finite number of 0 or more";
}

std::string finite_and_positive(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0) return "";
  return "\"" + text + "\" is not a finite number above 0";
}

std::string finite(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && std::isfinite(value)) return "";
  return "\"" + text + "\" is not a finite number";
}

std::string png_name(const std::string& text) {
  return std::filesystem::path(text).extension() == ".png" ? "" : text + " does not end in .png";
}

std::string not_empty(const std::string& text) { return text.empty() ? "is empty" : ""; }

std::string not_negative(const std::string& text) {
  return text.find('-') == std::string::npos
             ? ""
             : "\"" + text + "\" is not a whole number of 0 or more";
}

void refuse_options(const CLI::App& verb,
                    std::span<const char* const> options,
                    const std::string& why,
                    const std::string& remedy) {
  for (const char* option : options) {
    const CLI::Option* found = verb.get_option_no_throw(option);
    if (found && found->count() > 0) throw Error(option, why, remedy);
  }
}

}  // namespace vernier::cli
