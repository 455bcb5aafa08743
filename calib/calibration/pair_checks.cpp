// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/pair_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibration/bent_plane.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/pair_sides.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

/// Number of pairs of an image pair that are used at most.
constexpr std::size_t enough_pairs = 200;

/// Whether a plane explains almost all pairs within their noise. The lenses of an approximate rig
/// bend it, in directions that pairs on a plane cannot show, so both images get an r² term.
bool on_a_plane(const PairObservations& pairs,
                const ImagePair& image,
                const Rig& rig,
                double sigma_scale) {
  std::vector<PointPair> points;
  const double f = rig.cameras[1].f_px();
  std::vector<double> sigmas;
  const std::size_t step = std::max<std::size_t>(1, image.count / enough_pairs);
  for (std::size_t i = image.first; i < image.first + image.count; i += step) {
    const auto l = try_unproject(rig.cameras[0], pairs.pixels_px[i].head<2>());
    const auto r = try_unproject(rig.cameras[1], pairs.pixels_px[i].tail<2>());
    if (!l || !r) continue;
    points.push_back({l->head<2>(), r->head<2>()});
    sigmas.push_back(sigma_scale * pairs.sigma_of(i));
  }
  if (points.size() < fewest_judged_matches) return false;
  // Noise of both images in two coordinates: beyond four standard deviations once in 3000.
  return fraction_on_distorted_plane(
             points, 4 * std::sqrt(2.0) * quantile(sigmas, 0.5, QuantileKind::lower) / f) >= 0.95;
}

void check_rays(const PairObservations& pairs, const Rig& rig, const std::string& place) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (int c = 0; c < 2; ++c) {
      if (try_unproject(rig.cameras[static_cast<std::size_t>(c)],
                        pairs.pixels_px[i].segment<2>(2 * c))) {
        continue;
      }
      throw Error(
          place.empty() ? fmt::format("pair {}", i + 1) : fmt::format("{}:{}", place, i + 2),
          "the prior's " + rig.cameras[static_cast<std::size_t>(c)].name +
              " lens model cannot be inverted there (its distortion folds the image)",
          "use a prior whose distortion is valid up to the image's edge");
    }
  }
}

}  // namespace

void check_sides(const PairObservations& pairs,
                 const Rig& rig,
                 const Eigen::MatrixXd& covariance,
                 const std::string& place) {
  check_rays(pairs, rig, place);
  const SideCounts sides = count_sides(pairs, rig, covariance);
  if (sides.swapped.empty()) return;
  throw Error(place.empty() ? "pairs" : place,
              sides.swapped.size() == sides.judged
                  ? "left and right are swapped: the corners lie behind the rig"
              : 2 * sides.swapped.size() > sides.judged && sides.right == 0
                  ? fmt::format("left and right are swapped: the corners of {} of {} image pairs "
                                "lie behind the rig, the others are ambiguous",
                                sides.swapped.size(), sides.judged)
                  : fmt::format("left and right are swapped in image pairs {}: their corners lie "
                                "behind the rig",
                                fmt::join(sides.swapped, ", ")),
              "exchange the images, or the cameras of the prior");
}

ObservationDiagnosis check_scene(const PairObservations& pairs,
                                 const Rig& rig,
                                 double sigma_scale) {
  std::size_t judged = 0, flat = 0;
  for (const ImagePair& image : pairs.image_pairs) {
    if (image.count < fewest_judged_matches) continue;
    ++judged;
    flat += on_a_plane(pairs, image, rig, sigma_scale);
  }
  ObservationDiagnosis diagnosis;
  if (judged > 0 && flat == judged) {
    diagnosis.trust_warnings.emplace_back(
        "the corners of every image pair lie on one plane, or too far away for parallax: more of "
        "the rig is determined by the prior alone; use images of a scene with depth");
  } else if (2 * flat > judged) {
    diagnosis.warnings.push_back(fmt::format(
        "in {} of {} image pairs all corners lie on one plane, or too far away for parallax", flat,
        judged));
  }
  return diagnosis;
}

}  // namespace vernier::internal
