// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "sim/sensed_view.h"
#include "sim/sources.h"

namespace vernier::sim {

/// One source of geometric error. Sources act in a fixed order on the noise-free view of the true
/// rig; each draws from its own stream, keyed by the feature it acts on, so that enabling or
/// disabling one does not change the draws of the others.
class UncertaintySource {
 public:
  virtual ~UncertaintySource() = default;
  virtual std::string_view name() const = 0;
  virtual void apply(const SensingContext& context, SensedView& view) const = 0;
};

/// The sources enabled by these settings, in order: lateral shift, edge loss, end-point error,
/// epipolar rejection, stereo mismatch, corner loss, corner mismatch. (The memo's seventh source,
/// calibration, acts on the rig assumed by the estimator: see RigSampler.)
std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& settings,
                                                                 double min_length_px);

}  // namespace vernier::sim
