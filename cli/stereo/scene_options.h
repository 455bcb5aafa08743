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

/// Pairs with ground truth on the command line: a list of them, or one by its files.
struct SceneOptions {
  std::string scenes;
  StereoSceneFile one;
};

/// --scenes, or --left --right --truth with --right-truth, --truth-scale, --max-disparity and
/// --min-disparity.
void add_scene_options(CLI::App& verb, SceneOptions& options);

/// Throws CLI::RequiredError for the first that is missing where there is no --scenes.
void require_scenes(const CLI::App& verb, const SceneOptions& options);

std::vector<StereoSceneFile> scene_files(const SceneOptions& options);

/// Every file that is read for the scenes.
std::vector<std::filesystem::path> inputs_of(const SceneOptions& options,
                                             const std::vector<StereoSceneFile>& files);

}  // namespace vernier::cli
