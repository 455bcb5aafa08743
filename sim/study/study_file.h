// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/system_kind.h"
#include "sim/study/told_settings.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// One combination of the swept settings.
struct StudyCell {
  std::string label;  ///< swept keys and values, such as "sources.calibration = 10"
  std::vector<std::pair<std::string, std::string>> swept;  ///< these keys and values, in order
  std::map<std::string, std::string> settings;             ///< all in effect, by dotted key
  ExperimentSettings experiment;
  std::string world = "workshop";  ///< its file
  VisibilityMethod visibility = VisibilityMethod::exact;
  ToldSettings told;
  SystemSettings system;
};

/// A cell's value of a swept key; empty if it has none.
std::string swept_value(const StudyCell& cell, std::string_view key);

/// Number of trials per block, which share one recorded map: 50, or fewer so that `trials` make at
/// least six maps, the minimum for an interval.
int block_size(int trials);

/// The same for systems whose trials share nothing: a thirtieth of the trials, 1 to 10.
int independent_block_size(int trials);

/// Content of a study file (docs/file-formats.md).
struct StudyFile {
  int trials = 900;                      ///< per cell; at most, with an interval_width
  int trials_per_block = 50;             ///< block_size(trials), or that of independent trials
  std::optional<double> interval_width;  ///< at which a cell stops (budget.h); none: never before
  std::string world = "workshop";        ///< file of the first cell's world
  std::string rig = "nominal";           ///< file of the true rig, one for all cells
  std::filesystem::path sources;         ///< file that [sources] is based on; empty: none
  std::vector<std::string> sweep_keys;   ///< the first varies slowest
  std::vector<std::vector<std::string>> sweep_values;  ///< as text, one list per key
  std::vector<StudyCell> cells;                        ///< all combinations
  std::string place;                                   ///< the file's name, for messages
  std::map<std::string, int> lines;  ///< of tables and dotted keys; of a swept key, its sweep's
};

/// The kind of system that a study tries, one for all cells.
const SystemKind& system_of(const StudyFile& study);

/// Where a dotted key of [section] is set: file and line, of the section if it is not set there.
std::string place_of(const StudyFile& study, const std::string& key);

/// Reads a study. Everything but [study] has a default. Throws Error with file, line and key for
/// malformed TOML, an unknown key (suggesting the nearest one), a value of the wrong type or out of
/// range, and a sweep over a key that does not exist or of rigs without rig.truth. The `file` of
/// [sources] is relative to the study, unless `sources` gives the path of a copy.
StudyFile read_study(const std::filesystem::path& file, const std::filesystem::path& sources = {});
StudyFile parse_study(const std::string& text,
                      const std::string& place,
                      const std::filesystem::path& sources = {});

/// The files of the cells' worlds, and those of the rigs that are told, each once, in the order in
/// which cells first name them.
std::vector<std::string> worlds_of(const StudyFile& study);
std::vector<std::string> told_rigs_of(const StudyFile& study);

}  // namespace vernier::sim::internal
