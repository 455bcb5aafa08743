// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/camera_path.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/formats/colmap_poses.h"
#include "calib/statistics/quantile.h"
#include "sim/import/mesh.h"
#include "sim/world.h"
#include "sim/world/plan_distance.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double gap_m = 3, shortest_step_m = 0.1, off_way_m = 0.05;
constexpr double upright_cosine = 0.966;  // 15 degrees

Vector2d rounded(const Vector2d& x) { return (x * 1e4).array().round() / 1e4; }

// Runs of digits are compared as numbers: 2.jpg comes before 10.jpg.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[k])) {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i;
      ++k;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (k < b.size() && b[k] == '0') ++k;
    std::size_t i_end = i, k_end = k;
    while (i_end < a.size() && is_digit(a[i_end])) ++i_end;
    while (k_end < b.size() && is_digit(b[k_end])) ++k_end;
    if (i_end - i != k_end - k) return i_end - i < k_end - k;
    const int order = a.compare(i, i_end - i, b, k, k_end - k);
    if (order != 0) return order < 0;
    i = i_end;
    k = k_end;
  }
  if (i < a.size() || k < b.size()) return k < b.size();
  return a < b;
}

// Keeps what is further than off_way_m from the line between two kept points, without recursion:
// paths may be long.
std::vector<Vector2d> simplified(const std::vector<Vector2d>& points) {
  std::vector<bool> kept(points.size());
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    double furthest = off_way_m;
    std::size_t at = 0;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double off = plan_distance(points[i], points[from], points[to]);
      if (off > furthest) {
        furthest = off;
        at = i;
      }
    }
    if (at == 0) continue;
    kept[at] = true;
    open.emplace_back(from, at);
    open.emplace_back(at, to);
  }
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i]) result.push_back(points[i]);
  }
  return result;
}

}  // namespace

std::vector<PathCamera> read_camera_path(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "images.txt";
  std::error_code fault;
  if (!std::filesystem::exists(file, fault)) {
    const bool binary = std::filesystem::exists(folder / "images.bin", fault);
    throw Error(file.string(),
                binary ? "no such file; the model is in binary form" : "no such file",
                binary ? "write it as text: colmap model_converter --output_type TXT"
                       : "give the folder of a COLMAP model");
  }
  std::vector<PathCamera> cameras;
  for (const colmap::Line& line : colmap::read_lines(file, true)) {
    if (line.size() < 10) line.check_count(10);
    cameras.push_back({line.word(9), colmap::pose(line, 1, 1)});
  }
  if (cameras.empty()) throw Error(file.string(), "holds no images", "give a model with images");
  std::stable_sort(cameras.begin(), cameras.end(), [](const PathCamera& a, const PathCamera& b) {
    return comes_before(a.name, b.name);
  });
  return cameras;
}

Vector3d up_of(const std::vector<PathCamera>& cameras, const Mesh& mesh, const std::string& place) {
  Vector3d up = Vector3d::Zero();
  for (const PathCamera& camera : cameras) {
    up -= camera.T_camera_world.R.row(1).transpose() / static_cast<double>(cameras.size());
  }
  if (!(up.norm() > 0.5)) {
    throw Error(place, "its cameras do not say which way is up", "level the model first");
  }
  up.normalize();
  Vector3d lines = Vector3d::Zero();
  for (const auto& [a, b] : mesh.lines) {
    const Vector3d d = mesh.vertices[b] - mesh.vertices[a];
    const double along = d.dot(up);
    if (std::abs(along) > upright_cosine * d.norm()) lines += along < 0 ? Vector3d(-d) : d;
  }
  return lines.norm() > 0 ? lines.normalized() : up;
}

void level(const Vector3d& up, Mesh& mesh, std::vector<PathCamera>& cameras) {
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).toRotationMatrix();
  for (Vector3d& v : mesh.vertices) v = R * v;
  for (PathCamera& camera : cameras)
    camera.T_camera_world.R = camera.T_camera_world.R * R.transpose();
  mesh.up_axis = 2;
}

double median_height(const std::vector<PathCamera>& cameras) {
  std::vector<double> heights;
  for (const PathCamera& camera : cameras) {
    heights.push_back(camera.T_camera_world.inverse().t.z());
  }
  return quantile(std::move(heights), 0.5, QuantileKind::linear);
}

std::vector<RouteLeg> route_of(const std::vector<PathCamera>& cameras,
                               double unit_m,
                               const Vector2d& origin_m) {
  std::vector<std::vector<Vector2d>> ways;
  for (const PathCamera& camera : cameras) {
    const Vector2d at = unit_m * camera.T_camera_world.inverse().t.head<2>() - origin_m;
    if (ways.empty() || (ways.back().back() - at).norm() > gap_m) ways.emplace_back();
    std::vector<Vector2d>& way = ways.back();
    if (way.empty() || (way.back() - at).norm() >= shortest_step_m) way.push_back(at);
  }
  std::vector<RouteLeg> route;
  for (const std::vector<Vector2d>& way : ways) {
    if (way.size() < 2) continue;
    RouteLeg leg;
    for (const Vector2d& point : simplified(way)) leg.points_m.push_back(rounded(point));
    route.push_back(std::move(leg));
  }
  return route;
}

}  // namespace vernier::sim::internal
