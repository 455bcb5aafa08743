// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/study/study.h"
#include "sim/study/study_file.h"

namespace vernier::sim::internal {

namespace {

/// Each setting that differs, with both values.
std::vector<std::string> differing_settings(const StudyCell& stored, const StudyCell& wanted) {
  std::vector<std::string> all;
  for (const auto& [key, value] : stored.settings) {
    const auto other = wanted.settings.find(key);
    if (other == wanted.settings.end() || other->second != value) {
      all.push_back(fmt::format("{} is {} there and {} here", key, value,
                                other == wanted.settings.end() ? "not set" : other->second));
    }
  }
  return all;
}

/// What differs from the most similar cell.
std::vector<std::string> least_difference(const StudyCell& stored, const Study& wanted) {
  std::vector<std::string> least = differing_settings(stored, wanted.file.cells[0]);
  for (const StudyCell& cell : wanted.file.cells) {
    std::vector<std::string> differing = differing_settings(stored, cell);
    if (differing.size() < least.size()) least = std::move(differing);
  }
  return least;
}

}  // namespace

std::string study_difference(const Study& stored, const Study& wanted) {
  if (stored.world_fingerprint != wanted.world_fingerprint) {
    return fmt::format("the world file differs (world.file is {} there and {} here)",
                       stored.file.world, wanted.file.world);
  }
  if (stored.rig_fingerprint != wanted.rig_fingerprint) {
    return fmt::format("the rig file differs (rig.file is {} there and {} here)", stored.file.rig,
                       wanted.file.rig);
  }
  for (const StudyCell& cell : stored.file.cells) {
    const std::vector<std::string> differing = least_difference(cell, wanted);
    if (differing.empty()) continue;
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, differing.size()); ++i) {
      text += (i > 0 ? ", " : "") + differing[i];
    }
    return differing.size() > most ? text + ", …" : text;
  }
  const std::optional<double>&there = stored.file.interval_width,
        &here = wanted.file.interval_width;
  if (here && (!there || *here > *there)) {
    return fmt::format(
        "study.interval_width is {} there and {} here, and a study can only be extended",
        there ? fmt::format("{}", *there) : "not set", *here);
  }
  if (stored.file.trials > wanted.file.trials) {
    return fmt::format("study.trials is {} there and {} here, and a study can only be extended",
                       stored.file.trials, wanted.file.trials);
  }
  return "";
}

}  // namespace vernier::sim::internal
