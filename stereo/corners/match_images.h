// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/pair_observations.h"
#include "calib/rig_estimate.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/epipolar_band.h"

namespace vernier::stereo::internal {

/// Two images taken at the same time.
struct ImageFiles {
  int number = 0;
  std::filesystem::path left, right;
};

/// Files matching two glob patterns, paired by the last number in their names, in ascending order;
/// a single file per side forms a pair whatever its name. Throws Error naming the file if an image
/// has no partner or two images of one side have the same number.
std::vector<ImageFiles> paired_images(const std::string& left, const std::string& right);

std::vector<std::filesystem::path> left_images(const std::vector<ImageFiles>& pairs);

struct ImageMatchingOptions {
  int corners = 400;  ///< maximum in the left image; the right image may have half as many more
  int cells = 0;      ///< distributes corners evenly over a grid of cells x cells; 0: off
  BandOptions band;
  CornerMatchingOptions matching;
};

/// Result of matching an image pair.
struct ImageMatching {
  ImageFiles files;
  int corners_left = 0, corners_right = 0;
  double noise_left = 0, noise_right = 0;  ///< standard deviation, grey levels
  long candidates = 0;                     ///< corner pairs within the epipolar gate
  std::vector<CornerMatch> matches;
};

/// Matches the corners of an image pair (stereo/corners/corner_matching.h) within the epipolar
/// bands of a prior rig. The partner of a left corner may be among the weakest in the right image,
/// so the right image gets more corners. `prior_place` names the prior in error messages. Throws
/// Error for files that are not images, image sizes other than those of the prior's cameras, and a
/// prior without covariance.
ImageMatching match_images(const ImageFiles& files,
                           const RigEstimate& prior,
                           const std::string& prior_place,
                           const ImageMatchingOptions& options = {});

/// Appends the matches as observations of image pair files.number.
void add_matches(PairObservations& pairs, const ImageMatching& matching);

}  // namespace vernier::stereo::internal
