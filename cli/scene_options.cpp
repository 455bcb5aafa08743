// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_options.h"

#include "calib/error.h"
#include "cli/option_checks.h"

namespace vernier::cli {

void add_scene_options(CLI::App& verb, SceneOptions& o) {
  auto* scenes = verb.add_option("--scenes", o.scenes, "TOML list of pairs (docs/matchers.md)");
  for (const auto& [name, value, help] :
       {std::tuple{"--left", &o.one.left, "left image, rectified"},
        std::tuple{"--right", &o.one.right, "right image"},
        std::tuple{"--truth", &o.one.truth, "true disparities of the left image: PFM, PNG, .npy"},
        std::tuple{"--right-truth", &o.one.right_truth,
                   "those of the right image: what it does not show is told better"}}) {
    verb.add_option(name, *value, help)->excludes(scenes);
  }
  verb.add_option("--truth-scale", o.one.truth_scale, "values a pixel of the truth")
      ->check(finite_and_positive)
      ->excludes(scenes)
      ->capture_default_str();
  verb.add_option("--max-disparity", o.one.range.most_px, "largest disparity searched, pixels")
      ->excludes(scenes)
      ->capture_default_str();
  verb.add_option("--min-disparity", o.one.range.least_px, "smallest one")
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

RectifiedPair read_pair(const StereoSceneFile& file, const Session& session) {
  RectifiedPair pair;
  for (const bool left : {true, false}) {
    std::string remark;
    const std::filesystem::path& image = left ? file.left : file.right;
    (left ? pair.left : pair.right) = read_grey_levels(image, &remark);
    if (!remark.empty()) session.say(image.string() + ": " + remark);
  }
  if (pair.left.width_px != pair.right.width_px || pair.left.height_px != pair.right.height_px) {
    throw Error(file.right.string(),
                fmt::format("it is {}x{}, the left image {}x{}", pair.right.width_px,
                            pair.right.height_px, pair.left.width_px, pair.left.height_px),
                "give a rectified pair of one size");
  }
  return pair;
}

}  // namespace vernier::cli
