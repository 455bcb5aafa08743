// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "stereo/disparity_file.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "tests/support/stereo_scenes.h"

namespace vernier::test {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

/// A scene's files; a compressed archive is written anew, into `folder`, as what the library reads.
inline StereoSceneFile files_of(const StereoScene& scene, const std::filesystem::path& folder) {
  StereoSceneFile files;
  files.name = scene.name;
  files.left = scene.left;
  files.right = scene.right;
  files.truth = scene.disparity;
  files.truth_scale = scene.disparity_scale;
  files.range.max_px = static_cast<int>(scene.max_disparity_px);
  if (std::filesystem::exists(scene.right_disparity)) files.right_truth = scene.right_disparity;
  if (files.truth.extension() == ".npz") {
    const GreyLevels left = read_grey_levels(scene.left);
    const cv::Mat map = read_npz(files.truth, {left.width_px, left.height_px});
    files.truth = folder / "truth.png";
    DisparityMap known{map.cols, map.rows, {map.begin<float>(), map.end<float>()}};
    for (float& d : known.values) {
      if (d == 0) d = std::numeric_limits<float>::quiet_NaN();
    }
    files.truth_scale = 256;
    write_disparity(files.truth, known);
  }
  return files;
}

}  // namespace vernier::test
