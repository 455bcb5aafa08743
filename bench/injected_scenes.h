// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Real pairs of images into which a wrong calibration is put, with the lines that are compared.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "told_wrong.h"

namespace vernier::bench {

/// One pair of a scene and its lines as the given rig, or the truth, has them.
struct Sight {
  RawPair images;
  std::vector<PlacedLine> lines;
};

/// A line of one sight and the same one in a later sight.
struct Link {
  std::size_t from, line, to, same;
  Pose T_to_from;
};

struct Scene {
  RigEstimate estimate;  ///< the given rig, with the covariance
  std::vector<Sight> sights;
  std::vector<Link> links;
  bool against_truth = false;
};

/// Two looks of `still_room` (EuRoC).
Scene still_room(const std::filesystem::path& folder, const RigEstimate& calibrated);

/// Pairs of frames of `drive` (KITTI), 6 m apart.
Scene drive(const std::filesystem::path& folder, const RigEstimate& calibrated);

/// A scene for each pair of a list (docs/matchers.md), with lines from its ground truth.
std::vector<Scene> pairs(const std::filesystem::path& list, const RigEstimate& calibrated);

}  // namespace vernier::bench
