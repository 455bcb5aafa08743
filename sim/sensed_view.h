// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim {

/// An edge passing through the error sources: its true ends, and the displacement of each end in
/// each camera. Ends are projected on demand, so that the ends of a cut piece lie exactly on the
/// edge, for any lens.
struct SensedEdge {
  VisibleEdge truth;
  std::array<std::array<Eigen::Vector2d, 2>, 2> offset_px{};  ///< [eye][end]
  std::uint32_t piece = 0;  ///< index of the part left by an edge-loss gap

  SensedEdge() {
    for (auto& eye : offset_px) eye.fill(Eigen::Vector2d::Zero());
  }
};

/// A corner pair in both images.
struct SensedCorner {
  VisibleCorner truth;
  std::array<Eigen::Vector2d, 2> pixel_px;  ///< [camera]
  bool mismatched = false;
};

struct SensedView {
  std::vector<SensedEdge> edges;
  std::vector<SensedCorner> corners;
};

/// The true rig and the trial's identity, which keys every random draw.
struct SensingContext {
  const Rig& rig;
  const stereo::Rectification& rectification;
  std::uint64_t seed = 0;
  std::uint32_t trial = 0;
  std::uint32_t frame = 0;
};

/// The edge in the image of a camera (0 left, 1 right), displacements included.
stereo::ImageSegment image_of(const Rig& rig, const SensedEdge& edge, int eye);

}  // namespace vernier::sim
