// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/output_files.h"
#include "calib/projection_uncertainty.h"
#include "calib/triangulation_uncertainty.h"
#include "cli/program/heat_map.h"
#include "cli/program/session.h"
#include "cli/uncertainty/uncertainty_report.h"
#include "cli/uncertainty/uncertainty_tables.h"

namespace vernier::cli {
namespace {

/// The output folder and the names of its files, which appear with commit().
class Folder {
 public:
  explicit Folder(std::filesystem::path path) : path_(std::move(path)) { files_.add_folder(path_); }
  void write(const std::string& name, const std::string& content) {
    files_.add(path_ / name, content);
    names_.push_back(name);
  }
  void commit() { files_.commit(); }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::filesystem::path path_;
  OutputFiles files_;
  std::vector<std::string> names_;
};

/// Unique file name parts from camera names: unsupported characters become '_', duplicates are
/// numbered.
class FileParts {
 public:
  const std::string& operator[](const std::string& camera) {
    const auto [part, is_new] = parts_.try_emplace(camera);
    if (!is_new) return part->second;
    std::string plain = camera;
    std::replace_if(
        plain.begin(), plain.end(),
        [](unsigned char c) { return !std::isalnum(c) && c != '-' && c != '_' && c != '.'; }, '_');
    part->second = plain;
    for (int i = 2; !used_.insert(part->second).second; ++i) {
      part->second = fmt::format("{}_{}", plain, i);
    }
    return part->second;
  }

 private:
  std::map<std::string, std::string> parts_;
  std::set<std::string> used_;
};

/// A text as a CSV field (RFC 4180), quoted if necessary.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? "\"\"" : std::string(1, c);
  return field + "\"";
}

std::string cell(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string projection_csv(const UncertaintyReport& report) {
  std::string csv =
      "camera,fixed_to,distance_m,where,u_px,v_px,sd_linear_px,sd_sampled_px,non_physical_share\n";
  for (const ProjectionReport& r : report.projection) {
    for (const ProjectionFigure& f : r.figures) {
      if (!f.linear) continue;
      csv +=
          fmt::format("{},{},{},{},{},{},{},{},{}\n", quoted(r.camera), fixed_to_label(r.fixed_to),
                      r.fixed_to == PointFixedTo::camera ? "any" : cell(r.distance_m), f.place.name,
                      f.place.pixel_px.x(), f.place.pixel_px.y(), cell(worst_sd(*f.linear)),
                      cell(worst_sd(f.sampled.covariance)), f.sampled.non_physical_share);
    }
  }
  return csv;
}

std::string triangulation_csv(const UncertaintyReport& report) {
  std::string csv =
      "camera,frame,distance_m,where,x_m,y_m,z_m,calibration_sd_x_m,calibration_sd_y_m,"
      "calibration_sd_z_m,calibration_sd_z_sampled_m,observation_sd_x_m,observation_sd_y_m,"
      "observation_sd_z_m,z_low_95_m,z_high_95_m,non_physical_share\n";
  for (const TriangulationReport& r : report.triangulation) {
    const Eigen::Vector3d c = r.linear.calibration.diagonal().cwiseSqrt();
    const Eigen::Vector3d o = r.linear.observation.diagonal().cwiseSqrt();
    const auto& interval = r.sampled_total.depth_interval_95_m;
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quoted(r.camera),
                       frame_label(r.frame), r.distance_m, r.place.name, r.linear.x_m.x(),
                       r.linear.x_m.y(), r.linear.x_m.z(), c.x(), c.y(), c.z(),
                       cell(std::sqrt(r.sampled.covariance(2, 2))), o.x(), o.y(), o.z(),
                       interval.low, interval.high, r.sampled_total.non_physical_share);
  }
  return csv;
}

std::string disparity_csv(const UncertaintyReport& report) {
  std::string csv =
      "camera,distance_m,where,u_px,v_px,sd_linear_px,sd_sampled_px,non_physical_share\n";
  for (const DisparityReport& r : report.vertical_disparity) {
    for (const DisparityFigure& f : r.figures) {
      csv += fmt::format("{},{},{},{},{},{},{},{}\n", quoted(r.camera), r.distance_m, f.place.name,
                         f.place.pixel_px.x(), f.place.pixel_px.y(), f.linear_sd_px,
                         cell(f.sampled.sd_px), f.sampled.non_physical_share);
    }
  }
  return csv;
}

std::string depth_csv(const UncertaintyReport& report) {
  std::string csv =
      "camera,range_m,sd_linear_m,sd_sampled_m,low_95_m,high_95_m,non_physical_share\n";
  for (const DepthReport& r : report.depth) {
    for (const DepthUncertainty& u : r.ranges) {
      csv += fmt::format("{},{},{},{},{},{},{}\n", quoted(r.camera), u.range_m, u.sigma_linear_m,
                         u.sigma_sampled_m, u.interval_95_m.low, u.interval_95_m.high,
                         u.non_physical_share);
    }
  }
  return csv;
}

void write_projection_map(const ProjectionReport& r, FileParts& parts, Folder& folder) {
  const bool any = r.fixed_to == PointFixedTo::camera;
  const std::string name = fmt::format(
      "projection_{}_{}{}", parts[r.camera], any ? "any" : distance_label(r.distance_m),
      r.fixed_to == PointFixedTo::boards ? "" : fmt::format("_{}", fixed_to_label(r.fixed_to)));
  std::string csv = "u_px,v_px,sd_px,cov_uu_px2,cov_uv_px2,cov_vv_px2\n";
  HeatMap map{fmt::format("Projection uncertainty, {} camera, {}, point fixed to {}", r.camera,
                          any                        ? "any distance"
                          : std::isinf(r.distance_m) ? "at infinity"
                                                     : fmt::format("at {:g} m", r.distance_m),
                          r.fixed_to == PointFixedTo::boards ? "the boards"
                          : any                              ? "the camera"
                                                             : "the first camera"),
              "sd, px",
              r.grid.x_px,
              r.grid.y_px,
              {}};
  for (std::size_t i = 0; i < r.grid.covariance.size(); ++i) {
    const Eigen::Matrix2d& C = r.grid.covariance[i];
    map.values.push_back(worst_sd(C));
    csv += fmt::format("{},{},{},{},{},{}\n", r.grid.x_px[i % r.grid.columns],
                       r.grid.y_px[i / r.grid.columns], cell(worst_sd(C)), cell(C(0, 0)),
                       cell(C(0, 1)), cell(C(1, 1)));
  }
  folder.write(name + ".csv", csv);
  folder.write(name + ".svg", heat_map_svg(map));
}

void write_disparity_map(const DisparityReport& r, FileParts& parts, Folder& folder) {
  const std::string name =
      fmt::format("vertical_disparity_{}_{}", parts[r.camera], distance_label(r.distance_m));
  std::string csv = "u_px,v_px,sd_px\n";
  for (std::size_t i = 0; i < r.map.sd_px.size(); ++i) {
    csv += fmt::format("{},{},{}\n", r.map.x_px[i % r.map.columns], r.map.y_px[i / r.map.columns],
                       cell(r.map.sd_px[i]));
  }
  folder.write(name + ".csv", csv);
  folder.write(
      name + ".svg",
      heat_map_svg({fmt::format("Vertical disparity after rectification, {}",
                                std::isinf(r.distance_m) ? "at infinity"
                                                         : fmt::format("at {:g} m", r.distance_m)),
                    "sd, px", r.map.x_px, r.map.y_px, r.map.sd_px}));
}

}  // namespace

std::vector<std::string> write_uncertainty(const UncertaintyReport& report,
                                           const std::filesystem::path& path) {
  Folder folder(path);
  FileParts parts;
  for (const ProjectionReport& r : report.projection) write_projection_map(r, parts, folder);
  for (const DisparityReport& r : report.vertical_disparity) write_disparity_map(r, parts, folder);
  folder.write("projection.csv", projection_csv(report));
  if (!report.triangulation.empty()) folder.write("triangulation.csv", triangulation_csv(report));
  if (!report.vertical_disparity.empty()) {
    folder.write("vertical_disparity.csv", disparity_csv(report));
  }
  if (!report.depth.empty()) folder.write("depth.csv", depth_csv(report));
  folder.write("uncertainty.json", uncertainty_json(report, GridDetail::deviations)
                                           .dump(-1, ' ', false, Json::error_handler_t::replace) +
                                       "\n");
  folder.commit();
  return folder.names();
}

}  // namespace vernier::cli
