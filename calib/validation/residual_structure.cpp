// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/residual_structure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "calib/board_observations.h"
#include "calib/calibration/outliers.h"
#include "calib/error.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {
namespace {

constexpr double first_edge = -5, bin = 0.25;  // in sigmas
constexpr int bins = 40;

int cell_along(double pixel, int size, int cells) {
  const double place = (pixel + 0.5) / size * cells;  // pixel 0 spans [-0.5, 0.5)
  return place > 0 ? static_cast<int>(std::min(std::floor(place), cells - 1.0)) : 0;
}

int bin_of(double in_sigmas) {
  const double place = std::floor((in_sigmas - first_edge) / bin);
  return place > 0 ? static_cast<int>(std::min(place, bins - 1.0)) : 0;
}

}  // namespace

std::vector<CornerResidual> residuals_of_camera(const RigEstimate& estimate, int camera) {
  if (!estimate.evidence) {
    throw Error("residuals", "the rig holds no evidence", "calibrate without --no-evidence");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  const CornerResiduals all =
      corner_residuals(evidence.observations,
                       {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m});
  std::vector<CornerResidual> residuals;
  for (std::size_t v = 0; v < all.size(); ++v) {
    const BoardView& view = evidence.observations.views[v];
    if (view.camera != camera) continue;
    for (std::size_t i = 0; i < all[v].size(); ++i) {
      if (!all[v][i].allFinite()) {
        throw Error("evidence",
                    "frame " + std::to_string(view.frame) +
                        ": the stored pose does not place its board before the camera",
                    "calibrate again");
      }
      residuals.push_back({view.frame, view.ids[i], view.pixels_px[i], all[v][i]});
    }
  }
  return residuals;
}

ResidualStructure residual_structure(const std::vector<CornerResidual>& residuals,
                                     const Eigen::Vector2i& size_px,
                                     double pixel_sigma_px,
                                     int columns,
                                     int rows) {
  if (columns < 1 || rows < 1 || !(pixel_sigma_px > 0)) {
    throw Error("residuals", "no cells, or no pixel noise",
                "give columns, rows and a pixel sigma above 0");
  }
  constexpr double limit_95 = 2.447746830680816;  // (−2 ln 0.05)^½
  ResidualStructure s;
  s.columns = columns;
  s.rows = rows;
  s.cells.resize(static_cast<std::size_t>(columns) * rows);
  s.histogram.assign(bins, 0);
  s.first_edge = first_edge;
  s.bin = bin;
  int beyond = 0;
  for (const CornerResidual& r : residuals) {
    ResidualCell& cell = s.cells[cell_along(r.pixel_px.y(), size_px.y(), rows) * columns +
                                 cell_along(r.pixel_px.x(), size_px.x(), columns)];
    ++cell.corners;
    cell.mean_px += r.residual_px;
    for (const double residual : r.residual_px) {
      const double in_sigmas = residual / pixel_sigma_px;
      ++s.histogram[bin_of(in_sigmas)];
      beyond += std::abs(in_sigmas) > 3;
    }
  }
  for (ResidualCell& cell : s.cells) {
    if (cell.corners == 0) continue;
    cell.mean_px /= cell.corners;
    cell.in_sigmas = cell.mean_px.norm() * std::sqrt(cell.corners) / pixel_sigma_px;
    ++s.filled;
    s.beyond_95 += cell.in_sigmas > limit_95;
  }
  if (!residuals.empty()) s.beyond_3_sigma = beyond / (2.0 * static_cast<double>(residuals.size()));
  return s;
}

}  // namespace vernier::internal
