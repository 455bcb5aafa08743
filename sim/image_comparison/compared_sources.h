// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/image_comparison/edge_sample.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {

/// A setting of [sources] beside what the images show.
struct ComparedSource {
  std::string key;       ///< in [sources]
  MeasuredValue shown;   ///< unknown: too few samples
  double otherwise = 0;  ///< the simulator's default
  std::string note;
};

/// The settings that images of a known world can be asked about. Intervals are 95 %, by a bootstrap
/// over pairs; none with fewer than three. `matcher` is an index into the matchers compared.
std::vector<ComparedSource> compared_sources(const ComparedEdges& compared,
                                             std::size_t matcher,
                                             const MeasuringOptions& options = {});

/// The same as a file for a study's `[sources] file`; settings that could not be measured are left
/// out. `how` is a line that says what was rendered.
std::string compared_sources_toml(const std::vector<ComparedSource>& sources,
                                  const std::string& how);

}  // namespace vernier::sim::internal
