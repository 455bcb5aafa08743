// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim {

/// The measurements that an estimator gets, with the ground truth for scoring only.
struct StereoObservation {
  std::vector<stereo::StereoSegment> segments;
  /// One per segment; some may be false (VisibleEdge::is_false), which nothing in the world
  /// explains.
  std::vector<VisibleEdge> true_edges;
  /// Lines of the left image without a partner in the right one: those along epipolar lines.
  std::vector<stereo::ImageSegment> left_only;
  std::vector<SensedCorner> corners;
  std::string failure;  ///< why a source of one's own failed; the view is then worth nothing
};

/// Where in an experiment a look stands: with it every draw has its place.
struct SensingDraw {
  std::uint64_t seed = 1;
  std::uint32_t trial = 0;
  std::uint32_t frame = 0;  ///< of the trial
};

/// Told after each source what it has left of the view.
using AfterSource = std::function<void(const UncertaintySource& source, const SensedView& view)>;

/// The true rig observing the world through all enabled error sources.
class Sensor {
 public:
  /// Throws Error for settings or a length out of range or a rig without exactly two cameras.
  Sensor(const Rig& true_rig, const SourceSettings& settings, double min_length_px = 10);

  /// The same look and draw give the same observation to the bit.
  StereoObservation sense(const NoiseFreeView& look,
                          const SensingDraw& draw = {},
                          const AfterSource& after = {}) const;

  const Rig& rig() const { return rig_; }

 private:
  Rig rig_;
  stereo::Rectification rectification_;
  std::vector<std::unique_ptr<UncertaintySource>> sources_;
};

}  // namespace vernier::sim
