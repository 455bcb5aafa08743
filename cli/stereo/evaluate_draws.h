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
  std::vector<double> psi_c;    ///< calibration errors to try; none: no draws
  std::vector<double> rows_px;  ///< and right images that lie so much lower
  int draws = 5;                ///< rigs of each scene and psi_c
  std::uint64_t seed = 1;
  int threads = 0;
};

/// What a matcher did on one pair that a wrong rig rectified; not a number: nothing to share.
struct DrawMetrics {
  double density, bad_1, mismatch, disparity_error_rms_px;
};

/// One kind of error, with and without repair: figures of every scene, draw and matcher.
struct ErrorCell {
  double psi_c = 0, rows_px = 0;
  bool repair = false;
  std::vector<std::vector<std::vector<DrawMetrics>>> figures;  ///< [scene][draw][matcher]
  std::vector<double> bias_rms_px, rows_rms_px;                ///< of every scene and draw
  int repaired = 0, pairs = 0;  ///< how many a vertical field was taken away from
  int not_physical = 0;         ///< draws without a pair: cameras exchanged, or no baseline
};

struct DrawTrial;  // what one draw gives

/// The evaluation of matchers under errors of calibration, scene by scene.
class EvaluationUnderError {
 public:
  EvaluationUnderError(const std::vector<Matcher>& matchers,
                       const EvaluationOptions& how,
                       const DrawOptions& options);

  /// All draws of a scene, from its own rig's covariance or the nominal one's, resized; whatever
  /// vertical field the pair has of itself is taken away before. Throws Error naming the rig's
  /// file.
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
  std::vector<std::string> rigs_;  ///< one a scene, where draws are wanted
  std::uint32_t scenes_ = 0;
};

}  // namespace vernier::cli
