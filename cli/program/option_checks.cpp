// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/option_checks.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "calib/base/file_in_progress.h"
#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"

namespace vernier::cli {

namespace {

template <class Whole>
std::string whole_number(const std::string& text, const std::string& kind) {
  const std::string_view digits = std::string_view(text).substr(text.starts_with('-') ? 1 : 0);
  const bool plain =
      !digits.empty() && digits.find_first_not_of("0123456789") == std::string_view::npos;
  if (!plain || (std::is_unsigned_v<Whole> && text[0] == '-')) {
    return in_quotes(text) + " is not " + kind;
  }
  if (digits.size() > 1 && digits[0] == '0') {
    return in_quotes(text) + " is not a decimal number: leave out the zeros it begins with";
  }
  Whole value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec == std::errc()) return "";
  return in_quotes(text) + " is out of range; the largest is " +
         std::to_string(std::numeric_limits<Whole>::max());
}

}  // namespace

std::string finite_and_not_negative(const std::string& text) {
  const auto value = to_finite(text);
  return value && *value >= 0 ? "" : in_quotes(text) + " is not a finite number of 0 or more";
}

std::string finite_and_positive(const std::string& text) {
  const auto value = to_finite(text);
  return value && *value > 0 ? "" : in_quotes(text) + " is not a finite number above 0";
}

std::string finite(const std::string& text) {
  return to_finite(text) ? "" : in_quotes(text) + " is not a finite number";
}

namespace {

std::string name_ending_in(const char* ending, const std::string& text) {
  if (std::filesystem::path(text).extension() == ending) return "";
  return in_quotes(text) + " does not end in " + ending;
}

}  // namespace

std::string png_name(const std::string& text) { return name_ending_in(".png", text); }
std::string svg_name(const std::string& text) { return name_ending_in(".svg", text); }

std::string not_empty(const std::string& text) { return text.empty() ? "is empty" : ""; }

void check_files_written(CLI::App& verb, std::initializer_list<const char*> options) {
  for (const char* option : options) {
    verb.get_option(option)->check([](const std::string& name) {
      if (!name.empty()) vernier::internal::check_writable_file(name);
      return std::string();
    });
  }
}

void check_folder_written(CLI::App& verb, const char* option) {
  verb.get_option(option)->check([](const std::string& name) {
    if (!name.empty()) vernier::internal::check_writable_folder(name);
    return std::string();
  });
}

void check_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    // A transform comes before the option's own checks, which could not read the number.
    if (type.starts_with("UINT")) {
      const auto whole = [](std::string& text) {
        return whole_number<std::uint64_t>(text, "a whole number of 0 or more");
      };
      option->transform(CLI::Validator(whole, ""));
    } else if (type.starts_with("INT")) {
      const auto whole = [](std::string& text) {
        return whole_number<std::int64_t>(text, "a whole number");
      };
      option->transform(CLI::Validator(whole, ""));
    } else if (type.starts_with("FLOAT")) {
      option->check(finite);
    }
  }
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) check_numbers(*verb);
}

void refuse_empty_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_expected_max() == 0) continue;  // a flag
    for (const std::string& value : option->results()) {
      if (value.empty())
        throw Error(option->get_name(), "is empty", "give a value, or leave it out");
    }
  }
  for (const CLI::App* verb : app.get_subcommands()) refuse_empty_values(*verb);
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
