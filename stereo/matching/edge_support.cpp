// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/edge_support.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "stereo/edges/edge_points_by_row.h"
#include "stereo/matching/census.h"
#include "stereo/matching/recent_values.h"
#include "stereo/matching/side_levels.h"

// As in calib/solver/view_kernel.cpp, but for targets with a vector popcount.
#define HWY_WANT_AVX3_DL
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/matching/edge_support.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::stereo::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Adds what the levels on both sides differ by, at n positions from `first` on; the loops are
/// written for auto-vectorisation.
HWY_INLINE void add_sides(const CensusCosts& at,
                          int point,
                          const LevelImage& other,
                          int first,
                          int n,
                          std::int16_t* costs) {
  const auto k = static_cast<std::size_t>(point);
  const LevelImage& own = at.sides->own;
  const auto [dx, dy] = at.sides->offsets[k];
  const auto tolerance = static_cast<std::int16_t>(at.sides->tolerance);
  for (const int side : {1, -1}) {
    const int y = std::clamp(at.points.y[k] + side * dy, 0, own.height - 1);
    const std::int16_t level = own.row(y)[at.points.x[k] + side * dx];
    const int across = at.facing == Facing::same ? side * dx : -side * dx;
    const std::uint8_t* const there = other.row(y) + first + across;
    for (int d = 0; d < n; ++d) {
      const auto apart = static_cast<std::int16_t>(std::abs(there[d] - level) - tolerance);
      costs[d] = static_cast<std::int16_t>(
          costs[d] + side_weight * std::clamp<std::int16_t>(apart, 0, most_side_levels));
    }
  }
}

/// Costs of a point against n words of `other` from `first` on.
HWY_INLINE void distances(const CensusCosts& at,
                          int point,
                          const CensusImage& other,
                          const LevelImage* levels,
                          int first,
                          int n,
                          std::int16_t* costs) {
  const hn::ScalableTag<std::uint64_t> words;
  const hn::Rebind<std::uint16_t, decltype(words)> counts;
  const auto k = static_cast<std::size_t>(point);
  const int x = at.points.x[k];
  const int before = std::max(x - 1, 0), after = std::min(x + 1, at.own.width - 1);
  decltype(hn::Zero(words)) q[9];
  const std::uint64_t* there[3];
  for (int j = 0; j < 3; ++j) {
    const int y = std::clamp(at.points.y[k] + j - 1, 0, at.own.height - 1);
    const std::uint64_t* const row = at.own.row(y);
    q[3 * j] = hn::Set(words, row[at.facing == Facing::same ? before : after]);
    q[3 * j + 1] = hn::Set(words, row[x]);
    q[3 * j + 2] = hn::Set(words, row[at.facing == Facing::same ? after : before]);
    there[j] = other.row(y) + first;
  }
  auto* const out = reinterpret_cast<std::uint16_t*>(costs);
  for (int d = 0; d < n; d += static_cast<int>(hn::Lanes(words))) {
    auto sum = hn::Zero(words);
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        const auto word = hn::LoadU(words, there[j] + d + i - 1);
        sum = hn::Add(sum, hn::PopulationCount(hn::Xor(q[3 * j + i], word)));
      }
    }
    hn::StoreU(hn::TruncateTo(counts, sum), counts, out + d);
  }
  if (at.sides) add_sides(at, point, *levels, first, n, costs);
  std::fill_n(costs, std::clamp(-first, 0, n), no_place_cost);
  const int end = std::clamp(other.width - first, 0, n);
  std::fill(costs + end, costs + n, no_place_cost);
}

/// Against the other image as it is.
HWY_INLINE void plain_costs(const CensusCosts& at, int point, std::int16_t* costs) {
  distances(at, point, at.other, at.sides ? &at.sides->other : nullptr,
            at.first_place[static_cast<std::size_t>(point)], at.disparities, costs);
}

/// The same for a stretched view, at the positions of the unstretched image.
void stretched_costs(const CensusCosts& at,
                     int point,
                     const StretchedView& view,
                     std::vector<std::int16_t>& costs,
                     std::int16_t* at_places) {
  const int first = at.first_place[static_cast<std::size_t>(point)];
  const int begin = static_cast<int>(std::floor(view.scale * first));
  const int end = static_cast<int>(std::ceil(view.scale * (first + at.disparities))) + 1;
  const int n = (end - begin + 31) / 32 * 32;
  costs.resize(static_cast<std::size_t>(n));
  distances(at, point, view.image, &view.levels, begin, n, costs.data());
  for (int k = 0; k < at.disparities; ++k) {
    const auto place = static_cast<int>(std::lround(view.scale * (first + k))) - begin;
    at_places[k] = costs[static_cast<std::size_t>(place)];
  }
}

HWY_INLINE void costs_of(const CensusCosts& at, int point, std::int16_t* costs) {
  plain_costs(at, point, costs);
  if (!at.stretched) return;
  std::vector<std::int16_t> own, places(static_cast<std::size_t>(at.disparities));
  for (const StretchedView& view : *at.stretched) {
    stretched_costs(at, point, view, own, places.data());
    for (int k = 0; k < at.disparities; ++k) {
      const int cost = places[static_cast<std::size_t>(k)] + at.stretched_penalty;
      costs[k] = static_cast<std::int16_t>(std::min<int>(costs[k], cost));
    }
  }
}

void census_costs(const CensusCosts& at, int point, std::int16_t* costs) {
  costs_of(at, point, costs);
}

double best_scale(const CensusCosts& at, int point, int index) {
  const auto k = static_cast<std::size_t>(index);
  std::vector<std::int16_t> own, places(static_cast<std::size_t>(at.disparities));
  plain_costs(at, point, places.data());
  int least = places[k];
  double scale = 1;
  for (const StretchedView& view : *at.stretched) {
    stretched_costs(at, point, view, own, places.data());
    if (places[k] + at.stretched_penalty >= least) continue;
    least = places[k] + at.stretched_penalty;
    scale = view.scale;
  }
  return scale;
}

/// Weight of a neighbour at a distance; below 0 out of reach.
HWY_INLINE float share_at(float distance_px, const SupportOptions& options) {
  const auto reach = static_cast<float>(options.reach_px);
  if (distance_px > 2 * reach) return -1;
  return std::clamp(1 - (distance_px - 1) / reach, static_cast<float>(options.min_share), 1.0f);
}

/// A direction's step to a point: the neighbour's values and the penalties.
struct Step {
  const std::int16_t* from;
  std::int16_t least, small, large;
  std::int16_t* to;
  int reach;  ///< maximum disparity change of a small step
};

HWY_INLINE Step step_from(const PointsByRow& points,
                          int p,
                          int r,
                          bool backward,
                          const SupportOptions& options,
                          const std::int16_t* nothing,
                          RecentValues& recent) {
  const auto k = static_cast<std::size_t>(p);
  const int n = points.neighbours[k][static_cast<std::size_t>(r + (backward ? directions : 0))];
  std::int16_t* const to = recent.values(p, r);
  if (n < 0) return {nothing, 0, 0, 0, to, 1};
  const auto m = static_cast<std::size_t>(n);
  const auto dx = static_cast<float>(points.x[m] - points.x[k]);
  const auto dy = static_cast<float>(points.y[m] - points.y[k]);
  const float share = share_at(std::sqrt(dx * dx + dy * dy), options);
  if (share < 0) return {nothing, 0, 0, 0, to, 1};
  const auto reach = static_cast<int>(options.slope * std::abs(dx) + 0.5);
  return {recent.values(n, r),
          recent.least(n, r),
          static_cast<std::int16_t>(share * static_cast<float>(options.small_step)),
          static_cast<std::int16_t>(share * static_cast<float>(options.large_step)),
          to,
          std::max(1, reach)};
}

/// For steps of more than one disparity: the minimum of the values within reach. The value itself
/// keeps no penalty.
void widen(Step& step, int n, std::vector<std::int16_t>& wide) {
  if (step.reach <= 1) return;
  const auto size = static_cast<std::size_t>(n) + 128;
  wide.assign(step.from - 64, step.from - 64 + static_cast<std::ptrdiff_t>(size));
  const int more = std::min(step.reach - 1, 30);
  for (int d = 0; d < n; ++d) {
    int least = step.from[d];
    for (int e = std::max(0, d - more - 1); e <= std::min(n - 1, d + more + 1); ++e) {
      least = std::min(least, step.from[e] + step.small);
    }
    wide[static_cast<std::size_t>(d + 64)] = static_cast<std::int16_t>(least);
  }
  step.from = wide.data() + 64;
}

/// The four directions of a pass at a point, added to `sum`, which the first pass initialises.
template <bool first>
HWY_INLINE void take_steps(
    const Step* steps, const std::int16_t* cost, int n, std::int16_t* sum, std::int16_t* least) {
  const hn::ScalableTag<std::int16_t> lanes;
  decltype(hn::Zero(lanes)) small[directions], most[directions], base[directions],
      lowest[directions];
  for (int r = 0; r < directions; ++r) {
    small[r] = hn::Set(lanes, steps[r].small);
    most[r] = hn::Set(lanes, static_cast<std::int16_t>(steps[r].least + steps[r].large));
    base[r] = hn::Set(lanes, steps[r].least);
    lowest[r] = hn::Set(lanes, std::int16_t{32000});
  }
  for (int d = 0; d < n; d += static_cast<int>(hn::Lanes(lanes))) {
    const auto c = hn::LoadU(lanes, cost + d);
    auto total = first ? hn::Zero(lanes) : hn::LoadU(lanes, sum + d);
    for (int r = 0; r < directions; ++r) {
      const std::int16_t* const from = steps[r].from + d;
      const auto beside =
          hn::Add(hn::Min(hn::LoadU(lanes, from - 1), hn::LoadU(lanes, from + 1)), small[r]);
      const auto best = hn::Min(hn::Min(hn::LoadU(lanes, from), beside), most[r]);
      const auto value = hn::Add(c, hn::Sub(best, base[r]));
      hn::StoreU(value, lanes, steps[r].to + d);
      lowest[r] = hn::Min(lowest[r], value);
      total = hn::Add(total, value);
    }
    hn::StoreU(total, lanes, sum + d);
  }
  for (int r = 0; r < directions; ++r) {
    least[r] = hn::GetLane(hn::MinOfLanes(lanes, lowest[r]));
  }
}

/// The first index of the minimum, n a multiple of the lanes.
HWY_INLINE int place_of_least(const std::int16_t* values, int n) {
  const hn::ScalableTag<std::int16_t> lanes;
  const auto step = static_cast<int>(hn::Lanes(lanes));
  auto lowest = hn::LoadU(lanes, values);
  for (int d = step; d < n; d += step) lowest = hn::Min(lowest, hn::LoadU(lanes, values + d));
  const auto least = hn::MinOfLanes(lanes, lowest);
  for (int d = 0;; d += step) {
    const auto found = hn::FindFirstTrue(lanes, hn::Eq(hn::LoadU(lanes, values + d), least));
    if (found >= 0) return d + static_cast<int>(found);
  }
}

/// Overwrites `sums` near the winner.
HWY_INLINE Winner winner_of(std::int16_t* sums, int n) {
  Winner best;
  best.index = place_of_least(sums, n);
  const int least = sums[best.index];
  if (best.index > 0 && best.index + 1 < n) {
    const int before = sums[best.index - 1], after = sums[best.index + 1];
    const int bend = before - 2 * least + after;
    if (bend > 0) {
      best.offset = 0.5f * static_cast<float>(before - after) / static_cast<float>(bend);
    }
  }
  constexpr std::int16_t out_of_question = 32000;
  for (int d = std::max(0, best.index - 1); d <= std::min(n - 1, best.index + 1); ++d) {
    sums[d] = out_of_question;
  }
  const int next = sums[place_of_least(sums, n)];
  constexpr float floor = 200;  // over eight directions: keeps noise from giving a margin
  best.margin = static_cast<float>(next - least) / (static_cast<float>(least) + floor);
  return best;
}

/// Forward pass into `sums`, then the backward pass, which completes each point in turn. Costs are
/// recomputed rather than stored, because memory access is slower.
void semi_global_disparities(const CensusCosts& costs,
                             Support support,
                             const SupportOptions& options,
                             std::int16_t* sums,
                             std::vector<Winner>& winners) {
  const PointsByRow& points = costs.points;
  const int n = costs.disparities;
  std::vector<std::int16_t> cost(static_cast<std::size_t>(n)), wide[directions];
  const std::vector<std::int16_t> nothing(static_cast<std::size_t>(n) + 128, 0);  // no neighbour
  for (const bool backward : {false, true}) {
    if (backward && support == Support::from_above) break;
    RecentValues recent(points, n);
    for (int k = 0; k < points.size(); ++k) {
      const int p = backward ? points.size() - 1 - k : k;
      Step steps[directions];
      for (int r = 0; r < directions; ++r) {
        steps[r] = step_from(points, p, r, backward, options, nothing.data() + 64, recent);
        widen(steps[r], n, wide[r]);
      }
      std::int16_t* const sum = sums + (support == Support::all ? static_cast<std::size_t>(p) : 0) *
                                           static_cast<std::size_t>(n);
      costs_of(costs, p, cost.data());
      if (backward) {
        take_steps<false>(steps, cost.data(), n, sum, &recent.least(p, 0));
      } else {
        take_steps<true>(steps, cost.data(), n, sum, &recent.least(p, 0));
      }
      if (backward || support == Support::from_above) {
        winners[static_cast<std::size_t>(p)] = winner_of(sum, n);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::stereo::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::stereo::internal {

HWY_EXPORT(census_costs);
HWY_EXPORT(semi_global_disparities);
HWY_EXPORT(best_scale);

void census_costs(const CensusCosts& at, int point, std::int16_t* costs) {
  HWY_DYNAMIC_DISPATCH(census_costs)(at, point, costs);
}

double best_scale(const CensusCosts& at, int point, int index) {
  return at.stretched ? HWY_DYNAMIC_DISPATCH(best_scale)(at, point, index) : 1;
}

std::vector<Winner> semi_global_disparities(const CensusCosts& costs,
                                            Support support,
                                            const SupportOptions& options) {
  const auto points = static_cast<std::size_t>(costs.points.size());
  std::vector<Winner> winners(points);
  const std::size_t kept = support == Support::all ? points : 1;
  const auto sums = std::make_unique_for_overwrite<std::int16_t[]>(
      kept * static_cast<std::size_t>(costs.disparities));
  HWY_DYNAMIC_DISPATCH(semi_global_disparities)(costs, support, options, sums.get(), winners);
  return winners;
}

}  // namespace vernier::stereo::internal
#endif  // HWY_ONCE
