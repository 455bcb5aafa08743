// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/view_likelihood.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "calib/base/plane_vectors.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/sources/common_shift.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using stereo::ImageSegment;
using stereo::StereoSegment;
using vernier::internal::cross;

namespace {

constexpr double impossible = -50;    ///< nats: of an edge that nothing explains, of a lost one
constexpr double least_sigma = 0.05;  ///< px: without end-point noise, rounding remains

double log_sum(double a, double b) {
  const double most = std::max(a, b);
  return most + std::log(std::exp(a - most) + std::exp(b - most));
}

/// Signed distances of both ends of `part` from the line of `whole`, and their places along it.
struct OnLine {
  std::array<double, 2> across, along;
};
OnLine on_line(const ImageSegment& part, const ImageSegment& whole) {
  const Eigen::Vector2d u = (whole.b_px - whole.a_px).normalized();
  OnLine result{};
  const std::array ends{part.a_px, part.b_px};
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector2d d = ends[i] - whole.a_px;
    result.along[i] = u.dot(d);
    result.across[i] = cross(u, d);
  }
  return result;
}

}  // namespace

ViewLikelihood::ViewLikelihood(Rig rig, const SourceSettings& sources, double min_length_px)
    : rig_(std::move(rig)),
      rectification_(stereo::rectification(rig_)),
      sources_(sources),
      min_length_px_(min_length_px),
      sigma_px_(std::max(least_sigma, sources.endpoint_sigma_px)) {
  if (sources.lateral_shift_mode == ShiftMode::independent) {
    throw Error("sources.lateral_shift_mode", "the likelihood knows common shifts only",
                "use \"common\"");
  }
}

ViewLikelihood::Seen ViewLikelihood::seen(const VisibleEdge& edge) const {
  Seen result{};
  for (int eye = 0; eye < 2; ++eye) {
    const Camera& camera = rig_.cameras[static_cast<std::size_t>(eye)];
    const Pose T = eye == 0 ? Pose{} : rig_.T_camera_first[1];
    result.image[eye] = {project(camera, T * edge.a_m), project(camera, T * edge.b_m)};
  }
  const Eigen::Vector3d n = edge.a_m.cross(edge.b_m);
  result.side = n.dot(edge.object_centre_m) > 0 ? -1 : 1;
  result.object = edge.object;
  result.right_by_left = right_by_left_shift(rig_, edge.a_m, edge.b_m);
  const double slope_deg = epipolar_angle_rad(rig_, rectification_, result.image[0]).value_or(0) *
                           180 / std::numbers::pi;
  result.certain = slope_deg > sources_.epipolar_reject_deg + 3 &&
                   (1 - sources_.edge_loss) * result.image[0].length_px() > 2.5 * min_length_px_;
  return result;
}

/// Log-density of an estimate of an outward shift with this information, 1 of one left end.
double ViewLikelihood::shift_density(double mean_px, double information) const {
  const double tau = sigma_px_ / std::sqrt(information), size = sources_.lateral_shift_px;
  if (!(size > 0)) {
    return -0.5 * mean_px * mean_px / (tau * tau) - std::log(tau * std::sqrt(2 * std::numbers::pi));
  }
  const auto below = [&](double x) { return 0.5 * std::erfc(-(mean_px - x) / tau / std::sqrt(2)); };
  const double density = (below(0.5 * size) - below(1.5 * size)) / size;
  return std::log(std::max(density, 1e-300));
}

ViewLikelihood::Fit ViewLikelihood::fit(const StereoSegment& sensed, const Seen& edge) const {
  const OnLine left = on_line(sensed.left, edge.image[0]);
  const OnLine right = on_line(sensed.right, edge.image[1]);
  const double length = edge.image[0].length_px(), beyond = 4 * sigma_px_ + 1;
  const Fit none{impossible, impossible};
  if (std::min(left.along[0], left.along[1]) < -beyond ||
      std::max(left.along[0], left.along[1]) > length + beyond) {
    return none;
  }
  const std::array d{left.across[0], left.across[1], right.across[0], right.across[1]};
  const std::array gain{1.0, 1.0, edge.right_by_left, edge.right_by_left};  // of a common shift
  const auto of_ends = [&](std::size_t ends, double sign) {
    double mean = 0, information = 0, scatter = 0;
    for (std::size_t k = 0; k < ends; ++k) {
      information += gain[k] * gain[k];
      mean += gain[k] * d[k];
    }
    mean /= information;
    for (std::size_t k = 0; k < ends; ++k) {
      scatter += (d[k] - gain[k] * mean) * (d[k] - gain[k] * mean);
    }
    const double norm = std::log(sigma_px_ * std::sqrt(2 * std::numbers::pi));
    return -0.5 * scatter / (sigma_px_ * sigma_px_) - static_cast<double>(ends - 1) * norm -
           0.5 * std::log(information) + shift_density(sign * mean, information);
  };
  const double wrong = sources_.stereo_mismatch;
  const double apart = 2 * std::max(1.0, sources_.stereo_mismatch_px);
  const auto both = [&](double sign) {
    const double partner = std::log(1 - wrong) + of_ends(4, sign);
    if (!(wrong > 0)) return std::max(impossible, partner - 2 * std::log(length));
    const double other = std::log(wrong) + of_ends(2, sign) - 2 * std::log(apart);
    return std::max(impossible, log_sum(partner, other) - 2 * std::log(length));
  };
  return {both(edge.side), both(-edge.side)};
}

double ViewLikelihood::log_likelihood(const std::vector<StereoSegment>& sensed,
                                      const NoiseFreeView& view) const {
  std::vector<Seen> edges;
  for (const VisibleEdge& edge : view.edges) edges.push_back(seen(edge));
  std::vector<char> found(edges.size(), 0);
  std::map<int, Fit> of_object;
  double sum = 0;
  for (const StereoSegment& segment : sensed) {
    double best = impossible;
    int partner = -1;
    Fit of_partner{};
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Fit tried = fit(segment, edges[i]);
      const double either = log_sum(tried.outward, tried.inward) - std::log(2);
      if (either <= best) continue;
      best = either;
      partner = static_cast<int>(i);
      of_partner = tried;
    }
    if (partner < 0) {
      sum += impossible;
      continue;
    }
    const Seen& edge = edges[static_cast<std::size_t>(partner)];
    found[static_cast<std::size_t>(partner)] = 1;
    if (edge.object == 0) {  // loose edges have signs of their own
      sum += best;
      continue;
    }
    Fit& object = of_object[edge.object];
    object.outward += of_partner.outward;
    object.inward += of_partner.inward;
  }
  for (const auto& [object, fits] : of_object) {
    sum += log_sum(fits.outward, fits.inward) - std::log(2);
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!found[i] && edges[i].certain) sum += 0.2 * impossible;
  }
  return sum;
}

}  // namespace vernier::sim::internal
