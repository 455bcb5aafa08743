// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Sequences made with known errors give them back.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include "sim/sequence/measured_sequence.h"
#include "sim/sequence/sequence_samples.h"
#include "tests/sim/sequence/made_sequence.h"

namespace vernier::sim::internal {
namespace {

using test::MadeErrors;
using test::MadeSequence;

constexpr std::uint32_t trials = 10;

MeasuredSequence measured_in(const MadeSequence& made, bool with_depth) {
  SequenceOptions options;
  options.join.view_turn_rad = 5e-4;
  const DepthOfView depth = [&](std::size_t view) { return made.depth(view); };
  return measure_sequence(
      sequence_samples(made.camera(), made.views(), with_depth ? depth : DepthOfView(), options),
      made.views());
}

/// By how much values miss the truth, on average over the trials, and how many intervals hold it.
class Tally {
 public:
  void add(const std::string& what, double truth, const MeasuredValue& value) {
    off_[what] += (value.value - truth) / trials;
    inside_[what] += value.interval.low <= truth && truth <= value.interval.high;
  }
  double off(const std::string& what) const { return off_.at(what); }
  int inside(const std::string& what) const { return inside_.at(what); }

 private:
  std::map<std::string, double> off_;
  std::map<std::string, int> inside_;
};

Tally tally_of(const MadeErrors& errors, bool with_depth) {
  Tally tally;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const MadeSequence made(errors, trial);
    const MadeSequence::Counts& c = made.counts();
    const double gaps = c.gaps_px / c.px, lost = c.lost / c.lines;
    const SequenceFigures f = measured_in(made, with_depth).all;
    tally.add("lost whole", lost, f.lost_whole);
    tally.add("loss", lost + (1 - lost) * gaps, f.loss);
    tally.add("loss of found", gaps, f.loss_of_found);
    tally.add("pieces", 1 + c.split / (c.lines - c.lost), f.pieces);
    tally.add("across", errors.across_px, f.end_across_px);
    tally.add("along", errors.along_px, f.end_along_px);
    tally.add("false", errors.false_share, f.not_confirmed);
    tally.add("mismatch", errors.wrong_depth, f.mismatch);
  }
  return tally;
}

MadeErrors many_errors() {
  MadeErrors errors;
  errors.lost = 0.2;
  errors.split = 0.3;
  errors.across_px = 0.15;
  errors.along_px = 0.6;
  errors.wrong_depth = 0.03;
  errors.false_share = 0.1;
  return errors;
}

// Ten intervals of 95 %: six or fewer hold the truth by chance in 1 of 1,000 sets.
TEST(SequenceStatistics, GivesBackKnownErrors) {
  const Tally tally = tally_of(many_errors(), true);
  const std::map<std::string, double> most_off{
      {"lost whole", 0.015}, {"loss", 0.015}, {"loss of found", 0.008}, {"pieces", 0.015},
      {"across", 0.01},      {"along", 0.05}, {"false", 0.01},          {"mismatch", 0.005}};
  for (const auto& [what, most] : most_off) {
    EXPECT_LT(std::abs(tally.off(what)), most) << what << ' ' << tally.off(what);
    RecordProperty(what + " off", std::to_string(tally.off(what)));
    RecordProperty(what + " inside", tally.inside(what));
  }
  for (const char* what : {"pieces", "across", "false", "mismatch", "loss", "lost whole"}) {
    EXPECT_GE(tally.inside(what), 7) << what;
  }
}

TEST(SequenceStatistics, FindsNothingWhereNothingIsWrong) {
  const Tally tally = tally_of({}, true);
  for (const char* what : {"lost whole", "loss", "false", "mismatch"}) {
    EXPECT_LT(std::abs(tally.off(what)), 0.012) << what << ' ' << tally.off(what);
  }
  EXPECT_LT(std::abs(tally.off("across")), 0.01);
  EXPECT_LT(std::abs(tally.off("pieces")), 0.005);
}

// Without depth maps what the board hides counts as lost, but most of it no view nearby sees.
TEST(SequenceStatistics, NeighboursStandInForDepthMaps) {
  const Tally tally = tally_of(many_errors(), false);
  EXPECT_LT(std::abs(tally.off("loss")), 0.03) << tally.off("loss");
  EXPECT_LT(std::abs(tally.off("across")), 0.01) << tally.off("across");
  EXPECT_LT(std::abs(tally.off("mismatch")), 0.01) << tally.off("mismatch");
  EXPECT_LT(std::abs(tally.off("pieces")), 0.02) << tally.off("pieces");
}

// Turns of the views that the poses do not say move both ends of a segment alike, and turn it.
TEST(SequenceStatistics, ErrorsOfPosesAreNotTakenForEnds) {
  MadeErrors errors;
  errors.across_px = 0.15;
  errors.turn_rad = 1e-3;
  const Tally tally = tally_of(errors, true);
  EXPECT_LT(std::abs(tally.off("across")), 0.02) << tally.off("across");
  EXPECT_LT(std::abs(tally.off("loss")), 0.02) << tally.off("loss");
}

}  // namespace
}  // namespace vernier::sim::internal
