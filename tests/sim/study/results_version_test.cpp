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

/// What six trials gave when the versions were set: the score of each, and where it was answered.
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

ExperimentSettings with_every_source() {
  ExperimentSettings s = settings("pgh");
  for (const SourceParameter& p : source_parameters()) {
    if (p.is_newer && s.sources.*p.value == 0) s.sources.*p.value = 0.01;
  }
  return s;
}

std::vector<double> numbers_of(const ExperimentSettings& s) {
  const Visibility& office = test::small_office_visibility();
  const RigEstimate& rig = test::nominal_rig();
  const LocalisationExperiment experiment(
      office, rig, std::make_shared<MapViews>(map_views(office, rig.rig, s)), s);
  std::vector<double> numbers;
  for (const TrialResult& t : experiment.run_block({.block = 0, .first = 0, .count = 6})) {
    const bool answers = std::isfinite(t.error_m);
    numbers.push_back(answers ? t.answer.x_m : -1);
    numbers.push_back(answers ? t.score : -1);
  }
  return numbers;
}

// Results are stored under keys that hold these versions. A trial that gives something else under
// the same key would be mixed with older ones, without a word.
TEST(ResultsVersion, TrialsGiveWhatTheyGaveWhenItWasSet) {
  EXPECT_EQ(results_version, 2) << "freeze the numbers below anew";
  EXPECT_EQ(lines_version, 5) << "freeze the numbers of `lines` anew";
  const std::vector<Frozen> frozen{
      {"lines",
       settings("lines"),
       {1.311473, -29.243269, 7.156373, -70.269547, 1.466711, -81.226044, 2.189891, -7.490816,
        7.146597, -56.415936, 6.611635, -49.948090}},
      {"pgh",
       settings("pgh"),
       {1.331138, 0.436476, 7.173313, 0.388684, 1.434262, 0.447665, 2.150000, 0.412688, 7.187461,
        0.395056, 6.610938, 0.239913}},
      {"pgh_baseline",
       settings("pgh_baseline"),
       {1.182700, 5105.055664, 7.009325, 6090.223145, 1.182700, 5826.765625, 6.775000, 3315.524902,
        7.097000, 6223.055176, 6.450000, 2267.178711}},
      {"every source",
       with_every_source(),
       {1.317075, 0.426330, 7.166357, 0.374624, 1.438950, 0.444152, 1.812500, 0.403363, 7.180348,
        0.399225, 6.611719, 0.251103}},
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
                      << " changed: increment results_version, or lines_version if it is `lines` "
                         "alone (sim/study/study_keys.h), and freeze "
                      << text;
  }
}

}  // namespace
}  // namespace vernier
