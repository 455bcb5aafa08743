// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/restricted_likelihood.h"

namespace vernier::internal {

/// The test that a group of components is absent, by twice the ratio of restricted likelihoods. On
/// the boundary of the parameters it is, for white noise alone, at most as large as a mixture of
/// chi-squared variables (Self and Liang 1987; Stram and Lee 1994):
///
///     motion   ¼ χ²_0 + ½ χ²_1 + ¼ χ²_2
///     motion, with a variance of its own along the baseline
///              ⅛ χ²_0 + ⅜ χ²_1 + ⅜ χ²_2 + ⅛ χ²_3
///     shape    ¼ χ²_0 + ½ χ²_1 + ¼ χ²_2
///     field    ½ χ²_1 + ½ χ²_2     (ℓ has no meaning without a field, so this is an approximation
///                                   to the largest over ℓ: Davies 1987)
///
/// That the motion is isotropic is no edge: χ²_1. A ratio below what the fits leave open (0.001) is
/// 0.
struct ComponentTest {
  double ratio = 0;  ///< 2 (l − l_without), not below 0
  double p_value = 1;
};

ComponentTest motion_test(double minus_two_log, double minus_two_log_without);
ComponentTest baseline_motion_test(double minus_two_log, double minus_two_log_without);
ComponentTest isotropy_test(double minus_two_log, double minus_two_log_isotropic);
ComponentTest shape_test(double minus_two_log, double minus_two_log_without);
ComponentTest field_test(double minus_two_log, double minus_two_log_without);

/// A fit with all parts asked for, and the tests of some of them.
struct TestedNoise {
  NoiseFit fit;  ///< a shape or motion whose ratio is 0 has components of 0
  std::optional<ComponentTest> motion;
  std::optional<ComponentTest> field;
  std::optional<ComponentTest> shape;
  std::optional<ComponentTest> isotropy;  ///< that the motion is alike in all directions

  /// Isotropy is rejected at 5 %: a choice between two models of a motion.
  bool is_along_baseline() const;
};

/// The likelihood of a calibration's corners with these parts.
using LikelihoodOf = std::function<RestrictedLikelihood(NoiseParts)>;

/// Fits with and without each part that is in `tested`. Models are nested, so that the one with a
/// part is also fitted from where that without it ended, and is the better of the two: the
/// likelihood can have several maxima. With baseline_motion among the parts the fit has it where
/// isotropy is rejected.
TestedNoise fit_and_test(const LikelihoodOf& likelihood_of,
                         NoiseParts parts,
                         NoiseParts tested,
                         double spacing_m);

}  // namespace vernier::internal
