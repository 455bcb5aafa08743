// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/rig.h"

namespace vernier::test {

/// The same residual in its textbook form, one pair at a time: rays by unproject(), the pixels'
/// share of the variance by numeric derivatives.
double textbook_sampson(const Rig& rig, const Eigen::Vector4d& y, double sigma);

/// The smallest distance, in standard deviations, that moves a pair of pixels onto the projections
/// of one point: bundle adjustment of one point by Gauss and Newton's steps.
double bundle_distance(const Rig& rig, const Eigen::Vector4d& y, double sigma);

}  // namespace vernier::test
