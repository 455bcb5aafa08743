// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "cli/program/namespaces.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "stereo/segment.h"

namespace vernier::cli {

/// What is drawn of both images: the features as they are, as they are sensed, and as the estimator
/// believes they are, projected by the true rig (the memo's Fig. 1).
class SightingPicture {
 public:
  /// `told` are segments in space, in the left camera frame of the rig that the estimator assumes.
  SightingPicture(const Rig& true_rig,
                  const NoiseFreeView& seen,
                  const StereoObservation& sighting,
                  std::span<const SpaceSegment> told);

  std::string svg() const;
  std::string png() const;

 private:
  enum class Kind { exact, told, sensed };
  struct Line {
    ImageSegment segment;
    Kind kind;
  };
  struct Dot {
    Eigen::Vector2d at_px;
    bool mismatched;
  };
  struct Image {
    int width = 0, height = 0;
    std::vector<Line> lines;  // those above the others last
    std::vector<Dot> dots;
  };
  static const char* colour(Kind kind);
  std::string image_svg(const Image& image, int number, double left_px) const;

  Image images_[2];
};

}  // namespace vernier::cli
