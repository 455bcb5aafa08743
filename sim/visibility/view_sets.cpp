// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/view_sets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calib/camera.h"
#include "calib/pose.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

/// Length in the image of what two ascending lists of runs share, and of each.
struct SharedLength {
  double one = 0, other = 0, both = 0;
};

class ImageLength {
 public:
  ImageLength(const World& world, const Camera& camera, const Pose& T)
      : world_(world), camera_(camera), T_(T) {}

  double of(int segment, double t0, double t1) const {
    const WorldSegment& s = world_.segments[segment];
    const auto pixel = [&](double t) {
      return project(camera_, T_ * Eigen::Vector3d(s.a_m + t * (s.b_m - s.a_m)));
    };
    return t1 > t0 ? (pixel(t1) - pixel(t0)).norm() : 0;
  }
  double of(const VisibleInterval& run) const { return of(run.segment, run.t0, run.t1); }

 private:
  const World& world_;
  const Camera& camera_;
  const Pose& T_;
};

SharedLength shared_length(const std::vector<VisibleInterval>& one,
                           const std::vector<VisibleInterval>& other,
                           const ImageLength& length) {
  SharedLength sum;
  for (const VisibleInterval& run : one) sum.one += length.of(run);
  for (const VisibleInterval& run : other) sum.other += length.of(run);
  for (const VisibleInterval& a : one) {
    auto b = std::lower_bound(
        other.begin(), other.end(), a.segment,
        [](const VisibleInterval& run, int segment) { return run.segment < segment; });
    for (; b != other.end() && b->segment == a.segment; ++b) {
      sum.both += length.of(a.segment, std::max(a.t0, b->t0), std::min(a.t1, b->t1));
    }
  }
  return sum;
}

}  // namespace

const ViewSet* nearest_set(const std::vector<ViewSet>& sets, const Pose2D& pose) {
  const ViewSet* nearest = nullptr;
  double least = 0;
  for (const ViewSet& set : sets) {
    const double distance = std::hypot(set.at.x_m - pose.x_m, set.at.y_m - pose.y_m) / set_reach_m;
    const double angle =
        std::abs(std::remainder(set.at.heading_rad - pose.heading_rad, 2 * std::numbers::pi)) /
        set_reach_rad;
    if (distance > 1 || angle > 1) continue;
    const double far = distance * distance + angle * angle;
    if (nearest && far >= least) continue;
    nearest = &set;
    least = far;
  }
  return nearest;
}

std::vector<ViewSet> view_sets(const Visibility& visibility,
                               const Camera& camera,
                               const CameraMount& mount,
                               const std::vector<Pose2D>& poses,
                               double min_length_px) {
  VisibilityOptions options;
  options.min_length_px = min_length_px;
  std::vector<ViewSet> sets;
  for (const Pose2D& pose : poses) {
    ViewSet set{pose, {}};
    for (const VisibleInterval& run :
         visibility.visible_intervals(camera, T_left_world(pose, mount), options)) {
      if (set.segments.empty() || set.segments.back() != run.segment) {
        set.segments.push_back(run.segment);
      }
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

SetAgreement set_agreement(const World& world,
                           const Camera& camera,
                           const CameraMount& mount,
                           const std::vector<Pose2D>& poses) {
  const Visibility exact(world), by_sets(world, VisibilityMethod::view_sets);
  SharedLength sum;
  SetAgreement result;
  for (const Pose2D& pose : poses) {
    if (!nearest_set(world.view_sets, pose)) {
      result.without_set += 1.0 / static_cast<double>(poses.size());
      continue;
    }
    const Pose T = T_left_world(pose, mount);
    const SharedLength here =
        shared_length(by_sets.visible_intervals(camera, T), exact.visible_intervals(camera, T),
                      ImageLength(world, camera, T));
    sum.one += here.one;
    sum.other += here.other;
    sum.both += here.both;
  }
  if (sum.one > 0) result.precision = sum.both / sum.one;
  if (sum.other > 0) result.recall = sum.both / sum.other;
  return result;
}

}  // namespace vernier::sim::internal
