// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/board_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calib/error.h"

namespace vernier::internal {
namespace {

/// Points in a file have at least this precision.
constexpr double coincidence_m = 1e-9;

/// Maximum number of cells per point: in a sparser grid some point is misplaced.
constexpr double max_cells = 4;

/// Smallest distance between different coordinates along an axis.
double pitch_along(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (step > coincidence_m) least = std::min(least, step);
  }
  return least;
}

std::vector<double> coordinates(const std::vector<Eigen::Vector3d>& points, int axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
  return values;
}

}  // namespace

BoardGrid board_grid(const std::vector<Eigen::Vector3d>& target_m) {
  const Error refused("target", "its points are not on a flat, square grid",
                      "mrcal calibrates from chessboards only; leave mrcal out");
  const double pitch =
      std::min(pitch_along(coordinates(target_m, 0)), pitch_along(coordinates(target_m, 1)));
  if (!std::isfinite(pitch)) throw refused;
  BoardGrid grid;
  grid.origin_m = target_m.front();
  Eigen::Vector3d far = target_m.front();
  for (const Eigen::Vector3d& point : target_m) {
    grid.origin_m = grid.origin_m.cwiseMin(point);
    far = far.cwiseMax(point);
  }
  const Eigen::Vector3d extent = far - grid.origin_m;
  const Eigen::Vector2d steps = (extent.head<2>() / pitch).array().round();
  const double area = (steps.array() + 1).prod();
  if (!(steps.minCoeff() >= 1 && area <= max_cells * static_cast<double>(target_m.size())) ||
      extent.z() > coincidence_m) {
    throw refused;
  }
  // divide the longest side, so that the rounding error of one coordinate does not grow along it
  Eigen::Index longest = 0;
  steps.maxCoeff(&longest);
  grid.spacing_m = extent[longest] / steps[longest];
  grid.columns = static_cast<int>(steps.x()) + 1;
  grid.rows = static_cast<int>(steps.y()) + 1;
  for (const Eigen::Vector3d& point : target_m) {
    const Eigen::Vector2d at = (point - grid.origin_m).head<2>() / grid.spacing_m;
    const Eigen::Vector2d whole = at.array().round();
    if (((at - whole) * grid.spacing_m).cwiseAbs().maxCoeff() > coincidence_m) throw refused;
    grid.cell.push_back(static_cast<int>(whole.y()) * grid.columns + static_cast<int>(whole.x()));
  }
  std::vector<int> cells = grid.cell;
  std::sort(cells.begin(), cells.end());
  if (std::adjacent_find(cells.begin(), cells.end()) != cells.end()) throw refused;
  return grid;
}

}  // namespace vernier::internal
