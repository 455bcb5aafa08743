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

/// An edge passing through the error sources: its true ends, and the displacement of each end in
/// each camera. Ends are projected on demand, so that the ends of a cut piece lie exactly on the
/// edge, for any lens.
struct SensedEdge {
  VisibleEdge truth;
  std::array<std::array<Eigen::Vector2d, 2>, 2> offset_px{};  ///< [eye][end]
  std::uint32_t piece = 0;  ///< index of the part left by an edge-loss gap
  bool in_stereo = true;    ///< false: seen by the left camera only, as far as stereo can tell

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

/// One source of geometric error. Sources act in a fixed order on the noise-free view of the true
/// rig; each draws from its own stream, keyed by the feature it acts on, so that enabling or
/// disabling one does not change the draws of the others.
class UncertaintySource {
 public:
  virtual ~UncertaintySource() = default;
  virtual std::string_view name() const = 0;
  virtual void apply(const SensingContext& context, SensedView& view) const = 0;
};

/// The sources enabled by these settings, in order: lateral shift, edge loss, end-point error,
/// epipolar rejection, stereo mismatch, corner loss, corner error, corner mismatch. (The memo's
/// seventh source, calibration, acts on the rig assumed by the estimator: see RigSampler.)
std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& settings,
                                                                 double min_length_px);

}  // namespace vernier::sim
