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

/// One of the six takes them all, at the turns that the localiser asks for.
ExperimentSettings with_three_looks() {
  ExperimentSettings s = settings("lines");
  s.looks = 3;
  s.localiser.max_error_rate = 2e-5;
  return s;
}

std::vector<double> numbers_of(const ExperimentSettings& s) {
  const Visibility& office = test::small_office_visibility();
  const RigEstimate& rig = test::nominal_rig();
  const LocalisationExperiment experiment(
      office, rig, std::make_shared<MapViews>(map_views(office, rig.rig, s)), s);
  std::vector<double> numbers;
  for (const TrialResult& t : experiment.run_block({.block = 0, .first = 0, .count = 6})) {
    if (!std::isfinite(t.error)) {
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
  EXPECT_EQ(lines_version, 9) << "freeze the numbers of `lines` anew";
  const std::vector<Frozen> frozen{
      {"lines",
       settings("lines"),
       {1.311473, 3.818018, -1.590605, -29.243269, 7.156373, 2.179267, -2.318301, -70.269547,
        1.466711, 4.650121, -1.651536, -81.226044, 2.189891, 8.294113, 1.739407,  -7.490816,
        7.146597, 8.014146, 2.429865,  -56.415936, 6.611635, 4.711433, 0.218672,  -49.948090}},
      {"lines, three looks",
       with_three_looks(),
       {1.311473, 3.818018, -1.590605, -29.243269, 7.156373, 2.179267, -2.318301, -70.269547,
        1.466711, 4.650121, -1.651536, -81.226044, 2.184199, 8.294566, 1.737366,  -80.274668,
        7.146597, 8.014146, 2.429865,  -56.415936, 6.611635, 4.711433, 0.218672,  -49.948090}},
      {"corners",
       settings("corners"),
       {1.308940,  3.813340, -1.585875, 56.549558, 7.148722,  2.176175,  -2.320661,
        37.325019, 1.458437, 4.657163,  -1.643400, 43.761405, -1.000000, 7.151375,
        8.018010,  2.433468, 55.635941, 6.594961,  4.741230,  0.210051,  13.664031}},
      {"pgh", settings("pgh"), {1.331138,  3.814062, -1.598459, 0.436476, 7.173313,  2.165666,
                                -2.329487, 0.388684, 1.434262,  4.656250, -1.636434, 0.447665,
                                2.150000,  8.293750, 1.724096,  0.412688, 7.187461,  8.056907,
                                2.453763,  0.395056, 6.610938,  4.710938, 0.214719,  0.239913}},
      {"pgh_baseline",
       settings("pgh_baseline"),
       {1.182700, 4.000000, -1.570796, 5105.055664, 7.009325, 2.375000, -2.129300, 6090.223145,
        1.182700, 4.000000, -1.570796, 5826.765625, 6.775000, 8.000000, 1.570796,  3315.524902,
        7.097000, 7.625000, 2.280300,  6223.055176, 6.450000, 5.000000, 0.000000,  2267.178711}},
      {"pgh_baseline_vectorised",
       settings("pgh_baseline_vectorised"),
       {1.182700, 4.000000, -1.570796, 5105.056152, 7.009325, 2.375000, -2.129300, 6090.225098,
        1.182700, 4.000000, -1.570796, 5826.765625, 6.775000, 8.000000, 1.570796,  3315.524902,
        7.097000, 7.625000, 2.280300,  6223.053711, 6.450000, 5.000000, 0.000000,  2267.178711}},
      {"every source",
       with_every_source(),
       {1.332700, 4.000000, -1.579196, 0.165763, 6.951514, 2.482985, -2.201975, 0.104460,
        1.540513, 4.631250, -1.678165, 0.184953, 6.259375, 1.648438, -1.310140, 0.234064,
        7.144683, 8.135507, 2.463600,  0.110879, 4.159375, 5.468750, -0.308950, 0.062104}},
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
