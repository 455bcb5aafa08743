// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/success_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/study/study.h"
#include "sim/systems/systems.h"
#include "sim/uncertainty_source.h"
#include "tests/sim/study/stored_example.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

const std::vector<SuccessAt> falling{{0, 1.0, {0.96, 1.0}},
                                     {1, 0.9, {0.84, 0.96}},
                                     {2, 0.92, {0.86, 0.98}},  // a rise by chance
                                     {4, 0.5, {0.4, 0.6}}};

TEST(SuccessCurve, TheScaleIsInterpolatedOfAFallingRate) {
  const ScaleNeeded needed = scale_needed(falling, 0.955);
  EXPECT_NEAR(needed.psi_c, 0.5, 1e-9);  // between 1 and the pooled 0.91
  EXPECT_LT(needed.low, needed.psi_c);
  EXPECT_GT(needed.high, needed.psi_c);
  EXPECT_FALSE(needed.beyond);
  // The upper limit at 2 cannot exceed that at 1; the lower one at 1 is at least that at 2.
  EXPECT_NEAR(scale_needed(falling, 0.96).high, 2, 1e-9);
  EXPECT_NEAR(scale_needed(falling, 0.86).low, 2, 1e-9);
}

TEST(SuccessCurve, WhatIsNeverMetOrAlwaysMetIsSaid) {
  const ScaleNeeded always = scale_needed(falling, 0.3);
  EXPECT_TRUE(always.beyond);
  EXPECT_EQ(always.psi_c, 4);
  std::vector<SuccessAt> poor = falling;
  poor[0] = {0, 0.9, {0.8, 0.94}};
  const ScaleNeeded never = scale_needed(poor, 0.97);
  EXPECT_EQ(never.psi_c, 0);
  EXPECT_EQ(never.low, 0);
}

const std::string office = "[map]\nspacing_m = 1\n";

TEST(SuccessCurve, IsTheSameForAnyNumberOfThreadsAndFallsWithTheError) {
  const Study study = test::office_study("[study]\ntrials = 18\n" + office);
  SuccessCurveOptions options{.psi_c = {0, 1, 60}, .threads = 1};
  const auto one = success_curve(study, options);
  options.threads = 2;
  const auto two = success_curve(study, options);
  ASSERT_EQ(one.size(), 3u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].success, two[i].success);
    EXPECT_EQ(one[i].interval_95, two[i].interval_95);
  }
  EXPECT_GT(one[0].success, one[2].success);
}

/// It is a study that sweeps the scale, of which nothing is stored.
TEST(SuccessCurve, AgreesWithAStudyThatSweepsTheScale) {
  register_systems();
  const std::string servo = "[system]\nname = \"servoing\"\nsuccess_error = 0.05\n",
                    near = "[system]\nname = \"localiser\"\nsuccess_error = 0.05\n" + office,
                    sweep = "[sweep]\n\"sources.calibration\" = [0, 3, 30]\n";
  for (const std::string& system : {servo, near}) {
    const std::string text = "[study]\ntrials = 18\nseed = 5\n" + system;
    const test::TestFolder folder("success_curve");
    const Study swept = test::office_study(text + sweep);
    run_study(swept, {folder / "a", 2, {}, {}, {}});
    const StudyResults results = study_results(swept, folder / "a");
    const auto curve = success_curve(test::office_study(text), {.psi_c = {0, 3, 30}, .threads = 2});
    ASSERT_EQ(curve.size(), results.cells.size());
    for (std::size_t i = 0; i < curve.size(); ++i) {
      EXPECT_EQ(curve[i].success, results.cells[i].summary.success) << system << i;
      EXPECT_EQ(curve[i].interval_95, results.cells[i].summary.success_interval_95.value());
    }
    EXPECT_GT(curve[0].success, curve[2].success) << system;
  }
}

// Nearly all edges are lost, and little else goes wrong: without that loss all is well.
TEST(SuccessCurve, TheCauseThatLimitsMostComesFirst) {
  const auto with_loss = [](const std::string& loss) {
    return test::office_study("[study]\ntrials = 24\n" + office + "[sources]\nedge_loss = " + loss +
                              "\n");
  };
  const SuccessCurveOptions options{.psi_c = {0}, .threads = 2};
  const std::vector<LimitingCause> causes = limiting_causes(with_loss("0.93"), options);
  ASSERT_GT(causes.size(), 2u);
  EXPECT_EQ(causes[0].name, "edge_loss");
  const double now = success_curve(with_loss("0.93"), options)[0].success;
  EXPECT_GT(causes[0].success, now + 0.3);
  EXPECT_LT(causes[1].success, now + 0.3);
  EXPECT_TRUE(std::none_of(causes.begin(), causes.end(),
                           [](const LimitingCause& c) { return c.name == "calibration"; }));
  // What is switched off already limits nothing.
  for (const LimitingCause& cause : limiting_causes(with_loss("0"), options)) {
    EXPECT_NE(cause.name, "edge_loss");
  }
}

TEST(SuccessCurve, TheScalesLimitsHoldIt) {
  // A lower limit may be met where the pooled rate is not.
  const std::vector<SuccessAt> rising{{0, 0.5, {0.3, 0.7}}, {1, 0.9, {0.8, 0.96}}};
  const ScaleNeeded needed = scale_needed(rising, 0.75);
  EXPECT_LE(needed.low, needed.psi_c);
  EXPECT_GE(needed.high, needed.psi_c);
}

/// Normal errors of standard deviation psi_c succeed below 0.2: further scales find where so many
/// do.
TEST(SuccessCurve, FurtherScalesCloseInOnWhereARateIsMet) {
  const auto at = [](double psi_c) {
    const double rate = psi_c > 0 ? std::erf(0.2 / (psi_c * std::sqrt(2.0))) : 1;
    return SuccessAt{psi_c, rate, {std::max(0.0, rate - 0.02), std::min(1.0, rate + 0.02)}};
  };
  for (const double success : {0.1, 0.5, 0.9, 0.97}) {
    std::vector<SuccessAt> curve;
    for (const double psi_c : SuccessCurveOptions{}.psi_c) curve.push_back(at(psi_c));
    int rounds = 0;
    for (std::vector<double> more = scales_between(curve, success); !more.empty() && rounds < 9;
         more = scales_between(curve, success), ++rounds) {
      EXPECT_LE(more.size(), 3u);
      for (const double psi_c : more) curve.push_back(at(psi_c));
      std::sort(curve.begin(), curve.end(),
                [](const SuccessAt& a, const SuccessAt& b) { return a.psi_c < b.psi_c; });
    }
    EXPECT_LT(rounds, 8);
    const double found = scale_needed(curve, success).psi_c;
    EXPECT_NEAR(at(found).success, success, 0.004) << success;
  }
  EXPECT_TRUE(scales_between({{0, 0.9, {0.8, 0.95}}, {1, 0.5, {0.4, 0.6}}}, 0.97).empty());
  EXPECT_TRUE(scales_between({{0, 1, {0.9, 1}}, {1, 1, {0.9, 1}}}, 0.8).empty());
}

/// All edges are lost to a source of one's own: without it all is well.
TEST(SuccessCurve, ASourceOfOnesOwnMayBeTheCause) {
  class Thief : public UncertaintySource {
   public:
    std::string_view name() const override { return "thief"; }
    void apply(const SensingContext&, SensedView& view) const override { view.edges.clear(); }
  };
  register_source("thief", [](const SourceOptions&) { return std::make_unique<Thief>(); });
  const Study study =
      test::office_study("[study]\ntrials = 12\n" + office + "[sources]\nown = [\"thief\"]\n");
  const std::vector<LimitingCause> causes = limiting_causes(study, {.psi_c = {0}, .threads = 2});
  EXPECT_EQ(causes[0].name, "thief");
  EXPECT_GT(causes[0].success, causes[1].success + 0.3);
}

/// A source of error that does not act on a system does not limit it.
TEST(SuccessCurve, OnlySourcesThatActAreCauses) {
  register_systems();
  const Study study = test::office_study(
      "[study]\ntrials = 12\n[system]\nname = \"program\"\ncommand = \"none\"\nsuccess_error = "
      "1\n");
  EXPECT_TRUE(limiting_causes(study).empty());
  const Study servo = test::office_study("[study]\ntrials = 6\n[system]\nname = \"servoing\"\n");
  for (const LimitingCause& cause : limiting_causes(servo, {.threads = 2})) {
    EXPECT_FALSE(cause.name.starts_with("corner")) << cause.name;
  }
}

}  // namespace
}  // namespace vernier
