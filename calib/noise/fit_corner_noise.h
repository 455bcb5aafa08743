// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/restricted_likelihood.h"

namespace vernier::internal {

/// Components of the corner noise by restricted maximum likelihood.
struct NoiseFit {
  CornerNoise noise;
  NoiseParts parts;        ///< that were fitted
  NoiseSolution solution;  ///< at them
  bool converged = false;
  int iterations = 0;
};

/// From the size of the residuals; a field of this length.
CornerNoise usual_start(const RestrictedLikelihood& likelihood,
                        double spacing_m,
                        double field_spacings = 2);

/// Maximises the restricted likelihood over the logarithms of the components by scoring with the
/// average information (Gilmour, Thompson and Cullis 1995), damped after Levenberg and Marquardt
/// (Nocedal and Wright 2006, chapter 10). A component that is not there runs towards zero; a weak
/// prior (three powers of ten or more for each component) keeps it finite. Lengths of the field
/// stay between half and twenty spacings of the board's points. It ends where a further step would
/// lower −2 l by less than `least_gain`. Without a `start`, the better of two: the likelihood can
/// have a maximum with a short and one with a long field.
NoiseFit fit_corner_noise(const RestrictedLikelihood& likelihood,
                          double spacing_m,
                          const std::optional<CornerNoise>& start = {},
                          double least_gain = 1e-4);

/// The fit's components, those of the motion at the mean of their variance instead of its mode:
/// with v the variance of ln s by the information of the likelihood, s² has about ν = 1 / (2 v)
/// degrees of freedom, and given the data, with a flat prior of ln s, the mean s² ν / (ν − 2). What
/// few frames say of a motion is uncertain, and a covariance at the mode is too small: by that
/// factor, the variance of Student's t. ν is taken as 4 at least.
CornerNoise with_mean_motion(const RestrictedLikelihood& likelihood, const NoiseFit& fit);

}  // namespace vernier::internal
