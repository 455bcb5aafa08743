// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stereo/grey_levels.h"

#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// How a ground truth was made, which limits the errors it can measure.
enum class TruthKind {
  exact,     ///< known from how the images were made: valid for all figures
  measured,  ///< structured light or laser: its own error adds to sub-pixel figures
  reduced,   ///< measured at a larger image size: may be biased by tenths of a pixel
  labelled,  ///< integer pixels: no sub-pixel figures
};

std::string_view name(TruthKind kind);

/// Files of a rectified pair with ground truth.
struct StereoSceneFile {
  std::string name;
  std::filesystem::path left, right;
  std::filesystem::path truth;        ///< disparities of the left image (stereo/disparity_file.h)
  std::filesystem::path right_truth;  ///< disparities of the right image; empty: none
  double truth_scale = 1;             ///< file values per pixel, in both
  /// The value that means unknown, beside those of the formats (stereo/disparity_file.h); NaN: none
  /// has this meaning.
  std::optional<double> truth_unknown;
  TruthKind truth_kind = TruthKind::measured;
  DisparityRange range;       ///< search range
  std::filesystem::path rig;  ///< rig of the pair; empty: unknown
};

/// Reads a list of pairs: TOML with one table per pair:
///
///     [[pair]]
///     name = "teddy"
///     left = "teddy/im2.png"          # relative to the list, or absolute
///     right = "teddy/im6.png"
///     truth = "teddy/disp2.png"
///     truth_scale = 4                 # default 1
///     max_disparity = 64
///     right_truth = "teddy/disp6.png" # this and the rest are optional
///     min_disparity = 0
///     truth_unknown = -1              # "none": no value means unknown
///     truth_kind = "measured"
///     rig = "teddy.rig.json"
///
/// Paths are relative to the list. Throws Error(file:line) for a missing or unknown key, a
/// duplicate name, an empty range and a file that does not exist.
std::vector<StereoSceneFile> read_stereo_scenes(const std::filesystem::path& file);

/// Reads the ground truth of a pair. Throws Error naming the file, also if its size differs from
/// that of the images.
StereoTruth read_stereo_truth(const StereoSceneFile& scene, int width_px, int height_px);

}  // namespace vernier::stereo::internal
