// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Segments of one frame, carried by a known motion into a later one, beside those measured there:
// how often the difference of disparities, and of places across the line, is within 1.96 of its
// stated standard deviation, by range. `drive` of VERNIER_DATA (KITTI odometry). The rig has no
// covariance, so only errors of images and matcher are stated: what its calibration errs, and the
// given motion, counts against them. With `odometry` motions are Vernier's own, in the scale of the
// same calibration. Even frames may be used for tuning, odd ones judge.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/formats/kitti_calib.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"
#include "localise/odometry.h"
#include "localise/pair_corners.h"
#include "localise/trajectory.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"

namespace vernier::localise {
namespace {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Frame {
  std::vector<SegmentDisparity> segments;
  std::vector<StereoCorner> corners;
};

constexpr std::array bands_m{5.0, 10.0, 20.0, 40.0, 80.0};

/// Deviations in units of the stated standard deviation.
struct Deviations {
  std::vector<double> disparity, across;
};

/// The point of an end and the covariance of its pixel and disparity.
struct CarriedEnd {
  Vector2d px;
  double disparity_px = 0, range_m = 0;
  Eigen::Matrix3d covariance_px2;
};

/// An end of a segment (0 or 1) in the frame of a later camera.
std::optional<CarriedEnd> carried(const RectifiedGeometry& g,
                                  const SegmentDisparity& s,
                                  int end,
                                  const Pose& T_to_from) {
  const Vector2d px = end == 0 ? s.left_px.a_px : s.left_px.b_px;
  const double d = end == 0 ? s.a_disparity_px : s.b_disparity_px;
  if (!(d > 0.5)) return {};
  const double z = g.depth_m(d);
  const Vector2d xy = (px - g.centre_px) / g.f_px;
  const Vector3d p = T_to_from * Vector3d(z * xy.x(), z * xy.y(), z);
  if (!(p.z() > 2)) return {};
  Eigen::Matrix3d to_point, to_pixel;
  to_point << z / g.f_px, 0, -z * xy.x() / d, 0, z / g.f_px, -z * xy.y() / d, 0, 0, -z / d;
  to_pixel << g.f_px / p.z(), 0, -g.f_px * p.x() / (p.z() * p.z()), 0, g.f_px / p.z(),
      -g.f_px * p.y() / (p.z() * p.z()), 0, 0, -g.disparity_px(p.z()) / p.z();
  const Eigen::Matrix3d J = to_pixel * T_to_from.R * to_point;
  Eigen::Matrix3d C;
  const int at[3] = {2 * end, 2 * end + 1, 4 + end};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) C(i, j) = s.covariance_px2(at[i], at[j]);
  }
  return CarriedEnd{g.f_px / p.z() * p.head<2>() + g.centre_px, g.disparity_px(p.z()), p.z(),
                    J * C * J.transpose()};
}

/// The measured segment that looks like a carried one: nearly parallel, near, overlapping.
const SegmentDisparity* like(const Frame& frame, const Vector2d& a, const Vector2d& b) {
  const Vector2d t = (b - a).normalized(), n(-t.y(), t.x());
  const double length = (b - a).norm();
  const SegmentDisparity* best = nullptr;
  double least = 4;
  for (const SegmentDisparity& s : frame.segments) {
    if (s.status != SegmentStatus::placed) continue;
    const Vector2d own = (s.left_px.b_px - s.left_px.a_px).normalized();
    if (own.dot(t) < 0.995) continue;  // 5.7 deg; a to b has the brighter side on the right
    const double from = t.dot(s.left_px.a_px - a), to = t.dot(s.left_px.b_px - a);
    const double overlap = std::min(to, length) - std::max(from, 0.0);
    if (overlap < 0.6 * length || overlap < 0.6 * (to - from)) continue;
    const double off =
        std::max(std::abs(n.dot(s.left_px.a_px - a)), std::abs(n.dot(s.left_px.b_px - a)));
    if (off < least) {
      least = off;
      best = &s;
    }
  }
  return best;
}

/// Deviations at the middle of the overlap: both carried ends and both measured ones weigh in by
/// linear interpolation along the line, which keeps their joint covariance.
void compare(const RectifiedGeometry& g,
             const SegmentDisparity& s,
             const Pose& T_to_from,
             const Frame& frame,
             std::array<Deviations, bands_m.size()>& by_range) {
  const auto a = carried(g, s, 0, T_to_from), b = carried(g, s, 1, T_to_from);
  if (!a || !b || (b->px - a->px).norm() < 10) return;
  const SegmentDisparity* m = like(frame, a->px, b->px);
  if (!m) return;
  const Vector2d ab = m->left_px.b_px - m->left_px.a_px, t = ab.normalized(), n(-t.y(), t.x());
  for (const CarriedEnd* end : {&*a, &*b}) {
    const double u = (end->px - m->left_px.a_px).dot(ab) / ab.squaredNorm();
    if (u < -0.2 || u > 1.2) continue;
    // disparity of the measured line nearest to the carried end, and its derivative by sliding
    const double slope = (m->b_disparity_px - m->a_disparity_px) / ab.norm();
    const double there = (1 - u) * m->a_disparity_px + u * m->b_disparity_px;
    Eigen::Matrix<double, 1, 6> w, v;
    // an end that slides along the edge takes its disparity with it: both leave the line alone
    w << -(1 - u) * slope * t.transpose(), -u * slope * t.transpose(), 1 - u, u;
    v << (1 - u) * n.transpose(), u * n.transpose(), 0, 0;
    const Eigen::Vector3d c(-slope * t.x(), -slope * t.y(), 1);
    const Eigen::Vector3d e(n.x(), n.y(), 0);
    const double variance =
        c.dot(end->covariance_px2 * c) + (w * m->covariance_px2 * w.transpose())(0, 0);
    const double across2 =
        e.dot(end->covariance_px2 * e) + (v * m->covariance_px2 * v.transpose())(0, 0);
    std::size_t band = 0;
    while (band < bands_m.size() && end->range_m > bands_m[band]) ++band;
    if (band == bands_m.size()) continue;
    by_range[band].disparity.push_back((end->disparity_px - there) / std::sqrt(variance));
    by_range[band].across.push_back(n.dot(end->px - m->left_px.a_px) / std::sqrt(across2));
  }
}

double share_within(const std::vector<double>& z, double most) {
  const auto inside =
      std::count_if(z.begin(), z.end(), [&](double x) { return std::abs(x) <= most; });
  return 100.0 * static_cast<double>(inside) /
         static_cast<double>(std::max<std::size_t>(1, z.size()));
}

double middle(std::vector<double> z) {
  return z.empty() ? 0 : quantile(std::move(z), 0.5, QuantileKind::linear);
}

void report(const std::array<Deviations, bands_m.size()>& by_range) {
  fmt::print(
      "| range | ends | disparity within 1.96 | median z | beyond 6 | across within 1.96 | median "
      "z | beyond 6 |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  double from = 2;
  for (std::size_t i = 0; i < bands_m.size(); ++i) {
    const Deviations& d = by_range[i];
    fmt::print(
        "| {:g} to {:g} m | {} | {:.1f} % | {:+.2f} | {:.1f} % | {:.1f} % | {:+.2f} | {:.1f} % |\n",
        from, bands_m[i], d.disparity.size(), share_within(d.disparity, 1.96), middle(d.disparity),
        100 - share_within(d.disparity, 6), share_within(d.across, 1.96), middle(d.across),
        100 - share_within(d.across, 6));
    from = bands_m[i];
  }
}

/// Segments and corners of all frames.
struct Drive {
  RectifiedGeometry geometry;
  std::vector<Frame> frames;
  std::vector<Pose> known, odometry;  ///< left camera to the first one
};

Frame read_frame(const Rig& rig,
                 const RectifiedGeometry& geometry,
                 const GreyLevels& left,
                 const GreyLevels& right) {
  const RectifiedImages images = rectified_images(rig, geometry, left, right, 0);
  CannyOptions canny;
  canny.noise = images.pair.left_noise.per_pixel();
  const std::vector<EdgePoint> edges = canny_edges(images.pair.left, canny);
  const auto found = edge_matcher().match(images.pair, edges, {0, geometry.size_px[0] / 8});
  return {segment_disparities(edges, edge_segments(edges), found),
          corners_of_pair(rig, {}, left, right, {})};
}

Drive read_drive(const std::filesystem::path& folder) {
  Drive drive;
  Rig rig;
  std::vector<std::vector<StereoCorner>> moments;
  for (const TimedPose& pose : read_trajectory(folder / "poses.txt")) {
    const std::string name = fmt::format("{:06}.png", drive.known.size());
    const GreyLevels left = read_grey_levels(folder / "image_l" / name);
    if (drive.known.empty()) {
      ImportOptions options;
      options.size_px = Eigen::Vector2i(left.width_px, left.height_px);
      rig = read_kitti_calib(folder / "calib.txt", options).rig;
      drive.geometry = rectified_geometry(rig);
    }
    drive.known.push_back(pose.T_world_camera);
    drive.frames.push_back(
        read_frame(rig, drive.geometry, left, read_grey_levels(folder / "image_r" / name)));
    moments.push_back(drive.frames.back().corners);
  }
  drive.odometry = odometry_path(rig, moments).T_first_camera;
  return drive;
}

void judge(const Drive& drive, bool known, bool odd, std::size_t apart) {
  const std::vector<Pose>& path = known ? drive.known : drive.odometry;
  std::array<Deviations, bands_m.size()> by_range;
  for (std::size_t i = odd ? 1 : 0; i + apart < drive.frames.size(); i += 2) {
    const Pose T_to_from = path[i + apart].inverse() * path[i];
    for (const SegmentDisparity& s : drive.frames[i].segments) {
      if (s.status != SegmentStatus::placed) continue;
      compare(drive.geometry, s, T_to_from, drive.frames[i + apart], by_range);
    }
  }
  const double step_m = (path.back().t - path.front().t).norm() / double(path.size() - 1);
  fmt::print("\n{} motion, {} frames carried {:.1f} m\n\n", known ? "known" : "odometry's",
             odd ? "odd" : "even", step_m * double(apart));
  report(by_range);
  std::fflush(stdout);
}

int run() {
  const char* data = std::getenv("VERNIER_DATA");
  if (!data) {
    fmt::print(stderr, "carried_segments: VERNIER_DATA is not set\n");
    return 2;
  }
  const Drive drive = read_drive(std::filesystem::path(data) / "sequences" / "drive");
  for (const bool known : {true, false}) {
    for (const bool odd : {false, true}) {
      for (const std::size_t apart : {1, 5}) judge(drive, known, odd, apart);
    }
  }
  return 0;
}

}  // namespace
}  // namespace vernier::localise

int main() { return vernier::localise::run(); }
