// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/outlier_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {
namespace {

using ViewKey = std::pair<int, int>;  // frame, camera

std::string corner_line(const CornerOutlier& outlier, const std::string& view) {
  std::string line = fmt::format("corner {} of {}", outlier.id, view);
  if (std::isfinite(outlier.residual_px)) {
    line += fmt::format(", {:.1f} px from its prediction", outlier.residual_px);
  }
  return line;
}

std::string view_line(const std::vector<CornerOutlier>& outliers, const std::string& view) {
  std::string line = fmt::format("all {} corners of {}", outliers.size(), view);
  double least = std::numeric_limits<double>::infinity(), largest = 0;
  for (const CornerOutlier& outlier : outliers) {
    if (!std::isfinite(outlier.residual_px)) return line;
    least = std::min(least, outlier.residual_px);
    largest = std::max(largest, outlier.residual_px);
  }
  return line + fmt::format(", {:.1f} to {:.1f} px from their predictions", least, largest);
}

}  // namespace

std::vector<std::string> outlier_lines(const RigEstimate& estimate) {
  std::vector<std::string> lines;
  if (!estimate.calibration) return lines;
  std::map<ViewKey, std::vector<CornerOutlier>> by_view;
  for (const CornerOutlier& outlier : estimate.calibration->outliers) {
    by_view[{outlier.frame, outlier.camera}].push_back(outlier);
  }
  std::set<ViewKey> kept;
  if (estimate.evidence) {
    for (const BoardView& view : estimate.evidence->observations.views) {
      kept.emplace(view.frame, view.camera);
    }
  }
  for (const auto& [key, outliers] : by_view) {
    const std::string& camera = estimate.rig.cameras.at(static_cast<std::size_t>(key.second)).name;
    const std::string view = fmt::format("frame {}, {}", key.first, camera);
    if (estimate.evidence && !kept.contains(key)) {
      lines.push_back(view_line(outliers, view));
      continue;
    }
    for (const CornerOutlier& outlier : outliers) lines.push_back(corner_line(outlier, view));
  }
  return lines;
}

}  // namespace vernier::internal
