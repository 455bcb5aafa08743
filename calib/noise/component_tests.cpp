// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/component_tests.h"

#include <array>
#include <optional>
#include <utility>

#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/statistics/distributions.h"

namespace vernier::internal {
namespace {

constexpr double least_ratio = 1e-3;  // fits end 1e-4 of −2 l above the maximum

double ratio_of(double minus_two_log, double minus_two_log_without) {
  const double ratio = minus_two_log_without - minus_two_log;
  return ratio > least_ratio ? ratio : 0;
}

/// Two variances, each on the edge of its range.
ComponentTest two_variances_test(double minus_two_log, double minus_two_log_without) {
  const double ratio = ratio_of(minus_two_log, minus_two_log_without);
  if (!(ratio > 0)) return {};
  return {ratio, 0.5 * chi_squared_survival(ratio, 1) + 0.25 * chi_squared_survival(ratio, 2)};
}

/// The part's components of `from`, the others of `noise`.
CornerNoise with_part(CornerNoise noise, bool NoiseParts::*part, const CornerNoise& from) {
  if (part == &NoiseParts::motion) {
    noise.motion_rad = from.motion_rad;
    noise.motion_m = from.motion_m;
  } else if (part == &NoiseParts::shape) {
    noise.shape_plane_m = from.shape_plane_m;
    noise.shape_height_m = from.shape_height_m;
  } else {
    noise.field_px = from.field_px;
    noise.field_length_m = from.field_length_m;
  }
  return noise;
}

/// One with all parts, and those without one of them.
class NestedFits {
 public:
  NestedFits(const LikelihoodOf& likelihood_of, NoiseParts parts, double spacing_m)
      : likelihood_of_(likelihood_of),
        spacing_m_(spacing_m),
        all_(likelihood_of(parts)),
        start_(usual_start(all_, spacing_m)),
        fit_(fit_corner_noise(all_, spacing_m)) {}

  const NoiseFit& fit() const { return fit_; }

  /// −2 l without a part.
  double without(bool NoiseParts::*part) {
    NoiseParts fewer = fit_.parts;
    fewer.*part = false;
    const NoiseFit less = fit_corner_noise(likelihood_of_(fewer), spacing_m_, fit_.noise);
    NoiseFit again =
        fit_corner_noise(all_, spacing_m_, with_part(less.noise, part, start_));
    if (again.solution.minus_two_log < fit_.solution.minus_two_log) fit_ = std::move(again);
    return less.solution.minus_two_log;
  }

  /// With 0 for shape and motion that are not in `found`; the solution is that of next to nothing.
  NoiseFit with(NoiseParts found) const {
    constexpr double next_to_nothing = 1e-9;
    NoiseFit fit = fit_corner_noise(likelihood_of_(found), spacing_m_, fit_.noise);
    fit.parts = fit_.parts;
    CornerNoise there = fit.noise;
    if (fit.parts.motion && !found.motion) {
      fit.noise.motion_rad = fit.noise.motion_m = 0;
      there.motion_rad = there.motion_m = next_to_nothing;
    }
    if (fit.parts.shape && !found.shape) {
      fit.noise.shape_plane_m = fit.noise.shape_height_m = 0;
      there.shape_plane_m = there.shape_height_m = next_to_nothing;
    }
    fit.solution = all_.at(there, RestrictedLikelihood::Want::solution);
    return fit;
  }

 private:
  const LikelihoodOf& likelihood_of_;
  double spacing_m_;
  RestrictedLikelihood all_;
  CornerNoise start_;
  NoiseFit fit_;
};

}  // namespace

ComponentTest motion_test(double minus_two_log, double minus_two_log_without) {
  return two_variances_test(minus_two_log, minus_two_log_without);
}

ComponentTest shape_test(double minus_two_log, double minus_two_log_without) {
  return two_variances_test(minus_two_log, minus_two_log_without);
}

ComponentTest field_test(double minus_two_log, double minus_two_log_without) {
  const double ratio = ratio_of(minus_two_log, minus_two_log_without);
  if (!(ratio > 0)) return {};
  return {ratio, 0.5 * chi_squared_survival(ratio, 1) + 0.5 * chi_squared_survival(ratio, 2)};
}

TestedNoise fit_and_test(const LikelihoodOf& likelihood_of,
                         NoiseParts parts,
                         NoiseParts tested,
                         double spacing_m) {
  NestedFits fits(likelihood_of, parts, spacing_m);
  const NoiseParts there = fits.fit().parts;
  std::optional<double> motion, field, shape;
  if (there.shape && tested.shape) shape = fits.without(&NoiseParts::shape);
  if (there.motion && tested.motion) motion = fits.without(&NoiseParts::motion);
  if (there.field && tested.field) field = fits.without(&NoiseParts::field);
  TestedNoise result{fits.fit(), {}, {}, {}};
  const double all = result.fit.solution.minus_two_log;
  if (shape) result.shape = shape_test(all, *shape);
  if (motion) result.motion = motion_test(all, *motion);
  if (field) result.field = field_test(all, *field);
  NoiseParts found = there;
  if (result.shape && !(result.shape->ratio > 0)) found.shape = false;
  if (result.motion && !(result.motion->ratio > 0)) found.motion = false;
  if (found.shape != there.shape || found.motion != there.motion) result.fit = fits.with(found);
  return result;
}

}  // namespace vernier::internal
