// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/scene_options.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <tuple>

#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "stereo/evaluation/stereo_scenes.h"

namespace vernier::cli {

void add_scene_options(CLI::App& verb, SceneOptions& o) {
  auto* scenes =
      verb.add_option("--scenes", o.scenes, "TOML list of stereo pairs (docs/matchers.md)");
  for (const auto& [name, value, help] :
       {std::tuple{"--left", &o.one.left, "rectified left image"},
        std::tuple{"--right", &o.one.right, "rectified right image"},
        std::tuple{"--truth", &o.one.truth,
                   "ground truth disparities of the left image: PFM, PNG, .npy"},
        std::tuple{"--right-truth", &o.one.right_truth,
                   "ground truth disparities of the right image: improves occlusion detection"}}) {
    verb.add_option(name, *value, help)->excludes(scenes);
  }
  verb.add_option("--truth-scale", o.one.truth_scale, "ground truth values per pixel of disparity")
      ->check(finite_and_positive)
      ->excludes(scenes)
      ->capture_default_str();
  verb.add_option("--truth-unknown", o.truth_unknown,
                  "ground truth value that means unknown, such as 0 or -1 in PFM and .npy; none: "
                  "no value does")
      ->excludes(scenes);
  verb.add_option("--max-disparity", o.one.range.max_px, "largest disparity to search, pixels")
      ->excludes(scenes)
      ->capture_default_str();
  verb.add_option("--min-disparity", o.one.range.min_px, "smallest disparity to search, pixels")
      ->excludes(scenes)
      ->capture_default_str();
}

void require_scenes(const CLI::App& verb, const SceneOptions& options) {
  if (!options.scenes.empty()) return;
  for (const char* needed : {"--left", "--right", "--truth"}) {
    if (verb.count(needed) == 0) throw CLI::RequiredError(needed);
  }
}

std::vector<StereoSceneFile> scene_files(const SceneOptions& options) {
  if (!options.scenes.empty()) return read_stereo_scenes(options.scenes);
  StereoSceneFile scene = options.one;
  scene.name = scene.left.stem().string();
  if (options.truth_unknown == "none") {
    scene.truth_unknown = std::numeric_limits<double>::quiet_NaN();
  } else if (!options.truth_unknown.empty()) {
    scene.truth_unknown = parse_numbers(options.truth_unknown, 1, "--truth-unknown")[0];
  }
  return {scene};
}

std::vector<std::filesystem::path> inputs_of(const SceneOptions& options,
                                             const std::vector<StereoSceneFile>& files) {
  std::vector<std::filesystem::path> inputs{options.scenes};
  for (const StereoSceneFile& file : files) {
    inputs.insert(inputs.end(), {file.left, file.right, file.truth, file.right_truth, file.rig});
  }
  return inputs;
}

}  // namespace vernier::cli
