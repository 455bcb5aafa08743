// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "cli/stereo/evaluate_scene.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::cli {

struct DrawOptions {
  std::vector<double> psi_c;    ///< calibration errors to simulate; empty: none
  std::vector<double> rows_px;  ///< downward shifts of the right image to simulate
  int draws = 5;                ///< rigs per scene and psi_c
  std::uint64_t seed = 1;
  int threads = 0;
};

/// A matcher's metrics on one pair rectified with a wrong rig; NaN if undefined.
struct DrawMetrics {
  double density, bad_1, mismatch, disparity_error_rms_px;
};

/// One kind of error, with or without repair: metrics of every scene, sample and matcher.
struct ErrorCell {
  double psi_c = 0, rows_px = 0;
  bool repair = false;
  std::vector<std::vector<std::vector<DrawMetrics>>> figures;  ///< [scene][draw][matcher]
  std::vector<double> bias_rms_px, rows_rms_px;                ///< per scene and sample
  int repaired = 0, pairs = 0;  ///< number of pairs with corrected misalignment
  int not_physical = 0;         ///< samples without a pair: cameras swapped or no baseline
};

struct DrawTrial;  // the result of one sample

/// Evaluates matchers under calibration errors, scene by scene.
class EvaluationUnderError {
 public:
  EvaluationUnderError(const std::vector<Matcher>& matchers,
                       const EvaluationOptions& how,
                       const DrawOptions& options);

  /// Runs all samples of a scene, from the covariance of its own rig or of the resized nominal rig;
  /// the pair's own vertical misalignment is corrected first. Throws Error naming the rig file.
  void add(const Scene& scene, Session& session);

  bool wanted() const { return !cells_.empty(); }
  Json json() const;
  std::string text() const;

 private:
  void take(const std::vector<DrawTrial>& trials, std::size_t repaired, ErrorCell& cell) const;

  const std::vector<Matcher>& matchers_;
  EvaluationOptions how_;
  DrawOptions options_;
  std::vector<ErrorCell> cells_;
  std::vector<std::string> rigs_;  ///< one per scene, if samples are requested
  std::uint32_t scenes_ = 0;
};

}  // namespace vernier::cli
