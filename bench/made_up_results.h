// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/fingerprint.h"
#include "calib/rig_file.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/world_file.h"

namespace vernier {

/// Trials with numbers as long as those of computed ones.
inline std::vector<sim::TrialResult> made_up_trials(int first, int count) {
  std::vector<sim::TrialResult> trials;
  for (int i = first; i < first + count; ++i) {
    std::uint64_t state = 0x9e3779b97f4a7c15ull * static_cast<std::uint64_t>(i + 1);
    const auto next = [&] {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      return static_cast<double>(state >> 11) * 0x1p-53;
    };
    sim::TrialResult t;
    t.trial = static_cast<std::uint32_t>(i);
    t.status = localise::LocalisationStatus::answered;
    for (localise::Pose2D* pose : {&t.truth, &t.answer, &t.node}) {
      *pose = {10 * next(), 8 * next(), 3 * next()};
    }
    t.error = t.node_error_m = 1.2 * next();
    t.heading_error_rad = 0.1 * next();
    t.lines = 30 + i % 40;
    t.score = next();
    t.runner_up = next();
    t.cpu_ms = 10 * next();
    t.wall_ms = 10 * next();
    t.probability = next();
    trials.push_back(t);
  }
  return trials;
}

/// The study of a folder, as far as its work depends on it.
inline sim::internal::Study made_up_study(const std::filesystem::path& folder) {
  using namespace vernier::internal;
  sim::internal::Study study;
  study.file = sim::internal::read_study(folder / "study.toml");
  const std::filesystem::path world = folder / "world.world.toml", rig = folder / "rig.json";
  study.world_fingerprint = fingerprint(read_whole(world));
  study.rig_fingerprint = fingerprint(read_whole(rig));
  study.world = sim::build_world(sim::parse_world(read_whole(world), world.string()));
  study.rig = parse_rig(read_whole(rig), rig.string()).estimate;
  return study;
}

}  // namespace vernier
