// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/toml_reader.h"
#include "fuzz/fuzz_target.h"
#include "stereo/evaluation/stereo_scenes.h"

namespace vernier::fuzz {
namespace {

using stereo::internal::read_stereo_scenes;
using stereo::internal::StereoSceneFile;

void run_stereo_scenes(std::string_view bytes) {
  input_file("", "a.png");  // a file that pairs may name
  const std::filesystem::path file = input_file(bytes, "scenes.toml");
  const auto scenes = accepted([&] { return read_stereo_scenes(file); });
  if (!scenes) return;
  for (const StereoSceneFile& scene : *scenes) {
    require(scene.truth_scale > 0 && scene.range.min_px <= scene.range.max_px,
            "a pair has a scale and a range");
  }
}

/// Nothing writes these files: as docs/evaluation.md has them.
std::vector<std::string> stereo_scenes_seeds() {
  return {
      "[[pair]]\nname = \"teddy\"\nleft = \"a.png\"\nright = \"a.png\"\ntruth = \"a.png\"\n"
      "truth_scale = 4\nmax_disparity = 64\nright_truth = \"a.png\"\nmin_disparity = 0\n"
      "truth_kind = \"measured\"\nrig = \"a.png\"\n"};
}

const Registered registered_stereo_scenes{
    {"stereo_scenes", 2000, "scenes", run_stereo_scenes, stereo_scenes_seeds}};

}  // namespace
}  // namespace vernier::fuzz
