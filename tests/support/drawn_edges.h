// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/edges/image_edges.h"
#include "stereo/segment.h"
#include "stereo/stereo_truth.h"

namespace vernier::test {

using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

/// A rectified pair of pinholes before a slanted plane: the truth of its disparities is exact.
struct PlaneBeforePair {
  int width_px = 640, height_px = 480;
  double f_px = 500, baseline_m = 0.1;
  Eigen::Vector3d normal{0.1, -0.08, 0.5};  ///< of the plane nᵀX = 1, metres

  Rig rig() const {
    Rig pair;
    for (int i = 0; i < 2; ++i) {
      Camera camera;
      camera.name = i == 0 ? "left" : "right";
      camera.model = Pinhole{};
      camera.size_px = {width_px, height_px};
      camera.parameters = Eigen::Vector4d(f_px, 1, 0.5 * (width_px - 1), 0.5 * (height_px - 1));
      pair.cameras.push_back(camera);
    }
    pair.T_camera_first = {Pose{}, Pose{Eigen::Matrix3d::Identity(), {-baseline_m, 0, 0}}};
    return pair;
  }

  Eigen::Vector3d ray(const Eigen::Vector2d& left_px) const {
    return {(left_px.x() - 0.5 * (width_px - 1)) / f_px,
            (left_px.y() - 0.5 * (height_px - 1)) / f_px, 1};
  }
  Eigen::Vector3d point(const Eigen::Vector2d& left_px) const {
    return ray(left_px) / normal.dot(ray(left_px));
  }
  double disparity_px(const Eigen::Vector2d& left_px) const {
    return f_px * baseline_m * normal.dot(ray(left_px));
  }

  StereoTruth truth() const {
    DisparityMap map{width_px, height_px, {}};
    for (int y = 0; y < height_px; ++y) {
      for (int x = 0; x < width_px; ++x) {
        map.values.push_back(static_cast<float>(disparity_px(Eigen::Vector2d(x, y))));
      }
    }
    return stereo_truth(map);
  }

  /// One edge of 26 to 34 px, any way round, and one corner in each square of 50 px.
  NoiseFreeView look(std::uint32_t frame) const {
    RandomStream draws({.seed = 77, .frame = frame});
    NoiseFreeView seen;
    std::uint32_t feature = 1000 * frame;
    for (int y = 30; y + 30 < height_px; y += 50) {
      for (int x = 80; x + 30 < width_px; x += 50) {
        const Eigen::Vector2d centre{x + draws.uniform(-2, 2), y + draws.uniform(-2, 2)};
        const double angle = draws.uniform(0, 2 * M_PI);
        const Eigen::Vector2d half =
            0.5 * draws.uniform(26, 34) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        VisibleEdge edge;
        edge.a_m = point(centre - half);
        edge.b_m = point(centre + half);
        edge.segment = static_cast<int>(++feature);
        edge.feature = feature;
        edge.object_centre_m = {0, 0, 2};
        seen.edges.push_back(edge);
        seen.corners.push_back({point(centre), feature});
      }
    }
    return seen;
  }
};

/// What Canny and the growing of segments would make of straight lines: a point a row, or a column
/// where they are flatter, with white noise across. From a to b the brighter side is on the right.
inline ImageEdges drawn_edges(const std::vector<ImageSegment>& lines,
                              const PlaneBeforePair& plane,
                              double noise_px,
                              RandomStream& draws) {
  ImageEdges edges{plane.width_px, plane.height_px, {}, {}};
  for (const ImageSegment& line : lines) {
    const Eigen::Vector2d along = (line.b_px - line.a_px).normalized();
    const Eigen::Vector2d normal(-along.y(), along.x());
    EdgeSegment segment;
    segment.segment = line;
    segment.a_is_corner = segment.b_is_corner = true;
    segment.a_covariance_px2 = segment.b_covariance_px2 = Eigen::Matrix2d::Identity();
    const int axis = std::abs(along.y()) >= std::abs(along.x()) ? 1 : 0;
    const int begin = static_cast<int>(std::ceil(std::min(line.a_px[axis], line.b_px[axis])));
    const int end = static_cast<int>(std::floor(std::max(line.a_px[axis], line.b_px[axis])));
    for (int k = begin; k <= end; ++k) {
      const Eigen::Vector2d crossing = line.a_px + (k - line.a_px[axis]) / along[axis] * along;
      EdgePoint point;
      point.x = static_cast<int>(std::lround(crossing.x()));
      point.y = static_cast<int>(std::lround(crossing.y()));
      point.string = static_cast<int>(edges.segments.size());
      const Eigen::Vector2d centre(point.x, point.y);
      const Eigen::Vector2d place =
          centre + normal * (normal.dot(line.a_px - centre) + noise_px * draws.normal());
      point.pixel_px = place.cast<float>();
      point.normal = normal.cast<float>();
      point.row_x_px = static_cast<float>(axis == 1 ? crossing.x() : place.x());
      segment.points.push_back(static_cast<int>(edges.points.size()));
      edges.points.push_back(point);
    }
    if (along[axis] < 0) std::reverse(segment.points.begin(), segment.points.end());
    if (!segment.points.empty()) edges.segments.push_back(segment);
  }
  std::vector<int> order(edges.points.size()), place(edges.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    const EdgePoint &p = edges.points[a], &q = edges.points[b];
    return p.y < q.y || (p.y == q.y && p.x < q.x);
  });
  std::vector<EdgePoint> sorted;
  for (const int i : order) {
    place[i] = static_cast<int>(sorted.size());
    sorted.push_back(edges.points[i]);
  }
  edges.points = std::move(sorted);
  for (EdgeSegment& segment : edges.segments) {
    for (int& point : segment.points) point = place[point];
  }
  return edges;
}

/// The lines that one eye senses.
inline std::vector<ImageSegment> lines_of(const StereoObservation& sighting, bool left) {
  std::vector<ImageSegment> lines;
  for (const StereoSegment& s : sighting.segments) lines.push_back(left ? s.left : s.right);
  return lines;
}

}  // namespace vernier::test
