// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "injected_scenes.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calib/camera.h"
#include "calib/estimate/resized_rig.h"
#include "calib/formats/asl_sensor.h"
#include "calib/formats/kitti_calib.h"
#include "localise/trajectory.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/rectification.h"
#include "stereo/stereo_truth.h"

namespace vernier::bench {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double nearest_m = 1, farthest_m = 25;

/// Lines of the given rig between the nearest and the farthest that are judged.
std::vector<PlacedLine> judged(std::vector<PlacedLine> lines) {
  std::erase_if(lines, [](const PlacedLine& line) {
    const double a = line.a_m.z(), b = line.b_m.z();
    return !(std::min(a, b) > nearest_m && std::max(a, b) < farthest_m);
  });
  return lines;
}

RawPair read_pair(const std::filesystem::path& left, const std::filesystem::path& right) {
  RawPair pair{read_grey_levels(left), read_grey_levels(right), {}};
  pair.range = {0, pair.left.width_px / 8};
  return pair;
}

/// Segments of the left image where the truth has them: the line through the true disparities of
/// their points.
std::vector<PlacedLine> true_lines(const GreyLevels& left,
                                   const StereoTruth& truth,
                                   const RectifiedGeometry& g) {
  const std::vector<EdgePoint> edges = canny_edges(left);
  const std::vector<TruthAtEdge> at = truth_at(truth, edges);
  std::vector<PlacedLine> lines;
  for (const EdgeSegment& segment : edge_segments(edges)) {
    const ImageSegment px = segment.segment;
    const Vector2d t = (px.b_px - px.a_px).normalized();
    if (px.length_px() < 10 || std::abs(t.y()) < 0.0872) continue;
    Eigen::Matrix2d N = Eigen::Matrix2d::Zero();
    Vector2d b = Vector2d::Zero();
    int known = 0;
    double worst = 0;
    std::vector<Vector2d> samples;
    for (const int i : segment.points) {
      const TruthAtEdge& x = at[std::size_t(i)];
      if (!x.known || x.own_occluded || x.discontinuity || !(x.own_px > 0.5F)) continue;
      const double s = t.dot(edges[std::size_t(i)].pixel_px.cast<double>() - px.a_px);
      samples.emplace_back(s, x.own_px);
      N += Vector2d(1, s) * Vector2d(1, s).transpose();
      b += x.own_px * Vector2d(1, s);
      ++known;
    }
    if (known < 8 || 2 * known < int(segment.points.size())) continue;
    const Vector2d line = N.ldlt().solve(b);
    for (const Vector2d& s : samples)
      worst = std::max(worst, std::abs(line[0] + line[1] * s[0] - s[1]));
    if (worst > 1) continue;
    const auto point = [&](const Vector2d& end, double s) -> Vector3d {
      const double z = g.depth_m(line[0] + line[1] * s);
      const Vector2d xy = z / g.f_px * (end - g.centre_px);
      return {xy.x(), xy.y(), z};
    };
    if (!(line[0] > 0.5) || !(line[0] + line[1] * px.length_px() > 0.5)) continue;
    lines.push_back({px, point(px.a_px, 0), point(px.b_px, px.length_px())});
  }
  return lines;
}

}  // namespace

Scene still_room(const std::filesystem::path& folder, const RigEstimate& calibrated) {
  Scene scene;
  scene.estimate = with_covariance_of(
      read_asl_sensors({folder / "left.yaml", folder / "right.yaml"}).rig, calibrated);
  std::vector<std::filesystem::path> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "left"))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  for (const std::size_t i : {1u, 9u}) {
    Sight sight{read_pair(folder / "left" / names[i], folder / "right" / names[i]), {}};
    sight.lines = judged(reconstructed(scene.estimate.rig, sight.images, sight.images.range));
    scene.sights.push_back(std::move(sight));
  }
  return scene;
}

Scene drive(const std::filesystem::path& folder, const RigEstimate& calibrated) {
  constexpr std::size_t apart = 5;
  const std::vector<localise::TimedPose> path = localise::read_trajectory(folder / "poses.txt");
  Scene scene;
  for (const std::size_t from : {9u, 33u}) {
    for (const std::size_t i : {from, from + apart}) {
      const std::string name = fmt::format("{:06}.png", i);
      Sight sight{read_pair(folder / "image_l" / name, folder / "image_r" / name), {}};
      if (scene.sights.empty()) {
        ImportOptions options;
        options.size_px = Eigen::Vector2i(sight.images.left.width_px, sight.images.left.height_px);
        scene.estimate =
            with_covariance_of(read_kitti_calib(folder / "calib.txt", options).rig, calibrated);
      }
      sight.lines = judged(reconstructed(scene.estimate.rig, sight.images, sight.images.range));
      scene.sights.push_back(std::move(sight));
    }
    const std::size_t later = scene.sights.size() - 1, first = later - 1;
    const Pose T = path[from + apart].T_world_camera.inverse() * path[from].T_world_camera;
    const std::vector<PlacedLine>& seen = scene.sights[later].lines;
    for (std::size_t k = 0; k < scene.sights[first].lines.size(); ++k) {
      const PlacedLine& line = scene.sights[first].lines[k];
      const Vector3d a = T * line.a_m, b = T * line.b_m;
      if (std::min(a.z(), b.z()) < nearest_m) continue;
      const Camera& camera = scene.estimate.rig.cameras[0];
      const PlacedLine* same = like(seen, {project(camera, a), project(camera, b)}, 4);
      if (same) scene.links.push_back({first, k, later, std::size_t(same - seen.data()), T});
    }
  }
  return scene;
}

std::vector<Scene> pairs(const std::filesystem::path& list, const RigEstimate& calibrated) {
  std::vector<Scene> scenes;
  for (const StereoSceneFile& file : read_stereo_scenes(list)) {
    Scene scene;
    scene.against_truth = true;
    Sight sight{{read_grey_levels(file.left), read_grey_levels(file.right), file.range}, {}};
    const Eigen::Vector2i size(sight.images.left.width_px, sight.images.left.height_px);
    const Rig like = resized(calibrated, size).rig;
    const RectifiedGeometry g = rectified_geometry(like, {.f_px = like.cameras[0].f_px()});
    const Rig rig = rectified_rig(like, g);
    scene.estimate = with_covariance_of(rig, calibrated);
    sight.lines = true_lines(sight.images.left, read_stereo_truth(file, size[0], size[1]),
                             rectified_geometry(rig));
    scene.sights.push_back(std::move(sight));
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

}  // namespace vernier::bench
