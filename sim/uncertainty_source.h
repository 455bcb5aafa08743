// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim {

/// An edge on its way through the sources: its true ends, and by how much each end is displaced in
/// each eye. Ends are projected only when asked for, so that a piece cut off an edge still has its
/// ends exactly on it, whatever the lens.
struct SensedEdge {
  VisibleEdge truth;
  std::array<std::array<Eigen::Vector2d, 2>, 2> offset_px{};  ///< [eye][end]
  std::uint32_t piece = 0;  ///< which part after a gap was cut out

  SensedEdge() {
    for (auto& eye : offset_px) eye.fill(Eigen::Vector2d::Zero());
  }
};

/// A corner pair in both images.
struct SensedCorner {
  VisibleCorner truth;
  std::array<Eigen::Vector2d, 2> pixel_px;  ///< [eye]
  bool mismatched = false;
};

struct SensedView {
  std::vector<SensedEdge> edges;
  std::vector<SensedCorner> corners;
};

/// The true rig, and where in the experiment a view stands: with it every draw has its place.
struct SensingContext {
  const Rig& rig;
  const stereo::Rectification& rectification;
  std::uint64_t seed = 0;
  std::uint32_t trial = 0;
  std::uint32_t frame = 0;
};

/// The edge as an eye (0 left, 1 right) sees it, displacements included.
stereo::ImageSegment image_of(const Rig& rig, const SensedEdge& edge, int eye);

/// One source of geometric error. Sources act in a fixed order on the noise-free view of the true
/// rig; each draws from its own stream, keyed by what it acts on, so that switching one on or off
/// leaves the draws of all others as they were.
class UncertaintySource {
 public:
  virtual ~UncertaintySource() = default;
  virtual std::string_view name() const = 0;
  virtual void apply(const SensingContext& context, SensedView& view) const = 0;
};

/// The sources that these settings switch on, in order: lateral shift, edge loss, end-point error,
/// epipolar rejection, stereo mismatch, corner loss, corner mismatch. (The seventh of the memo,
/// calibration, acts on the rig that the estimator is told: see RigSampler.)
std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& settings,
                                                                 double min_length_px);

}  // namespace vernier::sim
