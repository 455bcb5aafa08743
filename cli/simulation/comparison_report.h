// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "sim/image_comparison/compared_sources.h"
#include "sim/image_comparison/comparison_figures.h"
#include "sim/image_comparison/edge_sample.h"

namespace vernier::cli {

/// All that `vernier render --compare` says.
struct ComparisonReport {
  std::vector<std::string> matchers;
  int pairs = 0, false_segments = 0;
  double unseen_again = 0;  ///< of edges unseen in one view, in another
  std::vector<ComparedSource> sources;
  EdgeFigures all;
  std::vector<ComparisonTable> tables;
  std::string how;  ///< what was rendered, in a line
};

/// Figures of the edges compared, intervals by a bootstrap with this seed.
ComparisonReport comparison_report(const ComparedEdges& compared,
                                   const std::string& how,
                                   std::uint64_t seed);

Json comparison_json(const ComparisonReport& report);
std::string comparison_text(const ComparisonReport& report);
/// A page of its own: charts as SVG, and the tables.
std::string comparison_page(const ComparisonReport& report);

}  // namespace vernier::cli
