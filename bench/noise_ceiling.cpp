// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// noise_ceiling WORLD PROTOCOL QUERIES [SEED]: the share of noisy looks that tell their place from
// all others (sim/study/noise_ceiling.h), beside the ceiling of the same queries without noise.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>

#include "calib/interval.h"
#include "datasets/shipped.h"
#include "sim/experiment.h"
#include "sim/study/ceiling.h"
#include "sim/study/noise_ceiling.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace {

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;

void run(const std::string& file, const std::string& protocol, int queries, std::uint64_t seed) {
  const World world = build_world(file == "workshop" ? datasets::workshop() : read_world(file));
  const Visibility visibility(world);
  const Rig rig = datasets::nominal().rig;
  const NoiseFreeViewOptions options;
  const QueryPlaces places(visibility, query_protocol(protocol), options.mount.height_m);
  const NoiseCeiling noisy(visibility, rig, options, SourceSettings{});
  const AliasFinder finder(visibility, rig, options);
  int right = 0, unaliased = 0, unaliased_wrong = 0;
  double rivals = 0, ceiling = 0;
  for (int query = 0; query < queries; ++query) {
    const auto trial = static_cast<std::uint32_t>(query);
    const localise::Pose2D pose = places.draw(seed, trial);
    const NoisyLook look = noisy.look_from(pose, {.seed = seed, .trial = trial});
    const QueryCeiling found = query_ceiling(finder.aliases(pose, &places));
    right += look.right();
    unaliased += found.unaliased;
    unaliased_wrong += found.unaliased && !look.right();
    ceiling += found.right / queries;
    rivals += static_cast<double>(look.rivals) / queries;
  }
  const Interval interval = wilson_interval(right, queries);
  std::printf(
      "%s %s: %d of %d looks right, %.2f %% [%.2f, %.2f]; %.1f rivals a look; without noise: "
      "ceiling %.2f %%, unaliased %.2f %%, of these not right %d\n",
      file.c_str(), protocol.c_str(), right, queries, 100.0 * right / queries, 100 * interval.low,
      100 * interval.high, rivals, 100 * ceiling, 100.0 * unaliased / queries, unaliased_wrong);
}

}  // namespace

int main(int count, char** words) {
  if (count < 4) {
    std::fprintf(stderr, "usage: noise_ceiling WORLD PROTOCOL QUERIES [SEED]\n");
    return 2;
  }
  try {
    run(words[1], words[2], std::stoi(words[3]), count > 4 ? std::stoull(words[4]) : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "noise_ceiling: %s\n", error.what());
    return 2;
  }
}
