// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

#include "calib/camera.h"
#include "sim/sequence/segments_on_line.h"
#include "sim/sequence/sequence_samples.h"
#include "stereo/image/depth_image.h"

namespace vernier::sim::internal {

/// Range and angle of a line's middle and direction, in a view's camera frame.
SampleAt sample_at(int view,
                   const Eigen::Vector3d& middle_m,
                   const Eigen::Vector3d& direction,
                   double length_px);

/// Which segments of a view its neighbours confirm. A neighbour should show a segment if at least
/// 80 % of it lies in the image where, with a depth map, the depths agree, 10 px long or more, from
/// 0.7 to 1.43 times its distance; and confirms it if segments there run along 30 % of it. Asked
/// are the neighbours one by one, so that one depth map at a time is needed.
class Confirmations {
 public:
  Confirmations(const Camera& camera,
                std::span<const SequenceView> views,
                const SequenceOptions& options);

  /// What this view says of the segments of its neighbours.
  void look(int view, const std::optional<stereo::internal::DepthImage>& depth);
  /// Of the segments that two or more neighbours should show, but for those with edges on all
  /// sides.
  std::vector<ConfirmedSample> take() const;

 private:
  struct Votes {
    int asked = 0;
    bool confirmed = false;
    /// Whether one of them confirms it displaced so far, where it is not: edges that run beside
    /// each other do so in all neighbours alike.
    std::array<bool, std::size(displaced_px)> by_chance{};
  };

  Camera camera_;
  std::span<const SequenceView> views_;
  const SequenceOptions& options_;
  std::vector<std::vector<Votes>> votes_;
};

}  // namespace vernier::sim::internal
