// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/program/session.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"

namespace vernier::cli {

/// The study file's copy in a folder: with it the folder is a study's.
inline constexpr const char* study_copy = "study.toml";

/// What a study's folder keeps beside its stores, each a name and its content: world.world.toml,
/// world-2.world.toml … of swept worlds, rig.json (the true rig), told.json, told-2.json … of the
/// rigs that are told, corners.json or corners.vnl, sources.toml if [sources] names a file,
/// study.toml.
using StudyInputs = std::vector<std::pair<std::string, std::string>>;

/// The inputs of a study file, and those that a folder has.
StudyInputs inputs_of_study(const std::filesystem::path& study_file);
/// The same of the text of a study file that stands, or might stand, at a place.
StudyInputs inputs_of_study(const std::string& text, const std::filesystem::path& place);
StudyInputs inputs_of_folder(const std::filesystem::path& folder);

/// The files of a study's folder that are inputs, which an output must not replace.
std::vector<std::filesystem::path> input_files(const std::filesystem::path& folder);

/// Loads a study file with its worlds, rigs and corners (shipped, or relative to the study file).
/// From then on OpenCV has one thread in this process if the study's system uses it.
Study load_study(const std::filesystem::path& file, Session& session);

/// The same of a text, as above.
Study load_study(const std::string& text, const std::filesystem::path& place, Session& session);

/// Throws Error for settings without effect, and says which sources have none, unless the folder
/// already holds a study: what was begun can be gone on with.
void check_new_study(const Study& study, const std::filesystem::path& folder, Session& session);

/// A study with its inputs (of the folder `beside`) but for its true rig, for a caller that gives
/// it one.
Study load_inputs_without_rig(const StudyFile& study,
                              const std::filesystem::path& beside,
                              Session& session);

/// The study of a results folder, by its own copies of the inputs, so that it can be moved.
Study open_folder(const std::filesystem::path& folder, Session& session);

}  // namespace vernier::cli
