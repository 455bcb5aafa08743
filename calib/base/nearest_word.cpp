// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/nearest_word.h"

#include <algorithm>
#include <cstddef>

namespace vernier::internal {
namespace {

/// Levenshtein distance: insertions, deletions and replacements between two words.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[to.size()];
}

struct Nearest {
  std::string word;
  std::size_t distance = std::string::npos;
};

Nearest nearest(std::string_view word, const std::vector<std::string_view>& known) {
  constexpr std::size_t most_bytes = 100;
  word = word.substr(0, most_bytes);
  Nearest best;
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best.distance) best = {std::string(candidate), distance};
  }
  return best;
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string_view>& known) {
  return nearest(word, known).word;
}

std::optional<std::string> misspelt_word(std::string_view word,
                                         const std::vector<std::string_view>& known) {
  constexpr std::size_t long_word = 6;
  const Nearest best = nearest(word, known);
  if (best.distance == 0 || best.distance > (word.size() < long_word ? 1U : 2U)) return {};
  return best.word;
}

}  // namespace vernier::internal
