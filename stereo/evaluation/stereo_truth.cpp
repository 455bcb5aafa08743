// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/stereo_truth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/matching/map_window.h"

namespace vernier::stereo {

using namespace internal;

namespace {

/// Labels row pixels so that those on both sides of a fold have different numbers.
std::vector<int> folds_of(const DisparityMap& map, int y) {
  std::vector<int> folds(static_cast<std::size_t>(map.width_px), 0);
  int count = 0;
  float last = -std::numeric_limits<float>::infinity();  // x − d
  for (int x = 0; x < map.width_px; ++x) {
    if (map.known(x, y)) {
      const float right = static_cast<float>(x) - map(x, y);
      count += right < last + 1 - step_px;
      last = right;
    }
    folds[static_cast<std::size_t>(x)] = count;
  }
  return folds;
}

/// The visible, i.e. nearest, left pixel at every right pixel of a row; -1: none.
std::vector<int> seen_in_right(const DisparityMap& map, int y) {
  std::vector<int> seen(static_cast<std::size_t>(map.width_px), -1);
  const auto put = [&](long right, int x) {
    if (right < 0 || right >= map.width_px) return;
    int& front = seen[static_cast<std::size_t>(right)];
    if (front < 0 || map(x, y) > map(front, y)) front = x;
  };
  for (int x = 0; x < map.width_px; ++x) {
    if (!map.known(x, y)) continue;
    const long right = std::lround(static_cast<float>(x) - map(x, y));
    put(right, x);
    // A surface that is wider in the right image must not leave a gap.
    const bool joined = x > 0 && map.known(x - 1, y) && std::abs(map(x, y) - map(x - 1, y)) < 1;
    if (joined && std::lround(static_cast<float>(x - 1) - map(x - 1, y)) == right - 2) {
      put(right - 1, x - 1);
    }
  }
  return seen;
}

/// Whether the right image's truth has another surface at its pixel nearest to `right_px`.
bool disagrees(const DisparityMap& truth, int y, float right_px, float disparity) {
  const int nearest = static_cast<int>(std::lround(right_px));
  if (!truth.known(nearest, y)) return false;
  float least = truth(nearest, y), most = least;
  for (const int x : {nearest - 1, nearest + 1}) {
    if (x < 0 || x >= truth.width_px || !truth.known(x, y)) continue;
    least = std::min(least, truth(x, y));
    most = std::max(most, truth(x, y));
  }
  return disparity < least - step_px || disparity > most + step_px;
}

void mark_occluded(StereoTruth& truth, const DisparityMap* right_truth, int y) {
  const DisparityMap& map = truth.disparity;
  const std::vector<int> folds = folds_of(map, y), seen = seen_in_right(map, y);
  for (int x = 0; x < map.width_px; ++x) {
    if (!map.known(x, y)) continue;
    const float d = map(x, y), right = static_cast<float>(x) - d;
    bool occluded = right < 0 || right > static_cast<float>(map.width_px - 1);
    if (!occluded) {
      const int front = seen[static_cast<std::size_t>(std::lround(right))];
      occluded = map(front, y) > d + step_px &&
                 folds[static_cast<std::size_t>(front)] != folds[static_cast<std::size_t>(x)];
      occluded = occluded || (right_truth && disagrees(*right_truth, y, right, d));
    }
    truth.occluded[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width_px) +
                   static_cast<std::size_t>(x)] = occluded;
  }
}

std::string size_text(int width_px, int height_px) {
  return fmt::format("{}x{}", width_px, height_px);
}

bool is_sparse(const DisparityMap& map) {
  std::size_t known = 0, surrounded = 0;
  for (int y = 1; y + 1 < map.height_px; ++y) {
    for (int x = 1; x + 1 < map.width_px; ++x) {
      if (!map.known(x, y)) continue;
      ++known;
      bool all = true;
      for (int j = y - 1; j <= y + 1; ++j) {
        for (int i = x - 1; i <= x + 1; ++i) all = all && map.known(i, j);
      }
      surrounded += all;
    }
  }
  return 2 * surrounded < known;
}

TruthAtEdge truth_at(const StereoTruth& truth, const EdgePoint& edge) {
  const DisparityMap& map = truth.disparity;
  const int x = column_of(edge, map, "ground truth");
  const MapWindow near(map, x, edge.y, 1);
  TruthAtEdge at;
  int source_x = x, source_y = edge.y;
  bool all_known = true;
  const bool step = near.has_step();
  for (int j = near.y0; j <= near.y1; ++j) {
    for (int i = near.x0; i <= near.x1; ++i) {
      if (!map.known(i, j)) {
        all_known = false;
        continue;
      }
      at.min_px = std::fmin(at.min_px, map(i, j));
      if (at.max_px >= map(i, j)) continue;
      at.max_px = map(i, j);
      if (step) source_x = i, source_y = j;
    }
  }
  at.known = map.known(x, edge.y);
  at.discontinuity = (!all_known && !truth.sparse) || MapWindow(map, x, edge.y, 2).has_step();
  at.own_px = at.known ? along_row(map, edge.row_x_px, edge.y) : NAN;
  at.own_occluded =
      truth.occluded[static_cast<std::size_t>(edge.y) * static_cast<std::size_t>(map.width_px) +
                     static_cast<std::size_t>(x)] != 0;
  at.disparity_px = step ? at.max_px : at.own_px;
  at.occluded =
      truth.occluded[static_cast<std::size_t>(source_y) * static_cast<std::size_t>(map.width_px) +
                     static_cast<std::size_t>(source_x)] != 0;
  return at;
}

}  // namespace

StereoTruth stereo_truth(DisparityMap left, const DisparityMap* right) {
  if (right && (right->width_px != left.width_px || right->height_px != left.height_px)) {
    throw Error("ground truth",
                "the left map has the size " + size_text(left.width_px, left.height_px) +
                    " and the right one " + size_text(right->width_px, right->height_px),
                "use both of one pair");
  }
  check_known(left, "ground truth");
  StereoTruth truth;
  truth.occluded.assign(left.values.size(), 0);
  truth.sparse = is_sparse(left);
  truth.disparity = std::move(left);
  for (int y = 0; y < truth.disparity.height_px; ++y) mark_occluded(truth, right, y);
  return truth;
}

std::vector<TruthAtEdge> truth_at(const StereoTruth& truth, const std::vector<EdgePoint>& edges) {
  std::vector<TruthAtEdge> found;
  found.reserve(edges.size());
  for (const EdgePoint& edge : edges) found.push_back(truth_at(truth, edge));
  return found;
}

}  // namespace vernier::stereo
