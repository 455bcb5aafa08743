// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/component_tests.h"

#include <cmath>
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

/// The part's components of `from`, the others of `noise`; the motion along the baseline is as
/// large as that across it.
CornerNoise with_part(CornerNoise noise, bool NoiseParts::*part, const CornerNoise& from) {
  if (part == &NoiseParts::motion) {
    noise.motion_rad = from.motion_rad;
    noise.motion_m = from.motion_m;
    noise.motion_baseline_m = from.motion_baseline_m;
  } else if (part == &NoiseParts::shape) {
    noise.shape_plane_m = from.shape_plane_m;
    noise.shape_height_m = from.shape_height_m;
  } else if (part == &NoiseParts::field) {
    noise.field_px = from.field_px;
    noise.field_length_m = from.field_length_m;
  } else {
    noise.motion_baseline_m = noise.motion_m;
  }
  return noise;
}

/// A start without `part`: an isotropic motion is as large as the other in the mean of the axes.
CornerNoise start_without(bool NoiseParts::*part, CornerNoise noise) {
  if (part != &NoiseParts::baseline_motion) return noise;
  const double along = noise.motion_baseline_m, across = noise.motion_m;
  noise.motion_m = std::sqrt((along * along + 2 * across * across) / 3);
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

  NoiseFit without(bool NoiseParts::*part) {
    NoiseParts fewer = fit_.parts;
    fewer.*part = false;
    NoiseFit less =
        fit_corner_noise(likelihood_of_(fewer), spacing_m_, start_without(part, fit_.noise));
    NoiseFit again = fit_corner_noise(all_, spacing_m_, with_part(less.noise, part, start_));
    if (again.solution.minus_two_log < fit_.solution.minus_two_log) fit_ = std::move(again);
    return less;
  }

 private:
  const LikelihoodOf& likelihood_of_;
  double spacing_m_;
  RestrictedLikelihood all_;
  CornerNoise start_;
  NoiseFit fit_;
};

/// The components of `fit`, with 0 for the shape and motion whose ratio is 0; the solution is that
/// of next to nothing.
NoiseFit with_what_is_there(const NoiseFit& fit,
                            const LikelihoodOf& likelihood_of,
                            const TestedNoise& tests,
                            double spacing_m) {
  constexpr double next_to_nothing = 1e-9;
  const auto absent = [](const std::optional<ComponentTest>& t) { return t && !(t->ratio > 0); };
  const bool no_motion = absent(tests.motion), no_shape = absent(tests.shape);
  if (!no_motion && !no_shape) return fit;
  NoiseParts found = fit.parts;
  found.motion = found.motion && !no_motion;
  found.shape = found.shape && !no_shape;
  NoiseFit fewer = fit_corner_noise(likelihood_of(found), spacing_m, fit.noise);
  fewer.parts = fit.parts;
  CornerNoise near = fewer.noise;
  if (no_motion) near.motion_rad = near.motion_m = near.motion_baseline_m = next_to_nothing;
  if (no_shape) near.shape_plane_m = near.shape_height_m = next_to_nothing;
  fewer.solution = likelihood_of(fit.parts).at(near, RestrictedLikelihood::Want::solution);
  return fewer;
}

}  // namespace

ComponentTest motion_test(double minus_two_log, double minus_two_log_without) {
  return two_variances_test(minus_two_log, minus_two_log_without);
}

ComponentTest baseline_motion_test(double minus_two_log, double minus_two_log_without) {
  const double ratio = ratio_of(minus_two_log, minus_two_log_without);
  if (!(ratio > 0)) return {};
  return {ratio, 0.375 * chi_squared_survival(ratio, 1) + 0.375 * chi_squared_survival(ratio, 2) +
                     0.125 * chi_squared_survival(ratio, 3)};
}

ComponentTest isotropy_test(double minus_two_log, double minus_two_log_isotropic) {
  const double ratio = ratio_of(minus_two_log, minus_two_log_isotropic);
  if (!(ratio > 0)) return {};
  return {ratio, chi_squared_survival(ratio, 1)};
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
  std::optional<NoiseFit> isotropic;
  const auto without = [&](bool NoiseParts::*part) {
    return fits.without(part).solution.minus_two_log;
  };
  if (there.shape && tested.shape) shape = without(&NoiseParts::shape);
  if (there.motion && tested.motion) motion = without(&NoiseParts::motion);
  if (there.field && tested.field) field = without(&NoiseParts::field);
  if (there.baseline_motion) isotropic = fits.without(&NoiseParts::baseline_motion);
  TestedNoise result{fits.fit(), {}, {}, {}, {}};
  const double all = result.fit.solution.minus_two_log;
  if (shape) result.shape = shape_test(all, *shape);
  if (motion) result.motion = (isotropic ? baseline_motion_test : motion_test)(all, *motion);
  if (field) result.field = field_test(all, *field);
  if (isotropic) {
    result.isotropy = isotropy_test(all, isotropic->solution.minus_two_log);
    if (!result.is_along_baseline()) result.fit = std::move(*isotropic);
  }
  result.fit = with_what_is_there(result.fit, likelihood_of, result, spacing_m);
  return result;
}

bool TestedNoise::is_along_baseline() const {
  constexpr double level = 0.05;
  return isotropy && isotropy->p_value < level;
}

}  // namespace vernier::internal
