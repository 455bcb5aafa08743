// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "stereo/grey_levels.h"

#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// How a ground truth came about, which says what figures it can judge.
enum class TruthKind {
  exact,     ///< made with the images: all of them
  measured,  ///< by structured light or a laser: sub-pixel figures hold its own error too
  reduced,   ///< measured at a larger size: may be biased by tenths of a pixel
  labelled,  ///< whole pixels: nothing below one
};

std::string_view name(TruthKind kind);

/// A rectified pair with ground truth, by its files.
struct StereoSceneFile {
  std::string name;
  std::filesystem::path left, right;
  std::filesystem::path truth;        ///< disparities of the left image (stereo/disparity_file.h)
  std::filesystem::path right_truth;  ///< those of the right one; empty: none
  double truth_scale = 1;             ///< values a pixel in both
  TruthKind truth_kind = TruthKind::measured;
  DisparityRange range;       ///< to be searched
  std::filesystem::path rig;  ///< that took the pair; empty: not known
};

/// Reads a list of pairs, TOML with one table a pair:
///
///     [[pair]]
///     name = "teddy"
///     left = "teddy/im2.png"          # beside the list, unless it begins with /
///     right = "teddy/im6.png"
///     truth = "teddy/disp2.png"
///     truth_scale = 4                 # 1 if not given
///     max_disparity = 64
///     right_truth = "teddy/disp6.png" # and the rest: if there is one
///     min_disparity = 0
///     truth_kind = "measured"
///     rig = "teddy.rig.json"
///
/// Throws Error(file:line) for a key that is missing or not known, a name given twice, an empty
/// range and a file that is not there.
std::vector<StereoSceneFile> read_stereo_scenes(const std::filesystem::path& file);

/// Reads a pair's ground truth. Throws Error naming the file, for its size too where that is not
/// the images' one.
StereoTruth read_stereo_truth(const StereoSceneFile& scene, int width_px, int height_px);

}  // namespace vernier::stereo::internal
