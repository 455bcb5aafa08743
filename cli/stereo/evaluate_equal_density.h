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

/// The first matcher against the others where both leave out as much, scene by scene. OpenCV's have
/// their settings swept, and the best is kept; the others are cut by their own confidence.
class EvaluationAtEqualDensity {
 public:
  explicit EvaluationAtEqualDensity(const std::vector<Matcher>& matchers);

  /// What the first matcher found on the scene is `own`, what all of them found is `runs`.
  void add(const Scene& scene, const std::vector<Run>& runs, const EvaluationOptions& how);

  /// Of each other matcher.
  Json json() const;
  /// Points (density, bad 1, mismatch) of each matcher's curve, means over the scenes.
  Json curves() const;
  /// What json() says, in lines.
  static std::string text(const Json& json);

 private:
  struct ComparedMatcher {
    std::string name;
    std::vector<std::string> settings;
    std::vector<std::vector<Matcher>> sweeps;  ///< matchers of each setting; none: by confidence
    std::vector<DensityCurves> scenes;
    std::vector<std::string> left_out;  ///< scenes where one of the two finds nothing
  };
  const std::vector<Matcher>& matchers_;
  std::vector<ComparedMatcher> peers_;
};

}  // namespace vernier::cli
