// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"
#include "cli/stereo/evaluate_scene.h"
#include "stereo/evaluation/equal_density.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::cli {

/// Compares the first matcher with the others at equal density, scene by scene. OpenCV's settings
/// are swept and the best is kept; the others are thresholded by their own confidence.
class EvaluationAtEqualDensity {
 public:
  explicit EvaluationAtEqualDensity(const std::vector<Matcher>& matchers);

  /// Adds a scene with the results `runs` of all matchers.
  void add(const Scene& scene, const std::vector<Run>& runs, const EvaluationOptions& how);

  /// Comparison with each other matcher.
  Json json() const;
  /// Points (density, bad 1, mismatch) of each matcher's curve, averaged over the scenes.
  Json curves() const;
  /// Formats the result of json() as text.
  static std::string text(const Json& json);

 private:
  struct ComparedMatcher {
    std::string name;
    std::vector<std::string> settings;
    std::vector<std::vector<Matcher>> sweeps;  ///< matchers of each setting; empty: by confidence
    std::vector<DensityCurves> scenes;
    std::vector<std::string> left_out;  ///< scenes in which one of the two finds nothing
  };
  const std::vector<Matcher>& matchers_;
  std::vector<ComparedMatcher> peers_;
};

}  // namespace vernier::cli
