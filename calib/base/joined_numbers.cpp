// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/joined_numbers.h"

#include <cstddef>
#include <optional>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

/// Where the second number of a word begins: behind an exponent of `digits` digits.
std::optional<std::size_t> end_of_exponent(std::string_view word, std::size_t digits) {
  const std::size_t e = word.find_first_of("eE");
  if (e == std::string_view::npos || e + 2 + digits >= word.size()) return {};
  if (word[e + 1] != '+' && word[e + 1] != '-') return {};
  for (std::size_t i = 0; i < digits; ++i) {
    if (!is_digit(word[e + 2 + i])) return {};
  }
  return e + 2 + digits;
}

/// Whether one digit stands before the point, as %e writes it: 2.0e+00, and not 02.0e+00.
bool has_one_leading_digit(std::string_view word) {
  const std::size_t at = word.starts_with('-') || word.starts_with('+') ? 1 : 0;
  return word.size() > at + 1 && is_digit(word[at]) && !is_digit(word[at + 1]);
}

/// The two numbers of a word that a lost line end has made of them.
std::optional<std::pair<double, double>> two_numbers(std::string_view word) {
  for (const std::size_t digits : {2, 3}) {
    const std::optional<std::size_t> end = end_of_exponent(word, digits);
    if (!end || !has_one_leading_digit(word.substr(*end))) continue;
    const auto a = to_finite(word.substr(0, *end)), b = to_finite(word.substr(*end));
    if (a && b) return std::pair{*a, *b};
  }
  return {};
}

}  // namespace

std::vector<double> joined_numbers(std::string_view line, const std::string& place) {
  std::vector<double> numbers;
  for (const std::string_view word : split_fields(line, " \t\r")) {
    if (const auto one = to_finite(word)) {
      numbers.push_back(*one);
    } else if (const auto two = two_numbers(word)) {
      numbers.insert(numbers.end(), {two->first, two->second});
    } else {
      throw Error(place, in_quotes(word) + " is not a finite number", "give numbers");
    }
  }
  return numbers;
}

}  // namespace vernier::internal
