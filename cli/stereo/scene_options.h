// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "stereo/evaluation/stereo_scenes.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Stereo pairs with ground truth from the command line: a list file, or one pair by its files.
struct SceneOptions {
  std::string scenes;
  StereoSceneFile one;
  std::string truth_unknown;  ///< of that one: a number, or "none"
};

/// Adds --scenes, or --left --right --truth with --right-truth, --truth-scale, --max-disparity and
/// --min-disparity.
void add_scene_options(CLI::App& verb, SceneOptions& options);

/// Throws CLI::RequiredError for the first missing option if there is no --scenes.
void require_scenes(const CLI::App& verb, const SceneOptions& options);

std::vector<StereoSceneFile> scene_files(const SceneOptions& options);

/// All input files of the scenes.
std::vector<std::filesystem::path> inputs_of(const SceneOptions& options,
                                             const std::vector<StereoSceneFile>& files);

}  // namespace vernier::cli
