// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/line_reach.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "localise/join/line_fit.h"

namespace vernier::localise::internal {

LineReach reach(std::span<const WorldSighting* const> sightings, const LineFrame& frame) {
  struct End {
    double station_m;
    std::size_t sighting;
    int end;
  };
  std::vector<End> low, high;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const double a = frame.station(sightings[i]->a_m), b = frame.station(sightings[i]->b_m);
    low.push_back({std::min(a, b), i, a <= b ? 0 : 1});
    high.push_back({std::max(a, b), i, a <= b ? 1 : 0});
  }
  const std::size_t n = sightings.size();
  const std::size_t k = n < 3 ? 0 : std::max<std::size_t>(2, n / 10) - 1;
  const auto lower = [](const End& x, const End& y) {
    return std::tie(x.station_m, x.sighting) < std::tie(y.station_m, y.sighting);
  };
  std::sort(low.begin(), low.end(), lower);
  std::sort(high.begin(), high.end(), [&](const End& x, const End& y) { return lower(y, x); });
  End first = low[k], last = high[k];
  if (!(last.station_m > first.station_m)) {  // sightings of which no two overlap
    first = low.front();
    last = high.front();
  }
  return {first.station_m, last.station_m, first.sighting, last.sighting, first.end, last.end};
}

}  // namespace vernier::localise::internal
