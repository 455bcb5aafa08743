// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/study/study_keys.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

/// What six trials gave when the versions were set: pose and score of each; -1 without an answer.
struct Frozen {
  const char* name;
  ExperimentSettings settings;
  std::vector<double> numbers;
};

ExperimentSettings settings(const char* method) {
  ExperimentSettings s;
  s.method = method;
  s.protocol = QueryProtocol::path;
  s.seed = 606;
  return s;
}

/// Sources that are off by default, large enough to show in six trials.
ExperimentSettings with_every_source() {
  ExperimentSettings s = settings("pgh");
  s.sources.moved = 0.2;
  s.sources.mount_height_m = 0.02;
  s.sources.mount_pitch_deg = s.sources.mount_roll_deg = 0.5;
  s.sources.unseen = 0.05;
  s.sources.missed = 0.1;
  s.sources.missed_alike = 0.3;
  s.sources.clutter = 0.2;
  s.sources.merge_px = 3;
  s.sources.lateral_shift_mode = ShiftMode::independent;
  return s;
}

std::vector<double> numbers_of(const ExperimentSettings& s) {
  const Visibility& office = test::small_office_visibility();
  const RigEstimate& rig = test::nominal_rig();
  const LocalisationExperiment experiment(
      office, rig, std::make_shared<MapViews>(map_views(office, rig.rig, s)), s);
  std::vector<double> numbers;
  for (const TrialResult& t : experiment.run_block({.block = 0, .first = 0, .count = 6})) {
    if (!std::isfinite(t.error_m)) {
      numbers.push_back(-1);
      continue;
    }
    for (const double number : {t.answer.x_m, t.answer.y_m, t.answer.heading_rad, t.score}) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

// Results are stored under keys that hold these versions. A trial that gives something else under
// the same key would be mixed with older ones, without a word.
TEST(ResultsVersion, TrialsGiveWhatTheyGaveWhenItWasSet) {
  EXPECT_EQ(results_version, 2) << "freeze the numbers below anew";
  EXPECT_EQ(lines_version, 5) << "freeze the numbers of `lines` anew";
  const std::vector<Frozen> frozen{
      {"lines", settings("lines"), {}},
      {"corners", settings("corners"), {}},
      {"pgh", settings("pgh"), {}},
      {"pgh_baseline", settings("pgh_baseline"), {}},
      {"pgh_baseline_vectorised", settings("pgh_baseline_vectorised"), {}},
      {"every source", with_every_source(), {}},
  };
  for (const Frozen& f : frozen) {
    const std::vector<double> now = numbers_of(f.settings);
    std::string text;
    for (const double number : now) text += std::to_string(number) + ", ";
    bool same = now.size() == f.numbers.size();
    for (std::size_t i = 0; same && i < now.size(); ++i) {
      // Another instruction set rounds otherwise.
      same = std::abs(now[i] - f.numbers[i]) <= 2e-6 * std::max(1.0, std::abs(f.numbers[i]));
    }
    EXPECT_TRUE(same) << "results of " << f.name
                      << " changed. If the sources before give the frozen numbers on this machine, "
                         "increment results_version, or lines_version if it is `lines` alone "
                         "(sim/study/study_keys.h); freeze "
                      << text;
  }
}

}  // namespace
}  // namespace vernier
