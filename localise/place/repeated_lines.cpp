// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place/repeated_lines.h"

#include <algorithm>
#include <array>
#include <vector>

#include "localise/place.h"

namespace vernier::localise::internal {

namespace {

using Ends = std::array<double, 6>;

Ends ends(const PlaceLine& l) {
  return {l.a_m.x(), l.a_m.y(), l.a_m.z(), l.b_m.x(), l.b_m.y(), l.b_m.z()};
}

}  // namespace

bool has_repeats(const PlaceView& view) {
  std::vector<Ends> sorted;
  sorted.reserve(view.lines.size());
  for (const PlaceLine& line : view.lines) sorted.push_back(ends(line));
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

void drop_repeats(PlaceView& view) {
  const auto before = [](const PlaceLine& a, const PlaceLine& b) { return ends(a) < ends(b); };
  const auto same = [](const PlaceLine& a, const PlaceLine& b) { return ends(a) == ends(b); };
  std::sort(view.lines.begin(), view.lines.end(), before);
  view.lines.erase(std::unique(view.lines.begin(), view.lines.end(), same), view.lines.end());
}

}  // namespace vernier::localise::internal
