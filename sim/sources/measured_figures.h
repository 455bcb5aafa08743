// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_sources.h"
#include "stereo/evaluation/pair_samples.h"

/// Parts of measure_sources, one statistic each. Not installed.
namespace vernier::sim::internal {

using PairList = std::vector<stereo::internal::PairSamples>;

MeasuredEdgeLoss measured_edge_loss(const PairList&, const ClusterOf&, const MeasuringOptions&);
MeasuredLateralShift measured_lateral_shift(const PairList&,
                                            const ClusterOf&,
                                            const MeasuringOptions&);
MeasuredEndpoints measured_endpoints(const PairList&, const ClusterOf&, const MeasuringOptions&);
MeasuredCorners measured_corners(const PairList&, const ClusterOf&, const MeasuringOptions&);
MeasuredStereoMismatch measured_stereo_mismatch(const PairList&,
                                                const ClusterOf&,
                                                const MeasuringOptions&);

}  // namespace vernier::sim::internal
