// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "calib/rig_estimate.h"

namespace vernier {

/// Which of an estimate's two covariances is meant: the honest one (what is sampled) or the minimum
/// variance bound (what mrcal reports).
enum class CovarianceChoice { honest, mvb };

/// honest is the estimate's `covariance`, mvb its `covariance_mvb` (or the former where that is of
/// kind mvb); nothing where it has no such.
std::optional<Covariance> chosen_covariance(const RigEstimate& estimate, CovarianceChoice choice);

/// The same; throws Error(`place`) where it has no such.
Covariance required_covariance(const RigEstimate& estimate,
                               CovarianceChoice choice,
                               const std::string& place);

}  // namespace vernier
