// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/place_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/verification/view_agreement.h"
#include "tests/support/camera_views.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

using test::camera_view;

/// A world of one line a place on a circle of bins, where what is common to two places and what the
/// map holds of them are discrete, so that probabilities are sums over everything that may be.
struct OneLineWorld {
  static constexpr int bins = 120;
  double common = 0.8, lost = 0.2;

  /// Of recording m of a line at x: a bell of 2 bins.
  static double recorded(int m, int x) {
    constexpr double sigma = 2;
    const auto bell = [](int d) {
      const int apart = std::min((d % bins + bins) % bins, bins - (d % bins + bins) % bins);
      return std::exp(-0.5 * apart * apart / (sigma * sigma));
    };
    double sum = 0;
    for (int d = 0; d < bins; ++d) sum += bell(d);
    return bell(m - x) / sum;
  }

  /// That the line at a is also at b, where the map holds m and n: the sum over where they are.
  double probability_common(int m, int n) const {
    double one = 0, others = 0;
    const auto kept = [&](int x) { return (1 - lost) * recorded(n, x) + lost / bins; };
    for (int xa = 0; xa < bins; ++xa) {
      one += common / bins * recorded(m, xa) * kept(xa);
      for (int xb = 0; xb < bins; ++xb) {
        others += (1 - common) / bins / bins * recorded(m, xa) * recorded(n, xb);
      }
    }
    return one / (one + others);
  }

  /// The likeness of two recordings of one line, whose errors both count, and the density of any
  /// line, of that of a perfect one.
  static double overlap(int m, int n) {
    double sum = 0;
    for (int x = 0; x < bins; ++x) sum += recorded(m, x) * recorded(n, x);
    return sum;
  }
  static double likeness(int m, int n) { return overlap(m, n) / overlap(0, 0); }
  static double chance() { return 1.0 / bins / overlap(0, 0); }
};

// Oracle: the sum over all places of the two lines, and whether they are one.
TEST(PlaceEvidence, ALineIsCommonAsBayesSays) {
  for (const double common : {0.1, 0.5, 0.9, 0.99}) {
    for (const double lost : {0.05, 0.3}) {
      const OneLineWorld world{common, lost};
      const RecordingOptions options{static_cast<float>(lost), static_cast<float>(world.chance())};
      for (const int apart : {0, 2, 4, 8, 50}) {
        EXPECT_NEAR(probability_common(world.likeness(40, 40 + apart), common, options),
                    world.probability_common(40, 40 + apart), 1e-6)
            << common << ' ' << lost << ' ' << apart;
      }
    }
  }
}

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

// Shares that are known: lines that are common have partners unless lost, others by chance.
TEST(CommonShare, IsTheOneThatDrewTheLines) {
  const RecordingOptions options;
  for (const double share : {0.05, 0.4, 0.8, 0.97}) {
    std::vector<LineLikeness> lines;
    RandomStream draws({.seed = 5});
    for (int i = 0; i < 4000; ++i) {
      const bool kept = draws.uniform() < share && draws.uniform() >= options.lost;
      lines.push_back({kept || draws.uniform() < options.chance ? 1.0f : 0.0f, 1});
    }
    EXPECT_NEAR(common_share(lines, options), share, 0.03);
  }
  EXPECT_DOUBLE_EQ(common_share({}, options), 0.5);
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

/// Probability of the first place, where places of which the map holds the same may be equal.
double probability(const PlaceDifference& d, double repeats) {
  const double equal = repeats * probability_equal(d.lines, {});
  return 1 /
         (1 + weight_against({d.by_one_recording, d.by_two_recordings, d.variance, equal}, share));
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

/// Lines of which a share is recorded anew at another place, from both.
std::vector<LineLikeness> likenesses(double shared, int lines, std::uint64_t seed) {
  std::vector<LineLikeness> drawn;
  RandomStream draws({.seed = seed});
  for (int i = 0; i < 2 * lines; ++i) {
    const float of_shared = static_cast<float>(draws.uniform(0.7, 1));
    drawn.push_back({draws.uniform() < shared ? of_shared : 0.0f, 2.5f});
  }
  return drawn;
}

// A view whose lines are all at another place says little by itself: where all else there differs,
// a part of what it does not show well differs too.
TEST(ProbabilityEqual, CountsWhatIsAround) {
  const auto same = likenesses(1, 30, 3), most = likenesses(0.9, 30, 4);
  const auto like = likenesses(0.98, 400, 5), unlike = likenesses(0.15, 400, 6);
  EXPECT_GT(probability_equal(same, like), 0.95);
  EXPECT_GT(probability_equal(most, like), 0.2);
  EXPECT_LT(probability_equal(same, unlike), 0.1);
  EXPECT_LT(probability_equal(most, unlike), 1e-3);
  EXPECT_EQ(probability_equal({}, unlike), 1);  // a view of nothing is the same everywhere
}

// Oracle: things of one line each, of which the share is known by very many around. Then the
// probability that all are common is the product of those of each, and things that were drawn with
// that share are all common as often as stated; false-alarm rate 1e-3.
TEST(ProbabilityEqual, IsThatOfAllThings) {
  constexpr int draws = 400, things = 4, known = 20000;
  constexpr double false_alarm_z = 3.29;
  for (const double common : {0.3, 0.8, 0.97}) {
    const RecordingOptions options{0.2f, 0.1f, 1};
    RandomStream d({.seed = 12});
    const auto line = [&](bool is_common) {
      const bool kept = is_common && d.uniform() >= options.lost;
      return LineLikeness{kept || d.uniform() < options.chance ? 1.0f : 0.0f, 1};
    };
    std::vector<LineLikeness> around;
    for (int i = 0; i < known; ++i) around.push_back(line(d.uniform() < common));
    double excess = 0, variance = 0;
    for (int i = 0; i < draws; ++i) {
      std::vector<LineLikeness> view;
      bool equal = true;
      for (int thing = 0; thing < things; ++thing) {
        const bool is_common = d.uniform() < common;
        equal = equal && is_common;
        const LineLikeness drawn = line(is_common);
        view.insert(view.end(), {drawn, drawn});
      }
      const double stated = probability_equal(view, around, options);
      excess += equal - stated;
      variance += stated * (1 - stated);
    }
    EXPECT_LT(std::abs(excess), false_alarm_z * std::sqrt(variance)) << common;
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
    EXPECT_LT(probability_equal(difference.lines, {}), 1e-4);
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
