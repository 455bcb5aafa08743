// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/instruction_sets.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>

namespace vernier::sim::internal {

namespace {

constexpr const char* separator = ", ";

std::set<std::string> names_of(const std::string& sets) {
  std::set<std::string> names;
  for (std::size_t at = 0; at <= sets.size();) {
    const std::size_t end = std::min(sets.find(separator, at), sets.size());
    if (end > at) names.insert(sets.substr(at, end - at));
    at = end + 2;
  }
  return names;
}

}  // namespace

std::string all_instruction_sets(const std::string& a, const std::string& b) {
  std::set<std::string> names = names_of(a);
  names.merge(names_of(b));
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : separator) + name;
  return text;
}

bool has_instruction_sets(const std::string& whole, const std::string& part) {
  const std::set<std::string> all = names_of(whole), some = names_of(part);
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

bool are_compatible_sets(const std::string& a, const std::string& b) {
  return has_instruction_sets(a, b) || has_instruction_sets(b, a);
}

bool is_mixture(const std::string& sets) { return names_of(sets).size() > 1; }

}  // namespace vernier::sim::internal
