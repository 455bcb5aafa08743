// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Stereo odometry beside the pipeline that OpenCV's functions give, on KITTI's frames in
// VERNIER_DATA: both from the same images to a trajectory; CPU time of a step, images read. The
// counters are the drift over segments of 10 m and the error of the end.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/pair_corners.h"
#include "localise/trajectory.h"
#include "stereo/grey_levels.h"

namespace vernier::localise {
namespace {

constexpr double f_px = 707.0912, u0_px = 601.8873, v0_px = 183.1104;
constexpr double baseline_m = 379.8145 / f_px;

struct Frames {
  std::vector<stereo::GreyLevels> left, right;
  std::vector<Pose> T_first_left;
};

const Frames* frames() {
  static const std::optional<Frames> read = []() -> std::optional<Frames> {
    const char* data = std::getenv("VERNIER_DATA");
    if (!data) return std::nullopt;
    const auto folder = std::filesystem::path(data) / "sequences" / "drive";
    Frames frames;
    for (const TimedPose& pose : read_trajectory(folder / "poses.txt")) {
      const std::string name = fmt::format("{:06}.png", frames.left.size());
      frames.T_first_left.push_back(pose.T_world_camera);
      frames.left.push_back(stereo::read_grey_levels(folder / "image_l" / name));
      frames.right.push_back(stereo::read_grey_levels(folder / "image_r" / name));
    }
    return frames;
  }();
  return read ? &*read : nullptr;
}

Camera camera_of_drive(const char* name) {
  Camera camera;
  camera.name = name;
  camera.model = Pinhole{};
  camera.size_px = {1226, 370};
  camera.parameters.resize(core_parameter_count);
  camera.parameters << f_px, 1, u0_px, v0_px;
  return camera;
}

Rig rig_of_drive() {
  Rig rig;
  rig.cameras = {camera_of_drive("left"), camera_of_drive("right")};
  rig.T_camera_first = {Pose{}, {Eigen::Matrix3d::Identity(), {-baseline_m, 0, 0}}};
  return rig;
}

void count(benchmark::State& state, const std::vector<Pose>& path, const Frames& frames) {
  const TrajectoryDrift drift = drift_of(path, frames.T_first_left, 10);
  state.counters["drift_percent"] = 100 * drift.translation_share;
  state.counters["drift_deg_per_m"] = drift.rotation_rad_per_m * 180 / std::numbers::pi;
  state.counters["end_m"] = drift.end_error_m;
  state.counters["steps"] = static_cast<double>(path.size() - 1);
}

void odometry(benchmark::State& state) {
  const Frames* all = frames();
  if (!all) return state.SkipWithError("VERNIER_DATA is not set");
  const Rig rig = rig_of_drive();
  PairCornersOptions how;
  how.nearest_m = 2;
  std::vector<Pose> path;
  for (auto _ : state) {
    std::vector<std::vector<StereoCorner>> moments;
    for (std::size_t i = 0; i < all->left.size(); ++i) {
      moments.push_back(corners_of_pair(rig, {}, all->left[i], all->right[i], how));
    }
    path = odometry_path(rig, moments).T_first_camera;
  }
  count(state, path, *all);
}
BENCHMARK(odometry)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

cv::Mat image_of(const stereo::GreyLevels& grey) {
  cv::Mat image(grey.height_px, grey.width_px, CV_8U);
  for (int v = 0; v < grey.height_px; ++v) {
    for (int u = 0; u < grey.width_px; ++u) {
      image.at<unsigned char>(v, u) = cv::saturate_cast<unsigned char>(grey(u, v));
    }
  }
  return image;
}

/// What a user of OpenCV writes: depth by semi-global matching, corners tracked by Lucas and
/// Kanade, the motion by PnP with RANSAC.
Pose opencv_step(cv::StereoSGBM& matcher,
                 const cv::Mat& left,
                 const cv::Mat& right,
                 const cv::Mat& next) {
  cv::Mat disparity;
  matcher.compute(left, right, disparity);
  std::vector<cv::Point2f> corners, tracked;
  cv::goodFeaturesToTrack(left, corners, 1200, 0.01, 7);
  std::vector<uchar> is_tracked;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(left, next, corners, tracked, is_tracked, error, {21, 21}, 4);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int u = cvRound(corners[i].x), v = cvRound(corners[i].y);
    if (!is_tracked[i] || u < 0 || v < 0 || u >= left.cols || v >= left.rows) continue;
    constexpr double fixed_point = 16, least_px = 1;
    const double d = disparity.at<short>(v, u) / fixed_point;
    if (d <= least_px) continue;
    const double z = f_px * baseline_m / d;
    points.emplace_back((corners[i].x - u0_px) * z / f_px, (corners[i].y - v0_px) * z / f_px, z);
    pixels.emplace_back(tracked[i]);
  }
  const cv::Matx33d K(f_px, 0, u0_px, 0, f_px, v0_px, 0, 0, 1);
  cv::Mat rotation, translation;
  std::vector<int> inliers;
  cv::solvePnPRansac(points, pixels, K, cv::noArray(), rotation, translation, false, 500, 1.0F,
                     0.999, inliers, cv::SOLVEPNP_ITERATIVE);
  const auto vector = [](const cv::Mat& m) {
    return Eigen::Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
  };
  return Pose{rotation_from_vector(vector(rotation)), vector(translation)}.inverse();
}

void opencv_odometry(benchmark::State& state) {
  const Frames* all = frames();
  if (!all) return state.SkipWithError("VERNIER_DATA is not set");
  std::vector<cv::Mat> left, right;
  for (std::size_t i = 0; i < all->left.size(); ++i) {
    left.push_back(image_of(all->left[i]));
    right.push_back(image_of(all->right[i]));
  }
  cv::setNumThreads(1);
  constexpr int disparities = 96, block = 7, p1 = 8 * block * block, p2 = 4 * p1;
  const auto matcher = cv::StereoSGBM::create(0, disparities, block, p1, p2, 1, 63, 10, 100, 2);
  std::vector<Pose> path;
  for (auto _ : state) {
    path = {Pose{}};
    for (std::size_t i = 0; i + 1 < left.size(); ++i) {
      path.push_back(path.back() * opencv_step(*matcher, left[i], right[i], left[i + 1]));
    }
  }
  count(state, path, *all);
}
BENCHMARK(opencv_odometry)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace vernier::localise
