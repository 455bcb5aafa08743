// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sim/experiment.h"

namespace vernier::sim::internal {

/// One combination of the swept settings.
struct StudyCell {
  std::string label;  ///< swept keys and values, such as "sources.calibration = 10"
  std::map<std::string, std::string> settings;  ///< every setting in effect, by dotted key
  ExperimentSettings experiment;
};

/// Trials of a block, which share one recorded map: 50, or so few that `trials` make six maps or
/// more, the fewest that an interval is stated for.
int block_size(int trials);

/// What a study file says (docs/file-formats.md).
struct StudyFile {
  int trials = 900;           ///< a cell
  int trials_per_block = 50;  ///< block_size(trials)
  std::string world = "workshop";
  std::string rig = "nominal";
  std::filesystem::path sources;        ///< file that [sources] begins with; empty: none
  std::vector<std::string> sweep_keys;  ///< first is slowest
  std::vector<std::vector<std::string>> sweep_values;  ///< as text, one list a key
  std::vector<StudyCell> cells;                        ///< all combinations
};

/// Reads a study. Everything but [study] has a default. Throws Error with file, line and key for
/// TOML that is malformed, an unknown key (naming the nearest known one), a value of the wrong
/// type or out of its range, or a sweep over a key that does not exist. The `file` of [sources] is
/// looked for beside the study, unless `sources` says where a copy of it is.
StudyFile read_study(const std::filesystem::path& file, const std::filesystem::path& sources = {});
StudyFile parse_study(const std::string& text,
                      const std::string& place,
                      const std::filesystem::path& sources = {});

}  // namespace vernier::sim::internal
