// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/pgh.h"

namespace vernier::localise::internal {

/// For every row of `queries` the largest dot product with a row of `stored`, and vice versa: for
/// square-rooted unit histograms, each line's best Bhattacharyya coefficient among the other view's
/// lines. Both matrices must have the same number of columns (else Error); an empty partner gives
/// zeros. One pass over `stored`; SIMD selected at run time (calib/base/instruction_set.h).
struct BestMatches {
  Eigen::VectorXf of_queries;
  Eigen::VectorXf of_stored;
};
BestMatches best_matches(const Eigen::Ref<const HistogramRows>& queries,
                         const Eigen::Ref<const HistogramRows>& stored);

}  // namespace vernier::localise::internal
