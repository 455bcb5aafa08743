// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// How often the 95 % intervals of studies hold the truth, in studies made with a known success
// rate:
//
//     interval_coverage [STUDIES] [SEED]
//
// prints, for every kind of map, correlation between the trials of a map and success rate, the
// coverage in % and the mean width for 6 to 100 maps of 50 trials; then the same of intervals over
// worlds, and of studies that stop by the width. The constants of the interval were chosen by other
// draws (docs/simulation.md).
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "calib/interval.h"
#include "sim/study/budget.h"
#include "sim/study/success_interval.h"
#include "tests/support/made_maps.h"

namespace {

using namespace vernier;
using namespace vernier::sim::internal;

struct Coverage {
  double share = 0, width = 0;
};

template <class IntervalOf>
Coverage coverage(std::uint32_t studies, double truth, IntervalOf interval_of) {
  Coverage found;
  for (std::uint32_t study = 0; study < studies; ++study) {
    const std::optional<Interval> i = interval_of(study);
    if (!i) continue;
    found.share += i->low <= truth && truth <= i->high;
    found.width += i->high - i->low;
  }
  found.share /= studies;
  found.width /= studies;
  return found;
}

void maps_table(std::uint32_t studies, std::uint64_t seed) {
  const char* names[] = {"beta", "logit normal", "some worse"};
  std::printf("%u studies a figure, seed %llu; coverage in %% (mean width)\n", studies,
              static_cast<unsigned long long>(seed));
  for (const MapKind kind : {MapKind::beta, MapKind::logistic, MapKind::some_worse}) {
    for (const double correlation : {0.0, 0.02, 0.05, 0.1}) {
      if (correlation == 0 && kind != MapKind::beta) continue;
      std::printf("%-13s rho %-5g    6 maps        10           18           50          100\n",
                  names[static_cast<int>(kind)], correlation);
      for (const double success : {0.5, 0.9, 0.95, 0.99}) {
        const MapMaker maker({kind, success, correlation, 50, seed});
        std::printf("  success %-5g        ", success);
        for (const int maps : {6, 10, 18, 50, 100}) {
          const Coverage c = coverage(studies, success, [&](std::uint32_t study) {
            return clustered_interval_95(maker.maps(study, maps));
          });
          std::printf("%6.1f (%.3f)", 100 * c.share, c.width);
        }
        std::printf("\n");
      }
    }
  }
}

/// Worlds whose success rates are beta-distributed, with a standard deviation of 0.11 at 0.5 and
/// 0.02 at 0.99, and 300 trials each.
void worlds_table(std::uint32_t studies, std::uint64_t seed) {
  std::printf("worlds, 300 trials each   6 worlds      10           20           50\n");
  for (const double success : {0.5, 0.9, 0.99}) {
    const MapMaker maker({MapKind::beta, success, 0.05, 300, seed + 1});
    std::printf("  success %-5g        ", success);
    for (const int worlds : {6, 10, 20, 50}) {
      const Coverage c = coverage(studies, success, [&](std::uint32_t study) {
        return interval_over_worlds_95(maker.maps(study, worlds));
      });
      std::printf("%6.1f (%.3f)", 100 * c.share, c.width);
    }
    std::printf("\n");
  }
}

/// Studies that stop by the width of the interval, and how often it ever leaves the truth out.
void stopping_table(std::uint32_t studies, std::uint64_t seed) {
  constexpr int most = 200;
  std::printf(
      "stopped by width, at most %d maps of 50; truth held at the stop, at every look, maps\n",
      most);
  for (const double success : {0.5, 0.9, 0.99}) {
    for (const double width : {0.2, 0.1, 0.05}) {
      const MapMaker maker({MapKind::beta, success, 0.05, 50, seed + 2});
      int held = 0, always = 0;
      double maps_used = 0;
      for (std::uint32_t study = 0; study < studies; ++study) {
        const std::vector<ClusterCount> maps = maker.maps(study, most);
        const std::span<const ClusterCount> all(maps);
        bool ever_out = false;
        for (int looked = 1; looked <= most; ++looked) {
          const Interval i = anytime_interval_95(all.first(static_cast<std::size_t>(looked)));
          ever_out = ever_out || success < i.low || i.high < success;
        }
        always += !ever_out;
        const BudgetDecision stop = budget_decision(all, most, width);
        const Interval i = anytime_interval_95(all.first(static_cast<std::size_t>(stop.wanted)));
        held += i.low <= success && success <= i.high;
        maps_used += stop.wanted;
      }
      std::printf("  success %-5g width %-5g %6.1f %6.1f %7.1f\n", success, width,
                  100.0 * held / studies, 100.0 * always / studies, maps_used / studies);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto studies = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 1000);
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 501);
  maps_table(studies, seed);
  worlds_table(studies, seed);
  stopping_table(studies, seed);
}
