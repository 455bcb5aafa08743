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

/// Two simultaneous images.
struct ImageFiles {
  int number = 0;
  std::filesystem::path left, right;
};

/// The files that two patterns match, paired by the last number in their names, ascending; one file
/// a side is a pair whatever its name. Throws Error naming the file where one has no partner or
/// shares its number with another of its side.
std::vector<ImageFiles> paired_images(const std::string& left, const std::string& right);

struct ImageMatchingOptions {
  int corners = 400;  ///< at most, in the left image; the right one may have half as many again
  int cells = 0;      ///< corners spread evenly over cells x cells parts of the image; 0: not
  BandOptions band;
  CornerMatchingOptions matching;
};

/// What became of an image pair.
struct ImageMatching {
  ImageFiles files;
  int corners_left = 0, corners_right = 0;
  double noise_left = 0, noise_right = 0;  ///< standard deviation, grey values
  long candidates = 0;                     ///< pairs of corners that the prior lets be one
  std::vector<CornerMatch> matches;
};

/// Matches the corners of an image pair (stereo/corners/corner_matching.h), searching where a prior
/// of the rig says. The left image's corners may be near the weakest of the right one's, which is
/// why the right image gets more. Throws Error for files that are no images or not of the size of
/// the prior's cameras (`prior_place` is the prior's name in messages), and where it has no
/// covariance.
ImageMatching match_images(const ImageFiles& files,
                           const RigEstimate& prior,
                           const std::string& prior_place,
                           const ImageMatchingOptions& options = {});

/// The matches as observations of image pair files.number, appended.
void add_matches(PairObservations& pairs, const ImageMatching& matching);

}  // namespace vernier::stereo::internal
