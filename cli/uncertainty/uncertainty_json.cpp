// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

#include "calib/base/text_lines.h"
#include "calib/covariance.h"
#include "calib/projection_uncertainty.h"
#include "calib/sampler.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "cli/program/session.h"
#include "cli/uncertainty/uncertainty_report.h"
#include "cli/uncertainty/uncertainty_tables.h"
#include "stereo/rectification/vertical_disparity.h"

namespace vernier::cli {
namespace {

Json distance(double distance_m) { return std::isinf(distance_m) ? Json("inf") : Json(distance_m); }

/// Rounds to five significant digits to keep pages small.
double rounded(double value) { return to_real(fmt::format("{:.5g}", value)).value_or(value); }

template <typename Matrix>
Json matrix(const Matrix& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(json_number(m(i, j)));
    rows.push_back(std::move(row));
  }
  return rows;
}

template <typename Vector>
Json vector(const Vector& v) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) list.push_back(json_number(v[i]));
  return list;
}

template <typename Matrix>
Json deviations(const Matrix& covariance) {
  return vector(covariance.diagonal().cwiseSqrt().eval());
}

/// A rows x columns array with `value(i)` for cell i.
template <typename Value>
Json rows_of_grid(int columns, int rows, Value value) {
  Json all = Json::array();
  for (int r = 0; r < rows; ++r) {
    Json row = Json::array();
    for (int c = 0; c < columns; ++c)
      row.push_back(value(static_cast<std::size_t>(r) * columns + c));
    all.push_back(std::move(row));
  }
  return all;
}

Json sd_rows(int columns,
             int rows,
             GridDetail detail,
             const std::function<double(std::size_t)>& sd) {
  return rows_of_grid(columns, rows, [&](std::size_t i) {
    const double v = sd(i);
    if (!std::isfinite(v)) return Json(nullptr);
    return Json(detail == GridDetail::covariances ? v : rounded(v));
  });
}

Json grid_json(const ProjectionGrid& grid, GridDetail detail) {
  Json json{{"columns", grid.columns},
            {"rows", grid.rows},
            {"x_px", grid.x_px},
            {"y_px", grid.y_px},
            {"absent", grid.absent}};
  json["sd_px"] = sd_rows(grid.columns, grid.rows, detail,
                          [&](std::size_t i) { return worst_sd(grid.covariance[i]); });
  if (detail == GridDetail::covariances) {
    json["covariance_px2"] = rows_of_grid(grid.columns, grid.rows, [&](std::size_t i) {
      return grid.covariance[i].allFinite() ? matrix(grid.covariance[i]) : Json(nullptr);
    });
  }
  return json;
}

Json projection_json(const ProjectionReport& report, GridDetail detail) {
  Json json{{"camera", report.camera},
            {"fixed_to", fixed_to_label(report.fixed_to)},
            {"distance_m",
             report.fixed_to == PointFixedTo::camera ? Json("any") : distance(report.distance_m)},
            {"mean_sd_px", json_number(report.mean_sd_px)},
            {"worst_sd_px", json_number(report.worst_sd_px)},
            {"worst_at_px", vector(report.worst_at_px)},
            {"points", Json::array()}};
  for (const ProjectionFigure& figure : report.figures) {
    json["points"].push_back(
        {{"where", figure.place.name},
         {"pixel_px", vector(figure.place.pixel_px)},
         {"sd_linear_px", figure.linear ? json_number(worst_sd(*figure.linear)) : Json(nullptr)},
         {"sd_sampled_px",
          figure.linear ? json_number(worst_sd(figure.sampled.covariance)) : Json(nullptr)},
         {"covariance_linear_px2", figure.linear ? matrix(*figure.linear) : Json(nullptr)},
         {"covariance_sampled_px2",
          figure.linear ? matrix(figure.sampled.covariance) : Json(nullptr)},
         {"mean_shift_px", vector(figure.sampled.mean_shift_px)},
         {"non_physical_share", figure.sampled.non_physical_share}});
  }
  json["grid"] = grid_json(report.grid, detail);
  return json;
}

Json sampled_json(const SampledPoint& sampled) {
  return {{"sd_m", deviations(sampled.covariance)},
          {"covariance_m2", matrix(sampled.covariance)},
          {"mean_shift_m", vector(sampled.mean_shift_m)},
          {"depth_interval_95_m",
           {json_number(sampled.depth_interval_95_m.low),
            json_number(sampled.depth_interval_95_m.high)}},
          {"non_physical_share", sampled.non_physical_share}};
}

Json triangulation_json(const TriangulationReport& report) {
  const Eigen::Matrix3d total = report.linear.calibration + report.linear.observation;
  return {{"camera", report.camera},
          {"frame", frame_label(report.frame)},
          {"distance_m", report.distance_m},
          {"where", report.place.name},
          {"left_px", vector(report.pair.first_px)},
          {"right_px", vector(report.pair.other_px)},
          {"point_m", vector(report.linear.x_m)},
          {"calibration_sd_m", deviations(report.linear.calibration)},
          {"observation_sd_m", deviations(report.linear.observation)},
          {"total_sd_m", deviations(total)},
          {"calibration_covariance_m2", matrix(report.linear.calibration)},
          {"observation_covariance_m2", matrix(report.linear.observation)},
          {"sampled_calibration", sampled_json(report.sampled)},
          {"sampled_total", sampled_json(report.sampled_total)}};
}

Json disparity_json(const DisparityReport& report, GridDetail detail) {
  const VerticalDisparityMap& map = report.map;
  Json json{{"camera", report.camera},
            {"distance_m", distance(report.distance_m)},
            {"rectified_f_px", map.rectified_f_px},
            {"rms_px", json_number(map.rms_px)},
            {"mean_sd_px", json_number(map.mean_sd_px)},
            {"rms_less_mean_px", json_number(map.rms_less_mean_px)},
            {"rms_less_affine_px", json_number(map.rms_less_affine_px)},
            {"worst_sd_px", json_number(report.worst_sd_px)},
            {"points", Json::array()}};
  for (const DisparityFigure& figure : report.figures) {
    json["points"].push_back({{"where", figure.place.name},
                              {"pixel_px", vector(figure.place.pixel_px)},
                              {"sd_linear_px", figure.linear_sd_px},
                              {"sd_sampled_px", json_number(figure.sampled.sd_px)},
                              {"mean_sampled_px", json_number(figure.sampled.mean_px)},
                              {"non_physical_share", figure.sampled.non_physical_share}});
  }
  json["grid"] = {{"columns", map.columns},
                  {"rows", map.rows},
                  {"x_px", map.x_px},
                  {"y_px", map.y_px},
                  {"absent", map.absent}};
  json["grid"]["sd_px"] =
      sd_rows(map.columns, map.rows, detail, [&](std::size_t i) { return map.sd_px[i]; });
  return json;
}

Json depth_json(const DepthReport& report) {
  Json json{{"camera", report.camera}, {"ranges", Json::array()}};
  for (const DepthUncertainty& u : report.ranges) {
    json["ranges"].push_back(
        {{"range_m", u.range_m},
         {"sd_linear_m", json_number(u.sigma_linear_m)},
         {"sd_sampled_m", json_number(u.sigma_sampled_m)},
         {"interval_95_m", {json_number(u.interval_95_m.low), json_number(u.interval_95_m.high)}},
         {"non_physical_share", u.non_physical_share}});
  }
  return json;
}

}  // namespace

Json uncertainty_json(const UncertaintyReport& report, GridDetail detail) {
  const SamplingOptions& sampling = report.request.sampling;
  Json json{
      {"covariance_kind", name(report.kind)},
      {"psi_c", sampling.psi_c},
      {"samples", sampling.samples},
      {"seed", sampling.seed},
      {"pair_sigma_px", report.request.pair_sigma_px},
      {"board_sigma_px", report.board_sigma_px > 0 ? Json(report.board_sigma_px) : Json(nullptr)},
      {"distances_m", Json::array()},
      {"notes", report.notes}};
  for (const double d : report.request.distances_m) json["distances_m"].push_back(distance(d));
  for (const char* part : {"projection", "triangulation", "vertical_disparity", "depth"}) {
    json[part] = Json::array();
  }
  for (const auto& r : report.projection) json["projection"].push_back(projection_json(r, detail));
  for (const auto& r : report.triangulation) json["triangulation"].push_back(triangulation_json(r));
  for (const auto& r : report.vertical_disparity) {
    json["vertical_disparity"].push_back(disparity_json(r, detail));
  }
  for (const auto& r : report.depth) json["depth"].push_back(depth_json(r));
  return json;
}

}  // namespace vernier::cli
