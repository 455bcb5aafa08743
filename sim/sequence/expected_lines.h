// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "localise/join/line_fit.h"
#include "localise/joined_lines.h"
#include "sim/sequence/line_in_view.h"
#include "sim/sequence/sequence_samples.h"

namespace vernier::sim::internal {

/// A line as all views but one know it: fitted to their segments, and the stretches, as stations
/// (localise/join/line_fit.h), that enough of them saw.
struct KnownLine {
  localise::internal::FittedLine fit;
  std::vector<std::pair<double, double>> seen_m;  ///< ascending, disjoint

  bool seen_at(double station_m) const;
  Eigen::Vector3d at(double station_m) const {
    return fit.frame.origin_m + station_m * fit.frame.axes.col(2);
  }
  /// Variance across the image of the point at a station, or of the difference of two, px².
  double across_px2(const PlacedCamera& camera,
                    const Eigen::Vector2d& across,
                    double station_m,
                    std::optional<double> less_station_m = {}) const;
};

/// The lines of a sequence.
class ExpectedLines {
 public:
  ExpectedLines(std::span<const SequenceView> views, const SequenceOptions& options);

  const localise::JoinedLines& joined() const { return joined_; }
  /// Whether enough views saw the line.
  bool is_known(int line) const;
  /// Whether views before and after one, and near it, saw the line.
  bool is_bracketed(int line, int view) const;
  /// Nothing if too few other views saw it. A stretch that enough of them saw begins at the median
  /// of their ends within `near_m` of the outermost that counts: else it would begin too early.
  std::optional<KnownLine> without(int line, int view, double near_m) const;
  /// A segment with its covariance, which holds errors of the pose.
  localise::internal::WorldSighting sighting(int view, int segment) const;

 private:
  std::span<const SequenceView> views_;
  const SequenceOptions& options_;
  localise::JoinedLines joined_;
};

/// The station, along a line of this origin and direction, nearest to a ray.
double station_of_ray(const Eigen::Vector3d& origin_m,
                      const Eigen::Vector3d& direction,
                      const Eigen::Vector3d& eye_m,
                      const Eigen::Vector3d& ray);

/// A camera at the pose of a view. Throws Error unless it is a pinhole.
PlacedCamera placed_camera(const Camera& camera, const Pose& T_world_camera);

}  // namespace vernier::sim::internal
