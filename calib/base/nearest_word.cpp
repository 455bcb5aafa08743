// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/nearest_word.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/base/small_letters.h"

namespace vernier::internal {
namespace {

/// Insertions, deletions, replacements and exchanges of neighbours between two words (optimal
/// string alignment).
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before, last, row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before = std::move(last);
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
  }
  return row[to.size()];
}

constexpr std::size_t compared_bytes = 100;  ///< of a word that are compared

struct Nearest {
  std::string word;
  std::size_t distance = std::string::npos;
};

Nearest nearest(std::string_view word, const std::vector<std::string_view>& known) {
  word = word.substr(0, compared_bytes);
  Nearest best;
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best.distance) best = {std::string(candidate), distance};
  }
  return best;
}

/// Whether no more than half of a word's letters differ.
bool is_near(const Nearest& found, std::string_view word) {
  const std::size_t size = std::min(word.size(), compared_bytes);
  return 2 * found.distance <= std::max(size, std::size_t{2});
}

std::string_view without_unit(std::string_view key) {
  constexpr std::array<std::string_view, 11> units{"_px", "_px2", "_m",   "_m2",  "_cm",     "_mm",
                                                   "_s",  "_ms",  "_rad", "_deg", "_degrees"};
  for (const std::string_view unit : units) {
    if (key.ends_with(unit)) return key.substr(0, key.size() - unit.size());
  }
  return key;
}

}  // namespace

std::string unknown_word_remedy(std::string_view word, const std::vector<std::string_view>& known) {
  constexpr std::size_t few = 20;
  const Nearest best = nearest(word, known);
  if (is_near(best, word) || known.size() > few) {
    return "did you mean '" + shortened(best.word) + "'?";
  }
  std::vector<std::string> quoted;
  for (const std::string_view one : known) quoted.push_back("'" + shortened(one) + "'");
  return "use " + alternatives(quoted);
}

std::optional<std::string> near_word(std::string_view word,
                                     const std::vector<std::string_view>& known) {
  const Nearest best = nearest(word, known);
  if (known.empty() || !is_near(best, word)) return {};
  return best.word;
}

std::optional<std::string> misspelt_word(std::string_view word,
                                         const std::vector<std::string_view>& known) {
  const Nearest best = nearest(word, known);
  if (best.distance != 1 || best.word.front() != word.front()) return {};
  return best.word;
}

std::optional<std::string> misspelt_key(std::string_view key,
                                        const std::vector<std::string_view>& known) {
  if (std::find(known.begin(), known.end(), key) != known.end()) return {};
  const std::string small = small_letters(std::string(key.substr(0, compared_bytes)));
  for (const std::string_view one : known) {
    if (small == one || without_unit(small) == without_unit(one)) return std::string(one);
  }
  return misspelt_word(small, known);
}

}  // namespace vernier::internal
