// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "calib/covariance.h"
#include "calib/projection_uncertainty.h"
#include "calib/triangulation_uncertainty.h"
#include "cli/uncertainty/uncertainty_report.h"
#include "cli/uncertainty/uncertainty_tables.h"

namespace vernier::cli {
namespace {

constexpr std::string_view where_corners_are =
    "(top left … bottom right: 10 % of the image width and height inwards from the corner)\n";

std::string number(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "inf";
  return fmt::format("{:.3g}", value);
}

std::string both(double linear, double sampled) { return number(linear) + " / " + number(sampled); }

std::string percent(double share) {
  if (share >= 0.995) return "100 %";
  return share > 0 ? fmt::format("{:.2g} %", 100 * share) : "0";
}

std::string projection_text(const UncertaintyReport& report) {
  std::string text =
      "\nprojection: standard deviation of the pixel in its worst direction, px (linear / "
      "sampled)\n" +
      std::string(where_corners_are);
  text += fmt::format("{:<8} {:<13} {:>8} {:>15} {:>15} {:>15} {:>15} {:>15} {:>7} {:>7} {:>6}\n",
                      "camera", "fixed to", "distance", "centre", "top left", "top right",
                      "bottom left", "bottom right", "mean", "worst", "n-p");
  for (const ProjectionReport& r : report.projection) {
    text += fmt::format("{:<8} {:<13} {:>8}", r.camera, fixed_to_label(r.fixed_to),
                        r.fixed_to == PointFixedTo::camera ? "any" : distance_label(r.distance_m));
    double non_physical = 0;
    for (const ProjectionFigure& f : r.figures) {
      text += fmt::format(
          " {:>15}", f.linear ? both(worst_sd(*f.linear), worst_sd(f.sampled.covariance)) : "-");
      if (f.linear) non_physical = std::max(non_physical, f.sampled.non_physical_share);
    }
    text += fmt::format(" {:>7} {:>7} {:>6}\n", number(r.mean_sd_px), number(r.worst_sd_px),
                        percent(non_physical));
  }
  return text;
}

std::string triangulation_text(const UncertaintyReport& report) {
  std::string text = fmt::format(
      "\ntriangulation: standard deviation of x, y, z from the calibration (linear; z: linear / "
      "sampled) and of z from a pixel noise of {:.3g} px\n",
      report.request.pair_sigma_px);
  text += fmt::format("{:<8} {:<10} {:>8} {:<12} {:>9} {:>9} {:>19} {:>9} {:>9} {:>19} {:>6}\n",
                      "camera", "frame", "distance", "where", "x m", "y m", "z m", "pixels z",
                      "total z", "95 % of z", "n-p");
  for (const TriangulationReport& r : report.triangulation) {
    const auto sd = [](const Eigen::Matrix3d& C, int i) { return std::sqrt(C(i, i)); };
    const auto& interval = r.sampled_total.depth_interval_95_m;
    text += fmt::format("{:<8} {:<10} {:>8} {:<12} {:>9} {:>9} {:>19} {:>9} {:>9} {:>19} {:>6}\n",
                        r.camera, frame_label(r.frame), distance_label(r.distance_m), r.place.name,
                        number(sd(r.linear.calibration, 0)), number(sd(r.linear.calibration, 1)),
                        both(sd(r.linear.calibration, 2), sd(r.sampled.covariance, 2)),
                        number(sd(r.linear.observation, 2)),
                        number(sd(r.linear.calibration + r.linear.observation, 2)),
                        fmt::format("{:.4g} … {:.4g}", interval.low, interval.high),
                        percent(r.sampled_total.non_physical_share));
  }
  return text;
}

std::string disparity_text(const UncertaintyReport& report) {
  std::string text =
      "\nrectification: standard deviation of the vertical disparity, px (linear / sampled)\n" +
      std::string(where_corners_are);
  text += fmt::format("{:<8} {:>8} {:>15} {:>15} {:>15} {:>15} {:>15} {:>7} {:>7} {:>9} {:>11}\n",
                      "camera", "distance", "centre", "top left", "top right", "bottom left",
                      "bottom right", "rms", "worst", "less mean", "less affine");
  for (const DisparityReport& r : report.vertical_disparity) {
    text += fmt::format("{:<8} {:>8}", r.camera, distance_label(r.distance_m));
    for (const char* where : {"centre", "top left", "top right", "bottom left", "bottom right"}) {
      const auto found = std::find_if(r.figures.begin(), r.figures.end(),
                                      [&](const auto& f) { return f.place.name == where; });
      text += fmt::format(" {:>15}", found == r.figures.end()
                                         ? "-"
                                         : both(found->linear_sd_px, found->sampled.sd_px));
    }
    text += fmt::format(" {:>7} {:>7} {:>9} {:>11}\n", number(r.map.rms_px), number(r.worst_sd_px),
                        number(r.map.rms_less_mean_px), number(r.map.rms_less_affine_px));
  }
  return text;
}

std::string depth_text(const DepthReport& report) {
  std::string text = fmt::format(
      "\ndepth on the optical axis, with camera \"{}\" (calibration error only)\n"
      "{:>8} {:>19} {:>21} {:>13}\n",
      report.camera, "range m", "sd m (lin. / samp.)", "95 % m", "non-physical");
  for (const DepthUncertainty& u : report.ranges) {
    text += fmt::format("{:>8} {:>19} {:>21} {:>13}\n", number(u.range_m),
                        both(u.sigma_linear_m, u.sigma_sampled_m),
                        fmt::format("{:.4g} … {:.4g}", u.interval_95_m.low, u.interval_95_m.high),
                        percent(u.non_physical_share));
  }
  return text;
}

}  // namespace

std::string distance_label(double distance_m) {
  return std::isinf(distance_m) ? "inf" : fmt::format("{:g}m", distance_m);
}

std::string_view fixed_to_label(PointFixedTo fixed_to) {
  switch (fixed_to) {
    case PointFixedTo::boards:
      return "boards";
    case PointFixedTo::camera:
      return "camera";
    case PointFixedTo::first_camera:
      break;
  }
  return "first_camera";
}

std::string_view frame_label(TriangulationFrame frame) {
  return frame == TriangulationFrame::rig ? "rig" : "stabilised";
}

std::string uncertainty_text(const UncertaintyReport& report) {
  std::string text = fmt::format("covariance: {}, psi_c {}; {} samples, seed {}\n",
                                 name(report.kind), report.request.sampling.psi_c,
                                 report.request.sampling.samples, report.request.sampling.seed);
  text += projection_text(report);
  if (!report.triangulation.empty()) text += triangulation_text(report);
  if (!report.vertical_disparity.empty()) text += disparity_text(report);
  for (const DepthReport& r : report.depth) text += depth_text(r);
  text += "n-p: fraction of non-physical samples (maximum over the pixels)\n";
  for (const std::string& note : report.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace vernier::cli
