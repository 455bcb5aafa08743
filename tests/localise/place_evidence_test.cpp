// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/place_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/topological_map.h"
#include "localise/verification/view_agreement.h"
#include "tests/support/camera_views.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

using test::camera_view;

// Property: what is stated of two places is right as often as it says, where they are equal with a
// known probability and differences are as the model has it. False-alarm rate 1e-3.
TEST(PlaceEvidence, WeightsAreThePosterior) {
  constexpr int draws = 20000;
  constexpr double share = 0.5, most = 100, false_alarm_z = 3.29;
  PosteriorOptions options;
  options.dependence = 1;
  options.differing_per_nat = 1 / (most + 1 / share);
  RandomStream d({.seed = 8});
  double excess = 0, wrong_excess = 0, variance = 0;
  int sure = 0;
  for (int i = 0; i < draws; ++i) {
    const bool is_at_a = d.uniform() < 0.5;
    Evidence evidence{0, 0, std::pow(d.uniform(2, 12), 2), 0.3};
    if (d.uniform() < evidence.repeated) {
      evidence.doubtful = std::sqrt(evidence.variance) * d.normal();
    } else {
      // Of the true place over the other: even above 0, falling off below.
      const bool misleads = d.uniform() < 1 / (1 + share * most);
      const double nats = misleads ? std::log(1 - d.uniform()) / share : d.uniform(0, most);
      evidence.doubtful = is_at_a ? nats : -nats;
    }
    const double of_a = 1 / (1 + weight_against(evidence, share, options));
    excess += is_at_a - of_a;
    variance += of_a * (1 - of_a);
    sure += std::max(of_a, 1 - of_a) > 0.99;
    // One sided: a posterior that prefers either place too much is wrong more often than stated.
    const double stated = std::min(of_a, 1 - of_a);
    const bool wrong = (of_a > 0.5) != is_at_a;
    wrong_excess += wrong - stated;
  }
  EXPECT_LT(std::abs(excess), false_alarm_z * std::sqrt(variance));
  EXPECT_LT(std::abs(wrong_excess), false_alarm_z * std::sqrt(variance));
  EXPECT_GT(sure, draws / 3);
}

TEST(PlaceEvidence, WithoutRepetitionScoresCount) {
  const double share = 0.55;
  for (const double nats : {-20.0, -1.0, 0.0, 3.0, 40.0}) {
    const double weight = std::exp(-share * (nats + 2));
    EXPECT_NEAR(weight_against({2, nats, 50, 0}, share), weight, 1e-12 * weight);
    const double of_certain = weight_against({nats, 0, 50, 0.9}, share);
    EXPECT_NEAR(of_certain, std::exp(-share * nats), 1e-12 * of_certain);
  }
  EXPECT_EQ(weight_against({0, 0, 0, 0.9}, share), 1);
}

// Property: what recorded views say of two places is right as often as stated, where differences of
// views of one place are correlated and are as the model has it. False-alarm rate 1e-3.
TEST(ProbabilityEqual, IsThePosterior) {
  constexpr int draws = 20000, views = 6;
  constexpr double most = 100, false_alarm_z = 3.29, before = 0.2;
  PosteriorOptions options;
  options.differing_per_nat = 1 / (most + 1 / options.evidence_share / views);
  RandomStream d({.seed = 21});
  double excess = 0, variance = 0;
  int decided = 0;
  for (int i = 0; i < draws; ++i) {
    const bool equal = d.uniform() < before;
    RecordedDifference recorded{0, views * std::pow(d.uniform(2, 8), 2), views};
    if (equal) {
      const double of_one = std::sqrt(options.dependence * recorded.variance / views);
      const double common = std::sqrt(options.of_one_place) * d.normal();
      for (int view = 0; view < views; ++view) {
        recorded.nats += of_one * (common + std::sqrt(1 - options.of_one_place) * d.normal());
      }
    } else {
      const double below = 1 / options.evidence_share;
      recorded.nats = d.uniform() < below / (below + views * most)
                          ? below * std::log(1 - d.uniform())
                          : d.uniform(0, views * most);
    }
    const double stated = probability_equal(before, recorded, options);
    excess += equal - stated;
    variance += stated * (1 - stated);
    decided += stated < 0.01;
  }
  EXPECT_LT(std::abs(excess), false_alarm_z * std::sqrt(variance));
  EXPECT_GT(decided, draws / 2);
  EXPECT_EQ(probability_equal(before, {}), before);
  EXPECT_EQ(probability_equal(before, {0, 1, 1}), before);  // next to nothing to compare
  EXPECT_EQ(probability_equal(0, {0, 1000, 6}), 0);
  EXPECT_LT(probability_equal(before, {5000, 100, 6}), 1e-12);  // densities below all numbers
  EXPECT_LT(probability_equal(before, {-5000, 100, 6}), 1e-12);
}

/// A recording of a room: each line is lost with 12 %, and has moved by 1.5 to 4.5 px in the image.
std::vector<PlaceLine> recorded(const std::vector<PlaceLine>& room,
                                std::uint64_t seed,
                                std::uint32_t trial) {
  constexpr double lost = 0.12, least_px = 1.5, most_px = 4.5, f_px = 525;
  std::vector<PlaceLine> lines;
  RandomStream draws({.seed = seed, .trial = trial});
  for (const PlaceLine& line : room) {
    const double shift = draws.uniform(least_px, most_px) * (draws.uniform() < 0.5 ? -1 : 1);
    if (draws.uniform() < lost) continue;
    PlaceLine moved = line;
    const double by_m = shift / f_px * (0.5 * (line.a_m + line.b_m)).x();
    const Eigen::Vector3d across =
        line.kind == LineKind::vertical ? Eigen::Vector3d(0, by_m, 0) : Eigen::Vector3d(0, 0, by_m);
    moved.a_m += across;
    moved.b_m += across;
    lines.push_back(moved);
  }
  return lines;
}

constexpr double share = PosteriorOptions().evidence_share;

/// What a view says of the first of two places against the second.
PlaceDifference said(const std::vector<PlaceLine>& view,
                     const std::vector<PlaceLine>& a,
                     const std::vector<PlaceLine>& b) {
  const ComparedView seen = compared_view(test::view_of(view));
  const AgreementOptions options = fine_agreement();
  const SpaceLines lines_a = space_lines(a), lines_b = space_lines(b);
  PlaceEvidence at_a = place_evidence(seen, lines_a, {}, {}, options);
  PlaceEvidence at_b = place_evidence(seen, lines_b, {}, {50, 0, 0}, options);
  const PlaceDifference difference = difference_between(seen, at_a, at_b, options);
  PredictedLines room;
  const double scores = agreement(seen, lines_a, {}, options, room).score -
                        agreement(seen, lines_b, {}, options, room).score;
  EXPECT_NEAR(difference.by_one_recording + difference.by_two_recordings, scores, 0.01);
  EXPECT_EQ(difference.by_one_recording, 0);
  return difference;
}

/// Probability of the first place, where the two are equal with the probability `repeated`.
double probability(const PlaceDifference& d, double repeated) {
  return 1 / (1 + weight_against({d.by_one_recording, d.by_two_recordings, d.variance, repeated},
                                 share));
}

struct Answers {
  int all = 0, wrong = 0;
  void add(double of_truth, double stated) {
    all += std::max(of_truth, 1 - of_truth) >= 1 - stated;
    wrong += 1 - of_truth >= 1 - stated;
  }
};

// Two places of one content, each recorded once: the view is no more like one of them. Of answers
// at a stated error of at most 10 % no more are wrong; false-alarm rate 1e-3. Scores alone fail.
TEST(PlaceEvidence, EqualPlacesStayOpen) {
  constexpr int draws = 400;
  constexpr double stated = 0.1, false_alarm = 1e-3, repeats = 0.5;
  Answers by_scores, by_evidence;
  for (int i = 0; i < draws; ++i) {
    const auto room = camera_view(test::random_room(1000 + i, 150)).lines;
    const auto trial = static_cast<std::uint32_t>(i);
    const PlaceDifference difference =
        said(recorded(room, 1, trial), recorded(room, 2, trial), recorded(room, 3, trial));
    by_scores.add(probability(difference, 0), stated);
    by_evidence.add(probability(difference, repeats), stated);
  }
  EXPECT_GT(binomial_survival(by_evidence.wrong - 1, by_evidence.all, stated), false_alarm)
      << by_evidence.wrong << " of " << by_evidence.all;
  EXPECT_LT(binomial_survival(by_scores.wrong - 1, by_scores.all, stated), false_alarm)
      << by_scores.wrong << " of " << by_scores.all;
}

/// A room at `x_m`, recorded so many times along 0.75 m in the direction of `heading_rad`.
void record(const std::vector<PlaceLine>& room,
            double x_m,
            double heading_rad,
            int times,
            std::uint32_t trial,
            TopologicalMap& map) {
  for (int i = 0; i < times; ++i) {
    const double forward_m = times > 1 ? 0.75 * i / (times - 1) : 0;
    const PlaceView seen = camera_view(room, {forward_m, 0, 0});
    const Pose2D pose{x_m + forward_m * std::cos(heading_rad), 0, heading_rad};
    map.nodes.push_back({pose, test::view_of(recorded(seen.lines, 10 + map.nodes.size(), trial))});
  }
}

/// How often each of two rooms, 50 m apart, was recorded.
struct Recordings {
  int first = 4, second = 4;
};

/// Answers about the first of two rooms at a stated error of 10 %.
Answers answers(bool rooms_are_equal, double repeats, int buildings, Recordings times = {}) {
  Answers sum;
  for (int i = 0; i < buildings; ++i) {
    const auto room = test::random_room(7000 + i, 150);
    const auto other = rooms_are_equal ? room : test::random_room(9000 + i, 150);
    const auto trial = static_cast<std::uint32_t>(i);
    TopologicalMap map;
    record(room, 0, 0, times.first, trial, map);
    record(other, 50, 0, times.second, trial, map);
    LocaliserOptions options;
    options.max_error_rate = 0.1;
    options.repeats = repeats;
    const auto localiser = make_localiser("lines", map, options);
    const PlaceView seen = camera_view(room, {0.4, 0.05, 0.03});
    const auto answer = localiser->localise(test::view_of(recorded(seen.lines, 3, trial)));
    if (answer.status != LocalisationStatus::answered) continue;
    ++sum.all;
    sum.wrong += answer.pose.x_m > 25;
  }
  return sum;
}

// The views that the map recorded tell whether two rooms are equal: where they are, no more answers
// are wrong than stated (false-alarm rate 1e-3; without that more are); where they are not, no
// answers are lost.
TEST(RecordedViews, TellWhetherPlacesAreEqual) {
  constexpr int buildings = 200;
  constexpr double stated = 0.1, false_alarm = 1e-3;
  const double repeats = LocaliserOptions().repeats;
  const Answers equal = answers(true, repeats, buildings);
  EXPECT_GT(binomial_survival(equal.wrong - 1, equal.all, stated), false_alarm)
      << equal.wrong << " of " << equal.all;
  const Answers by_scores = answers(true, 0, buildings);
  EXPECT_LT(binomial_survival(by_scores.wrong - 1, by_scores.all, stated), false_alarm)
      << by_scores.wrong << " of " << by_scores.all;
  const Answers differ = answers(false, repeats, buildings);
  EXPECT_GE(differ.all, answers(false, 0, buildings).all - 1);
  EXPECT_GT(differ.all, buildings * 9 / 10);
}

// A place that was recorded more often explains all views better, and is no other place for that.
TEST(RecordedViews, OfUnequalNumberSayNoMoreForThat) {
  constexpr int buildings = 60;
  constexpr Recordings many_first{8, 2}, few_first{2, 8};
  const double repeats = LocaliserOptions().repeats;
  EXPECT_LT(answers(true, repeats, buildings, many_first).all, buildings / 3);
  EXPECT_GT(answers(true, 0, buildings, many_first).all, buildings / 2);
  EXPECT_GT(answers(false, repeats, buildings, many_first).all, buildings * 9 / 10);
  EXPECT_GT(answers(false, repeats, buildings, few_first).all, buildings * 9 / 10);
}

// Two places that are equal in front and differ behind are told apart by looks in both directions,
// whichever was taken first.
TEST(RecordedViews, AreAskedInTheDirectionsOfAllLooks) {
  constexpr int buildings = 40;
  constexpr double turn_rad = std::numbers::pi;
  for (const bool behind_first : {false, true}) {
    int answered = 0;
    for (int i = 0; i < buildings; ++i) {
      const auto trial = static_cast<std::uint32_t>(i);
      const auto front = test::random_room(7000 + i, 150);
      const auto behind = test::random_room(8000 + i, 60);
      TopologicalMap map;
      record(front, 0, 0, 4, trial, map);
      record(behind, 0, turn_rad, 4, trial, map);
      record(front, 50, 0, 4, trial, map);
      record(test::random_room(9000 + i, 60), 50, turn_rad, 4, trial, map);
      const auto look = [&](const std::vector<PlaceLine>& room, double forward_m, int seed) {
        return test::view_of(recorded(camera_view(room, {forward_m, 0, 0}).lines, seed, trial));
      };
      std::vector<Look> looks{{look(front, 0.4, 3), 0}, {look(behind, -0.4, 4), turn_rad}};
      if (behind_first) looks = {{looks[1].view, 0}, {looks[0].view, turn_rad}};
      const auto answer = make_localiser("lines", map)->localise_looks(looks);
      answered += answer.status == LocalisationStatus::answered && answer.pose.x_m < 25;
    }
    EXPECT_GT(answered, buildings * 9 / 10) << behind_first;
  }
}

// Other places are told apart although places may be equal.
TEST(PlaceEvidence, OtherPlacesAreToldApart) {
  for (int i = 0; i < 100; ++i) {
    const auto trial = static_cast<std::uint32_t>(i);
    const auto room = camera_view(test::random_room(2000 + i, 150)).lines;
    const auto other = camera_view(test::random_room(5000 + i, 150)).lines;
    const PlaceDifference difference =
        said(recorded(room, 1, trial), recorded(room, 2, trial), recorded(other, 3, trial));
    EXPECT_GT(probability(difference, 0.5), 0.999);
  }
}

// Two poses that see the same recorded lines: their differences count in full.
TEST(PlaceEvidence, OneRecordingIsCertain) {
  const auto room = camera_view(test::random_room(77, 150)).lines;
  const ComparedView seen = compared_view(test::view_of(room));
  const SpaceLines lines = space_lines(room);
  const Pose2D beside{0.02, 0.05, 0.01}, at{7, -3, 1.2};
  PlaceEvidence a = place_evidence(seen, lines, {}, at, fine_agreement());
  PlaceEvidence b = place_evidence(seen, lines, beside, compose(at, beside), fine_agreement());
  const PlaceDifference difference = difference_between(seen, a, b, fine_agreement());
  EXPECT_GT(difference.by_one_recording, 1);
  PlaceEvidence far = place_evidence(seen, lines, beside, {-40, 20, 0.3}, fine_agreement());
  const PlaceDifference other = difference_between(seen, a, far, fine_agreement());
  EXPECT_EQ(other.by_one_recording, 0);
  EXPECT_GT(other.variance, difference.variance);
}

}  // namespace
}  // namespace vernier
