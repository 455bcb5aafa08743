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
#include "sim/study/system_reader.h"
#include "sim/study/told_settings.h"

namespace vernier::sim::internal {

namespace {

/// Each setting that differs, with both values.
std::vector<std::string> differing_settings(const StudyCell& stored, const StudyCell& wanted) {
  std::vector<std::string> all;
  for (const auto& [key, value] : stored.settings) {
    if (key == "rig.truth" || key == "calibration.observations") continue;  // by content
    if (applies_on_reading(key)) continue;
    const auto other = wanted.settings.find(key);
    if (other == wanted.settings.end() || other->second != value) {
      all.push_back(fmt::format("{} is {} there and {} here", key, value,
                                other == wanted.settings.end() ? "not set" : other->second));
    }
  }
  for (const auto& [key, value] : wanted.settings) {
    if (names_a_file(key) || applies_on_reading(key) || stored.settings.contains(key)) continue;
    all.push_back(fmt::format("{} is not set there and {} here", key, value));
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

/// Of files with the same name in both; which there are, the settings of the cells say.
template <class Files>
std::string file_difference(const Files& stored, const Files& wanted, const char* key) {
  for (const auto& [name, file] : stored) {
    const auto other = wanted.find(name);
    if (other != wanted.end() && other->second.fingerprint != file.fingerprint) {
      return fmt::format("the file {} that {} names differs", name, key);
    }
  }
  return "";
}

/// All worlds by name, where there are several.
std::map<std::string, StudyWorld> swept_worlds(const Study& study) {
  std::map<std::string, StudyWorld> all;
  for (const auto& [name, world] : study.other_worlds) all[name].fingerprint = world.fingerprint;
  all[study.file.world].fingerprint = study.world_fingerprint;
  return all;
}

}  // namespace

std::string study_difference(const Study& stored, const Study& wanted) {
  const bool swept = stored.file.cells[0].settings.contains("world.file");
  if (swept) {
    const auto why = file_difference(swept_worlds(stored), swept_worlds(wanted), "world.file");
    if (!why.empty()) return why;
  } else if (stored.world_fingerprint != wanted.world_fingerprint) {
    return fmt::format("the world file differs (world.file is {} there and {} here)",
                       stored.file.world, wanted.file.world);
  }
  if (stored.rig_fingerprint != wanted.rig_fingerprint) {
    return fmt::format("the rig file differs (rig.file is {} there and {} here)", stored.file.rig,
                       wanted.file.rig);
  }
  const auto told = file_difference(stored.told_rigs, wanted.told_rigs, "rig.file");
  if (!told.empty()) return told;
  if (stored.corners_fingerprint != wanted.corners_fingerprint) {
    return "the corners of calibration.observations differ";
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

std::string limit_difference(const Study& stored, const Study& wanted) {
  for (const StudyCell& cell : stored.file.cells) {
    const StudyCell* other = nullptr;
    bool has_same = false;
    for (const StudyCell& of_wanted : wanted.file.cells) {
      if (!differing_settings(cell, of_wanted).empty()) continue;
      other = &of_wanted;
      has_same = has_same || of_wanted.system.success_error == cell.system.success_error;
    }
    if (has_same || !other) continue;
    return fmt::format("system.success_error is {} there and {} here", cell.system.success_error,
                       other->system.success_error);
  }
  return "";
}

}  // namespace vernier::sim::internal
