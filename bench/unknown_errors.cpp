// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// unknown_errors FIRST LAST QUERIES: what localisation makes of errors that its model does not
// have.
//
//   none     the simulated sources alone, which it knows
//   clutter  a fifth more lines in the query, which nothing in the world explains: each is a line
//            of the query itself, turned about the robot and moved, so that it looks like an edge
//   moved    a tenth of the furniture displaced by 0.3 to 1 m and turned since the map was recorded
//   half     the map holds the lower half of the nodes by x; queries within 0.8 m of one of them
//            (`on`) and further than 1.5 m from all (`off`), with prior probabilities of being off
//            the map
//
// In offices of seeds FIRST to LAST, protocol `path`, stated error at most 0.005, for `half` 0.01.
// Prints a line a condition: the mean over worlds with its standard error over them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/statistics/random.h"
#include "datasets/shipped.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/buildings/office.h"
#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace {

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;

constexpr double clutter_share = 0.2, moved_share = 0.1;

/// Adds false lines to every view before a localiser sees it.
class WithClutter : public localise::Localiser {
 public:
  WithClutter(const localise::Localiser& localiser, std::uint64_t seed)
      : localiser_(localiser), seed_(seed) {}

  localise::LocalisationAnswer localise(const localise::PlaceView& query) const override {
    localise::PlaceView cluttered = query;
    const auto lines = static_cast<std::uint32_t>(query.lines.size());
    vernier::internal::RandomStream draws({.seed = seed_, .trial = queries_++});
    const auto added = static_cast<std::uint32_t>(std::lround(clutter_share * lines));
    for (std::uint32_t i = 0; i < added; ++i) {
      const auto of = static_cast<std::size_t>(draws.uniform(0, lines - 1e-9));
      localise::PlaceLine line = query.lines[of];
      const double turn = draws.uniform(-0.3, 0.3), nearer = draws.uniform(0.7, 1);
      const double c = nearer * std::cos(turn), s = nearer * std::sin(turn);
      const double up = draws.uniform(-0.3, 0.3);
      for (Eigen::Vector3d* end : {&line.a_m, &line.b_m}) {
        *end = {c * end->x() - s * end->y(), s * end->x() + c * end->y(), end->z() + up};
      }
      cluttered.lines.push_back(line);
    }
    return localiser_.localise(cluttered);
  }

 private:
  const localise::Localiser& localiser_;
  std::uint64_t seed_;
  mutable std::uint32_t queries_ = 0;
};

struct Counts {
  int queries = 0, right = 0, answered = 0, answered_right = 0;

  void add(const TrialResult& result) {
    ++queries;
    right += result.error <= success_radius_m;
    answered += result.answered();
    answered_right += result.success();
  }
};

Counts count(const LocalisationExperiment& experiment,
             const localise::TopologicalMap& map,
             const localise::Localiser& localiser,
             std::uint32_t queries) {
  Counts counts;
  for (std::uint32_t trial = 0; trial < queries; ++trial) {
    counts.add(experiment.run_trial(trial, experiment.estimator_rig(trial), map, localiser));
  }
  return counts;
}

constexpr std::array off_map_priors{0.0, 0.001, 0.01, 0.1};
constexpr double on_map_m = 0.8, off_map_m = 1.5;

struct HalfMapCounts {
  Counts on, off;
};

/// Queries from everywhere to a map of half of a world, for each prior.
std::array<HalfMapCounts, off_map_priors.size()> count_on_half_map(
    const LocalisationExperiment& experiment,
    const localise::TopologicalMap& whole,
    const localise::LocaliserOptions& options,
    std::uint32_t queries) {
  localise::TopologicalMap half = whole;
  const auto by_x = [](const localise::MapNode& a, const localise::MapNode& b) {
    return a.pose.x_m < b.pose.x_m;
  };
  std::stable_sort(half.nodes.begin(), half.nodes.end(), by_x);
  half.nodes.resize(half.nodes.size() / 2);
  std::array<HalfMapCounts, off_map_priors.size()> counts;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    localise::LocaliserOptions with_prior = options;
    with_prior.max_error_rate = 0.01;
    with_prior.off_map = off_map_priors[i];
    const auto localiser = localise::make_localiser("lines", half, with_prior);
    for (std::uint32_t trial = 0; trial < queries; ++trial) {
      const TrialResult result =
          experiment.run_trial(trial, experiment.estimator_rig(trial), half, *localiser);
      double nearest = std::numeric_limits<double>::infinity();
      for (const localise::MapNode& node : half.nodes) {
        nearest = std::min(nearest, distance_m(node.pose, result.truth));
      }
      if (nearest < on_map_m) counts[i].on.add(result);
      if (nearest > off_map_m) counts[i].off.add(result);
    }
  }
  return counts;
}

/// What was counted in a world.
struct WorldCounts {
  std::array<Counts, 3> errors;  // none, clutter, moved
  std::array<HalfMapCounts, off_map_priors.size()> half;
};

/// All conditions in one world.
WorldCounts conditions(std::uint64_t seed, std::uint32_t queries) {
  ExperimentSettings settings;
  settings.sources.calibration = 1;
  settings.seed = seed;
  settings.localiser.max_error_rate = 0.005;
  const World world = build_world(make_office(seed)),
              later = with_moved_furniture(world, moved_share, seed);
  const Visibility visibility(world), later_visibility(later);
  const RigEstimate rig = datasets::nominal();
  const auto views = std::make_shared<MapViews>(map_views(visibility, rig.rig, settings));
  const LocalisationExperiment now(visibility, rig, views, settings);
  const LocalisationExperiment afterwards(later_visibility, rig, views, settings);
  const localise::TopologicalMap map = now.record_map(0, now.map_estimator_rig(0));
  const auto localiser = localise::make_localiser("lines", map, settings.localiser);
  const WithClutter cluttered(*localiser, seed);
  return {{count(now, map, *localiser, queries), count(now, map, cluttered, queries),
           count(afterwards, map, *localiser, queries)},
          count_on_half_map(now, map, settings.localiser, queries)};
}

void print(const std::string& name, const std::vector<Counts>& worlds) {
  Counts sum;
  std::vector<double> success;
  double mean = 0;
  for (const Counts& world : worlds) {
    sum.queries += world.queries;
    sum.right += world.right;
    sum.answered += world.answered;
    sum.answered_right += world.answered_right;
    success.push_back(100.0 * world.right / std::max(1, world.queries));
    mean += success.back() / static_cast<double>(worlds.size());
  }
  double squares = 0;
  for (const double s : success) squares += (s - mean) * (s - mean);
  const auto n = static_cast<double>(worlds.size());
  std::printf(
      "%s: %d queries, best guess right %.2f %% (standard error over worlds %.2f), "
      "%d of %d answers right (%.2f %%), coverage %.2f %%\n",
      name.c_str(), sum.queries, mean, n > 1 ? std::sqrt(squares / (n - 1) / n) : 0,
      sum.answered_right, sum.answered, 100.0 * sum.answered_right / std::max(1, sum.answered),
      100.0 * sum.answered / std::max(1, sum.queries));
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fprintf(stderr, "usage: unknown_errors FIRST LAST QUERIES\n");
    return 2;
  }
  try {
    const auto queries = static_cast<std::uint32_t>(std::atoi(words[3]));
    if (std::atoi(words[1]) < 1 || std::atoi(words[2]) < std::atoi(words[1]) ||
        std::atoi(words[3]) < 1) {
      std::fprintf(stderr, "unknown_errors: FIRST, LAST and QUERIES are whole numbers from 1\n");
      return 2;
    }
    std::array<std::vector<Counts>, 3> all;
    std::array<std::vector<Counts>, off_map_priors.size()> on, off;
    for (int seed = std::atoi(words[1]); seed <= std::atoi(words[2]); ++seed) {
      const auto world = conditions(static_cast<std::uint64_t>(seed), queries);
      for (std::size_t i = 0; i < all.size(); ++i) all[i].push_back(world.errors[i]);
      for (std::size_t i = 0; i < off_map_priors.size(); ++i) {
        on[i].push_back(world.half[i].on);
        off[i].push_back(world.half[i].off);
      }
    }
    const char* names[] = {"none", "clutter", "moved"};
    for (std::size_t i = 0; i < all.size(); ++i) print(names[i], all[i]);
    for (std::size_t i = 0; i < off_map_priors.size(); ++i) {
      const std::string prior = std::to_string(off_map_priors[i]);
      print("half, prior " + prior + ", on", on[i]);
      print("half, prior " + prior + ", off", off[i]);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "unknown_errors: %s\n", error.what());
    return 1;
  }
  return 0;
}
