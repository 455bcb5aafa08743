// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/pose.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/quantile.h"
#include "calib/validation/residual_structure.h"
#include "calib/validation/view_influence.h"
#include "cli/program/session.h"
#include "cli/report/report_calibration.h"

namespace vernier::cli {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Rounds to the given number of decimals; null if not finite.
Json rounded(double x, int decimals) {
  const double k = std::pow(10, decimals);
  return std::isfinite(x) ? Json(std::round(x * k) / k) : Json(nullptr);
}

/// Rounds to four significant digits.
Json short_number(double x) {
  if (!std::isfinite(x)) return nullptr;
  if (x == 0) return 0;
  return Json::parse(fmt::format("{:.4g}", x));
}

/// Selects an evenly spread subset, independent of periodic order (multiples of the golden ratio).
bool is_shown(std::size_t i, std::size_t all) {
  constexpr std::size_t most = 2000;  // strokes per picture
  if (all <= most) return true;
  const double place = static_cast<double>(i) * 0.6180339887498949;
  return place - std::floor(place) < static_cast<double>(most) / static_cast<double>(all);
}

Json structure_json(const ResidualStructure& s) {
  Json json{{"columns", s.columns},
            {"rows", s.rows},
            {"counts", Json::array()},
            {"mean", Json::array()},
            {"in_sigmas", Json::array()},
            {"filled", s.filled},
            {"beyond_95", s.beyond_95},
            {"histogram", s.histogram},
            {"first_edge", s.first_edge},
            {"bin", s.bin},
            {"beyond_3_sigma", s.beyond_3_sigma}};
  for (const ResidualCell& cell : s.cells) {
    json["counts"].push_back(cell.corners);
    json["mean"].push_back({rounded(cell.mean_px.x(), 4), rounded(cell.mean_px.y(), 4)});
    json["in_sigmas"].push_back(rounded(cell.in_sigmas, 2));
  }
  return json;
}

/// Approximately square cells, twelve along the longer side.
std::pair<int, int> cells_of(const Eigen::Vector2i& size_px) {
  const double side = size_px.maxCoeff() / 12.0;
  return {std::max(1L, std::lround(size_px.x() / side)),
          std::max(1L, std::lround(size_px.y() / side))};
}

Json outliers_json(const RigEstimate& estimate, int camera) {
  Json json = Json::array();
  for (const CornerOutlier& o : estimate.calibration->outliers) {
    if (o.camera != camera) continue;
    json.push_back({rounded(o.pixel_px.x(), 2), rounded(o.pixel_px.y(), 2),
                    rounded(o.residual_px, 2), o.frame, o.id});
  }
  return json;
}

/// Central, median and largest standard deviation of a map.
struct MapFigures {
  double centre = 0, median = 0, worst = 0;
};

MapFigures figures_of(const ProjectionGrid& grid) {
  std::vector<double> sds;
  for (const Eigen::Matrix2d& C : grid.covariance) {
    const double sd = worst_sd(C);
    if (std::isfinite(sd)) sds.push_back(sd);
  }
  if (sds.empty()) return {NAN, NAN, NAN};
  const std::size_t middle =
      static_cast<std::size_t>(grid.rows / 2) * grid.columns + grid.columns / 2;
  return {worst_sd(grid.covariance[middle]), quantile(sds, 0.5, QuantileKind::upper),
          quantile(sds, 1, QuantileKind::lower)};
}

Json map_json(const ProjectionGrid& grid, double distance_m) {
  Json rows = Json::array();
  for (int y = 0; y < grid.rows; ++y) {
    Json row = Json::array();
    for (int x = 0; x < grid.columns; ++x) {
      row.push_back(
          short_number(worst_sd(grid.covariance[static_cast<std::size_t>(y) * grid.columns + x])));
    }
    rows.push_back(std::move(row));
  }
  return {{"distance_m", rounded(distance_m, 3)}, {"sd_px", rows}};
}

/// Distances of the board centres from the first camera: minimum, median, maximum.
std::array<double, 3> board_ranges(const CalibrationEvidence& evidence) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& X : evidence.observations.target_m) middle += X;
  middle /= static_cast<double>(evidence.observations.target_m.size());
  std::vector<double> ranges;
  for (const Pose& T : evidence.T_first_board) ranges.push_back((T * middle).norm());
  return {quantile(ranges, 0, QuantileKind::lower), quantile(ranges, 0.5, QuantileKind::upper),
          quantile(ranges, 1, QuantileKind::lower)};
}

Json camera_projection(const RigAndBoards& honest,
                       const std::optional<RigAndBoards>& bound,
                       int camera,
                       double board_range_m) {
  constexpr int columns = 33;
  const Camera& c = honest.rig.cameras[camera];
  const int rows =
      std::max(2, static_cast<int>(std::lround(columns * double(c.size_px.y()) / c.size_px.x())));
  const ProjectionUncertainty uncertainty(honest, camera, PointFixedTo::boards);
  Json json{{"camera", c.name}, {"size_px", {c.size_px.x(), c.size_px.y()}}};
  json["maps"] = Json::array();
  json["figures"] = Json::array();
  for (const double distance_m : {board_range_m, 1.0, 5.0, infinity}) {
    const ProjectionGridOptions grid_options{
        .columns = columns, .rows = rows, .distance_m = distance_m};
    const ProjectionGrid grid = projection_grid(uncertainty, grid_options);
    const MapFigures own = figures_of(grid);
    Json row{{"distance_m", rounded(distance_m, 3)},  {"boards", distance_m == board_range_m},
             {"centre_px", short_number(own.centre)}, {"median_px", short_number(own.median)},
             {"worst_px", short_number(own.worst)},   {"absent", grid.absent}};
    if (bound) {
      const MapFigures sure = figures_of(projection_grid(
          ProjectionUncertainty(*bound, camera, PointFixedTo::boards), grid_options));
      row["centre_bound_px"] = short_number(sure.centre);
      row["median_bound_px"] = short_number(sure.median);
    }
    json["figures"].push_back(std::move(row));
    if (distance_m == board_range_m) continue;
    json["x_px"] = grid.x_px;
    json["y_px"] = grid.y_px;
    json["maps"].push_back(map_json(grid, distance_m));
  }
  return json;
}

/// The parameter that a view changes most, in standard deviations.
Json largest_move(const Eigen::VectorXd& move,
                  const Covariance& covariance,
                  const std::vector<std::string>& names) {
  Json largest;
  double most = 0;
  for (Eigen::Index i = 0; i < move.size(); ++i) {
    const double sigma = std::sqrt(covariance.matrix(i, i));
    if (!(sigma > 0) || std::abs(move[i]) / sigma <= most) continue;
    most = std::abs(move[i]) / sigma;
    largest = {{"name", names[i]}, {"sigmas", rounded(move[i] / sigma, 3)}};
  }
  return largest;
}

}  // namespace

Json report_corners(const RigEstimate& estimate) {
  Json cameras = Json::array();
  for (int c = 0; c < static_cast<int>(estimate.rig.cameras.size()); ++c) {
    const Camera& camera = estimate.rig.cameras[c];
    const std::vector<CornerResidual> residuals = residuals_of_camera(estimate, c);
    const auto [columns, rows] = cells_of(camera.size_px);
    const double sigma = estimate.calibration->pixel_sigma_px;
    Json json{{"camera", camera.name},
              {"size_px", {camera.size_px.x(), camera.size_px.y()}},
              {"pixel_sigma_px", sigma},
              {"corners", residuals.size()},
              {"points", Json::array()},
              {"outliers", outliers_json(estimate, c)},
              {"structure", structure_json(residual_structure(residuals, camera.size_px, sigma,
                                                              columns, rows))}};
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      if (!is_shown(i, residuals.size())) continue;
      const CornerResidual& r = residuals[i];
      json["points"].push_back({rounded(r.pixel_px.x(), 2), rounded(r.pixel_px.y(), 2),
                                rounded(r.residual_px.x(), 3), rounded(r.residual_px.y(), 3)});
    }
    cameras.push_back(std::move(json));
  }
  return cameras;
}

Json report_projection(const RigEstimate& estimate) {
  const RigAndBoards honest = rig_and_boards(estimate, CovarianceChoice::honest);
  std::optional<RigAndBoards> bound;
  if (estimate.covariance_mvb && estimate.covariance->kind != CovarianceKind::mvb) {
    bound = rig_and_boards(estimate, CovarianceChoice::mvb);
  }
  const auto [nearest, median, farthest] = board_ranges(*estimate.evidence);
  Json json{{"boards_m", {rounded(nearest, 3), rounded(median, 3), rounded(farthest, 3)}},
            {"cameras", Json::array()}};
  for (int c = 0; c < static_cast<int>(estimate.rig.cameras.size()); ++c) {
    json["cameras"].push_back(camera_projection(honest, bound, c, median));
  }
  return json;
}

Json report_views(const RigEstimate& estimate) {
  const std::vector<std::string> names = parameter_names(estimate.rig);
  Json views = Json::array();
  for (const ViewInfluence& one : view_influence(estimate)) {
    std::set<std::string> images;
    for (const BoardView& view : estimate.evidence->observations.views) {
      if (view.frame != one.frame || view.image.empty()) continue;
      images.insert(std::filesystem::path(view.image).filename().string());
    }
    const bool alone = !std::isfinite(one.leave_one_out_influence);
    views.push_back({{"frame", one.frame},
                     {"images", images},
                     {"corners", one.corners},
                     {"rms_px", rounded(one.rms_px, 4)},
                     {"leverage", rounded(one.leverage, 4)},
                     {"largest_share", rounded(one.largest_share, 4)},
                     {"influence", rounded(one.influence, 4)},
                     {"influence_noise", rounded(one.expected_influence, 4)},
                     {"influence_left_out", rounded(one.leave_one_out_influence, 4)},
                     {"largest_move", largest_move(alone ? one.delta : one.leave_one_out_delta,
                                                   *estimate.covariance, names)}});
  }
  return views;
}

}  // namespace vernier::cli
