// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/uncertainty/uncertainty_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/camera.h"
#include "calib/estimate/rig_part.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "stereo/rectification/vertical_disparity.h"

namespace vernier::cli {
namespace {

/// Input of all parts.
struct Input {
  const RigEstimate& estimate;
  RigSampler sampler;
  Eigen::MatrixXd covariance;          ///< at psi_c
  std::optional<RigAndBoards> boards;  ///< for the sampler, at psi_c = 1
  std::optional<RigAndBoards> scaled;  ///< at psi_c
};

std::vector<Place> reference_pixels(const Eigen::Vector2i& size_px) {
  const double w = size_px[0] - 1, h = size_px[1] - 1;
  return {{"centre", {0.5 * w, 0.5 * h}},
          {"top left", {0.1 * w, 0.1 * h}},
          {"top right", {0.9 * w, 0.1 * h}},
          {"bottom left", {0.1 * w, 0.9 * h}},
          {"bottom right", {0.9 * w, 0.9 * h}}};
}

ProjectionUncertainty linear_projection(const Input& in, int camera, PointFixedTo fixed_to) {
  if (in.scaled) return {*in.scaled, camera, fixed_to};
  return {in.estimate.rig, in.covariance, camera, fixed_to};
}

void summarise(ProjectionReport& report) {
  double sum = 0;
  int count = 0;
  report.worst_sd_px = -1;
  for (std::size_t i = 0; i < report.grid.covariance.size(); ++i) {
    const double sd = worst_sd(report.grid.covariance[i]);
    if (std::isnan(sd)) continue;
    sum += sd;
    ++count;
    if (sd <= report.worst_sd_px) continue;
    report.worst_sd_px = sd;
    report.worst_at_px = {report.grid.x_px[i % report.grid.columns],
                          report.grid.y_px[i / report.grid.columns]};
  }
  report.mean_sd_px = sum / count;  // NaN if no pixel has a ray
  if (count == 0) report.worst_sd_px = std::numeric_limits<double>::quiet_NaN();
}

void note_once(const std::string& note, std::vector<std::string>& notes) {
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
}

/// One camera and one point attachment, at all distances with the same samples.
void add_projection(const Input& in, int camera, PointFixedTo fixed_to, UncertaintyReport& out) {
  const UncertaintyRequest& request = out.request;
  const ProjectionUncertainty linear = linear_projection(in, camera, fixed_to);
  const Camera& lens = in.estimate.rig.cameras[camera];
  std::vector<double> distances = request.distances_m;
  if (fixed_to == PointFixedTo::camera) distances = {std::numeric_limits<double>::infinity()};
  std::vector<FixedPoint> points;
  for (const double distance_m : distances) {
    ProjectionReport report;
    report.camera = lens.name;
    report.fixed_to = fixed_to;
    report.distance_m = distance_m;
    report.grid = projection_grid(
        linear, {.columns = request.columns, .rows = request.rows, .distance_m = distance_m});
    summarise(report);
    if (report.grid.absent > 0 && distance_m == distances.front()) {
      const std::string note = fmt::format(
          "{} of {} grid pixels of the {} camera cannot be unprojected: the lens model has no ray "
          "there "
          "(its distortion folds over, or the ray is 89.5 degrees from the axis or beyond)",
          report.grid.absent, report.grid.covariance.size(), lens.name);
      note_once(note, out.notes);
    }
    for (const Place& place : reference_pixels(lens.size_px)) {
      report.figures.push_back({place, linear.covariance(place.pixel_px, distance_m), {}});
      const Eigen::Vector3d ray =
          try_unproject(lens, place.pixel_px).value_or(Eigen::Vector3d::UnitZ()).normalized();
      const bool far = std::isinf(distance_m);
      points.push_back({far ? ray : Eigen::Vector3d(distance_m * ray), far});
    }
    out.projection.push_back(std::move(report));
  }
  const auto sampled =
      sampled_projection(in.sampler, in.boards, camera, fixed_to, points, request.sampling);
  auto next = sampled.begin();
  for (auto report = out.projection.end() - static_cast<long>(distances.size());
       report != out.projection.end(); ++report) {
    for (ProjectionFigure& figure : report->figures) figure.sampled = *next++;
  }
}

void add_projections(const Input& in, UncertaintyReport& out) {
  const auto cameras = static_cast<int>(in.estimate.rig.cameras.size());
  if (in.boards) {
    for (int c = 0; c < cameras; ++c) add_projection(in, c, PointFixedTo::boards, out);
  } else {
    out.notes.push_back(
        "no projection uncertainty for points fixed to the boards (as in mrcal): the rig file has "
        "no board poses; calibrate from board views without --no-evidence");
  }
  for (int c = 0; c < cameras; ++c) add_projection(in, c, PointFixedTo::camera, out);
  for (int c = 1; c < cameras; ++c) add_projection(in, c, PointFixedTo::first_camera, out);
}

/// The reference pixels of the left camera that both cameras see at a distance; with `on_axis`, the
/// optical axis replaces the centre.
std::vector<std::pair<Place, PixelPair>> seen_pairs(const RigEstimate& pair,
                                                    double distance_m,
                                                    bool on_axis,
                                                    std::vector<std::string>& notes) {
  std::vector<std::pair<Place, PixelPair>> seen;
  const Camera& left = pair.rig.cameras[0];
  std::string unseen;
  for (Place place : reference_pixels(left.size_px)) {
    if (on_axis && place.name == "centre") {
      place = {"axis", project(left, Eigen::Vector3d::UnitZ())};
    }
    const auto q = pair_at_distance(pair.rig, place.pixel_px, distance_m);
    if (q) {
      seen.emplace_back(place, *q);
    } else {
      unseen += (unseen.empty() ? "" : ", ") + place.name;
    }
  }
  const std::string note = fmt::format("at {} m, not visible in the {} camera: {}", distance_m,
                                       pair.rig.cameras[1].name, unseen);
  if (!unseen.empty()) note_once(note, notes);
  return seen;
}

void add_triangulation(const Input& in, int other, UncertaintyReport& out) {
  const RigEstimate pair = pair_of(in.estimate, other);
  std::vector<std::pair<double, Place>> where;
  std::vector<PixelPair> pairs;
  for (const double distance_m : out.request.distances_m) {
    if (std::isinf(distance_m)) continue;
    for (const auto& [place, q] : seen_pairs(pair, distance_m, true, out.notes)) {
      where.emplace_back(distance_m, place);
      pairs.push_back(q);
    }
  }
  std::vector<TriangulationFrame> frames{TriangulationFrame::rig};
  if (in.boards) frames.push_back(TriangulationFrame::stabilised);
  const double sigma = out.request.pair_sigma_px;
  for (const TriangulationFrame frame : frames) {
    const auto linear = in.scaled ? TriangulationUncertainty(*in.scaled, frame, other)
                                  : TriangulationUncertainty(in.estimate.rig, in.covariance, other);
    const auto alone =
        sampled_triangulation(in.sampler, in.boards, frame, pairs, 0, out.request.sampling, other);
    const auto total = sampled_triangulation(in.sampler, in.boards, frame, pairs, sigma,
                                             out.request.sampling, other);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      out.triangulation.push_back({pair.rig.cameras[1].name, frame, where[k].first, where[k].second,
                                   pairs[k], linear.at(pairs[k], sigma).value(), alone[k],
                                   total[k]});
    }
  }
}

void add_vertical_disparity(const Input& in, int other, UncertaintyReport& out) {
  const RigEstimate pair = pair_of(in.estimate, other);
  const double psi2 = std::pow(out.request.sampling.psi_c, 2);
  const Eigen::MatrixXd C = psi2 * pair.covariance->matrix;
  const RigSampler sampler(pair);
  for (const double distance_m : out.request.distances_m) {
    DisparityReport report{
        pair.rig.cameras[1].name,
        distance_m,
        vertical_disparity_map(pair.rig, C, out.request.columns, out.request.rows, distance_m),
        std::numeric_limits<double>::quiet_NaN(),
        {}};
    for (const double sd : report.map.sd_px) report.worst_sd_px = std::fmax(report.worst_sd_px, sd);
    const auto seen = seen_pairs(pair, distance_m, false, out.notes);
    std::vector<PixelPair> pairs;
    pairs.reserve(seen.size());
    for (const auto& [place, q] : seen) pairs.push_back(q);
    const double f_px = report.map.rectified_f_px;
    const auto sampled = sampled_vertical_disparity(sampler, pairs, f_px, out.request.sampling);
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const auto J = vertical_disparity_by_rig(pair.rig, pairs[k], f_px);
      if (!J) continue;
      report.figures.push_back(
          {seen[k].first, std::sqrt((*J * C * J->transpose()).value()), sampled[k]});
    }
    out.vertical_disparity.push_back(std::move(report));
  }
}

void add_depth(const Input& in, int other, UncertaintyReport& out) {
  const RigEstimate pair = pair_of(in.estimate, other);
  std::vector<double> ranges{0.5, 1, 2, 3, 5, 7, 10, 15, 20};
  for (const double d : out.request.distances_m) {
    if (std::isfinite(d)) ranges.push_back(d);
  }
  std::sort(ranges.begin(), ranges.end());
  ranges.erase(std::unique(ranges.begin(), ranges.end()), ranges.end());
  std::vector<double> seen;
  for (const double range : ranges) {
    const auto q = pixel_pair(pair.rig, {0, 0, range});
    if (q && triangulate_point(pair.rig, *q)) seen.push_back(range);
  }
  out.depth.push_back(
      {pair.rig.cameras[1].name, depth_uncertainty(pair, seen, out.request.sampling)});
}

}  // namespace

UncertaintyReport uncertainty_report(const RigEstimate& estimate,
                                     const UncertaintyRequest& request,
                                     const std::string& place) {
  UncertaintyReport out;
  out.request = request;
  out.kind = required_covariance(estimate, place).kind;
  Input in{estimate, RigSampler(estimate, place), estimate.covariance->matrix, {}, {}};
  in.covariance *= std::pow(request.sampling.psi_c, 2);
  if (estimate.evidence && !estimate.evidence->observations.views.empty()) {
    in.boards = in.scaled = rig_and_boards(estimate, CovarianceChoice::honest, place);
    in.scaled->rig_covariance = in.covariance;
    in.scaled->board_sigma_px *= request.sampling.psi_c;
    out.board_sigma_px = in.boards->board_sigma_px;
  }
  add_projections(in, out);
  const auto cameras = static_cast<int>(estimate.rig.cameras.size());
  if (cameras == 1) {
    out.notes.push_back(
        "triangulation, rectification and depth need two cameras; this rig has one");
  }
  for (int other = 1; other < cameras; ++other) {
    add_triangulation(in, other, out);
    add_vertical_disparity(in, other, out);
    add_depth(in, other, out);
  }
  return out;
}

}  // namespace vernier::cli
