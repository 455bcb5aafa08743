// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/warped_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "calib/base/ordered_parallel.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/image/resampled_image.h"
#include "stereo/matching/map_window.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

bool is_of_size(const GreyLevels& image, const Eigen::Vector2i& size_px) {
  return image.width_px == size_px[0] && image.height_px == size_px[1];
}

void check_sizes(const RectifiedPair& pair,
                 const StereoTruth& truth,
                 const Eigen::Vector2i& size_px) {
  const DisparityMap& map = truth.disparity;
  if (is_of_size(pair.left, size_px) && is_of_size(pair.right, size_px) &&
      map.width_px == size_px[0] && map.height_px == size_px[1]) {
    return;
  }
  throw Error(
      "warped pair",
      fmt::format("the left image is {}x{}, the right one {}x{}, the truth {}x{} and the "
                  "rig rectifies to {}x{} px",
                  pair.left.width_px, pair.left.height_px, pair.right.width_px,
                  pair.right.height_px, map.width_px, map.height_px, size_px[0], size_px[1]),
      "use the rig that the pair was rectified with");
}

DisparityMap map_of_unknown(int width_px, int height_px) {
  return {width_px, height_px,
          std::vector<float>(
              static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), unknown)};
}

/// Bilinear between the four pixels around a position if all are known and on one surface; else the
/// nearest.
float disparity_between(const DisparityMap& map, const Eigen::Vector2d& at) {
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  const int near_x = static_cast<int>(std::lround(at.x()));
  const int near_y = static_cast<int>(std::lround(at.y()));
  if (near_x < 0 || near_y < 0 || near_x >= map.width_px || near_y >= map.height_px) return unknown;
  if (x < 0 || y < 0 || x + 1 >= map.width_px || y + 1 >= map.height_px) return map(near_x, near_y);
  const float a = map(x, y), b = map(x + 1, y), c = map(x, y + 1), d = map(x + 1, y + 1);
  const auto [least, most] = std::minmax({a, b, c, d});
  if (!(std::isfinite(a + b + c + d) && most - least <= step_px)) return map(near_x, near_y);
  const auto s = static_cast<float>(at.x() - x), t = static_cast<float>(at.y() - y);
  return (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d);
}

/// Both rectifications of one raw pair, and the mapping between them.
struct Detour {
  const Rig &believed, &true_rig;
  RectifiedGeometry given, drawn;
  RawPixels drawn_left, drawn_right, given_right;

  Detour(const Rig& b, const Rig& t, const RectifiedGeometry& g)
      : believed(b),
        true_rig(t),
        given(g),
        drawn(of_believed(b, g)),
        drawn_left(b, drawn, 0),
        drawn_right(b, drawn, 1),
        given_right(t, g, 1) {}

  static RectifiedGeometry of_believed(const Rig& believed, RectifiedGeometry geometry) {
    geometry.turn = rectification(believed);
    geometry.baseline_m = believed.T_camera_first[1].t.norm();
    return geometry;
  }

  std::optional<Eigen::Vector2d> back(int camera, int x, int y) const {
    const Eigen::Vector2d at(x, y);
    const auto raw = (camera == 0 ? drawn_left : drawn_right).at(at);
    return raw ? rectified_pixel(true_rig, given, camera, *raw) : std::nullopt;
  }

  std::optional<Eigen::Vector2d> right_forward(const Eigen::Vector2d& given_px) const {
    const auto raw = given_right.at(given_px);
    return raw ? rectified_pixel(believed, drawn, 1, *raw) : std::nullopt;
  }
};

void warp_truth(const Detour& detour, const StereoTruth& truth, int y, WarpedPair& warped) {
  const int width = truth.disparity.width_px, height = truth.disparity.height_px;
  for (int x = 0; x < width; ++x) {
    const auto from = detour.back(0, x, y);
    if (!from) continue;
    const float disparity = disparity_between(truth.disparity, *from);
    if (std::isnan(disparity)) continue;
    const auto right = detour.right_forward(*from - Eigen::Vector2d(disparity, 0));
    if (!right) continue;
    const auto i =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    const auto source =
        static_cast<std::size_t>(std::lround(from->y())) * static_cast<std::size_t>(width) +
        static_cast<std::size_t>(std::lround(from->x()));
    const bool outside =
        right->x() < 0 || right->y() < 0 || right->x() > width - 1 || right->y() > height - 1;
    warped.truth.disparity.values[i] = static_cast<float>(x - right->x());
    warped.truth.occluded[i] = truth.occluded[source] != 0 || outside;
    warped.vertical_px.values[i] = static_cast<float>(y - right->y());
    warped.bias_px.values[i] = warped.truth.disparity.values[i] - disparity;
  }
}

}  // namespace

WarpedPair rectified_by(const Rig& believed,
                        const Rig& true_rig,
                        const RectifiedGeometry& geometry,
                        const RectifiedPair& pair,
                        const StereoTruth& truth,
                        int threads) {
  check_sizes(pair, truth, geometry.size_px);
  const Detour detour(believed, true_rig, geometry);
  const int width = geometry.size_px[0], height = geometry.size_px[1];
  WarpedPair warped;
  const auto back = [&](int camera) {
    return [&detour, camera](int x, int y) { return detour.back(camera, x, y); };
  };
  warped.pair.left = resampled(pair.left, geometry.size_px, back(0), threads);
  warped.pair.right = resampled(pair.right, geometry.size_px, back(1), threads);
  warped.truth.disparity = warped.vertical_px = warped.bias_px = map_of_unknown(width, height);
  warped.truth.occluded.assign(truth.occluded.size(), 0);
  warped.truth.sparse = truth.sparse;
  for_each_index(static_cast<std::size_t>(height), threads,
                 [&](std::size_t y) { warp_truth(detour, truth, static_cast<int>(y), warped); });
  return warped;
}

WarpedPair with_shifted_rows(const RectifiedPair& pair, const StereoTruth& truth, double lower_px) {
  check_sizes(pair, truth, {pair.left.width_px, pair.left.height_px});
  WarpedPair warped{pair, truth, truth.disparity, truth.disparity};
  const auto above = [&](int x, int y) {
    return std::optional<Eigen::Vector2d>({static_cast<double>(x), y - lower_px});
  };
  warped.pair.right = resampled(pair.right, {pair.right.width_px, pair.right.height_px}, above, 1);
  const auto width = static_cast<std::size_t>(pair.left.width_px);
  for (std::size_t i = 0; i < truth.disparity.values.size(); ++i) {
    if (std::isnan(truth.disparity.values[i])) continue;
    const std::size_t row = i / width;
    const double right_y = static_cast<double>(row) + lower_px;
    warped.vertical_px.values[i] = static_cast<float>(-lower_px);
    warped.bias_px.values[i] = 0;
    if (right_y < 0 || right_y > pair.right.height_px - 1) warped.truth.occluded[i] = 1;
  }
  return warped;
}

void repair(WarpedPair& warped, const VerticalField& field) {
  if (!field.significant) return;
  correct_right(field, warped.pair);
  const auto width = static_cast<std::size_t>(warped.vertical_px.width_px);
  for (std::size_t i = 0; i < warped.vertical_px.values.size(); ++i) {
    const double right_x = static_cast<double>(i % width) - warped.truth.disparity.values[i];
    const std::size_t row = i / width;
    const double dy = field.dy_px(right_x, static_cast<double>(row));
    warped.vertical_px.values[i] += static_cast<float>(dy);
  }
}

std::vector<TruthAtEdge> truth_at(const WarpedPair& warped, const std::vector<EdgePoint>& edges) {
  std::vector<TruthAtEdge> at = truth_at(warped.truth, edges);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!at[i].known) continue;
    const EdgePoint& edge = edges[i];
    const int x = column_of(edge, warped.vertical_px, "ground truth");
    at[i].crossing_px = warped.vertical_px(x, edge.y) * edge.normal.y() / edge.normal.x();
  }
  return at;
}

}  // namespace vernier::stereo::internal
