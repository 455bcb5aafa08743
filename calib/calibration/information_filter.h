// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/combine.h"
#include "calib/covariance.h"
#include "calib/rig.h"

namespace vernier::internal {

/// The information filter of Thacker and Mayhew (1991): batch by batch, only a mean and a
/// covariance are kept, linearised where each batch left them.
struct InformationFilterResult {
  Rig rig;
  Covariance covariance;        ///< the filter's bound
  double worst_in_sigma = 0;    ///< its largest distance from the batch solution …
  std::string worst_parameter;  ///< … in that one's bound, and of which parameter
  double min_sigma_ratio = 1;   ///< smallest of its standard deviations over the batch's …
  std::string min_parameter;    ///< … and of which parameter
};
InformationFilterResult information_filter(const std::vector<CombineInput>& inputs,
                                           const Combination& batch,
                                           const CombineOptions& options = {});

}  // namespace vernier::internal
