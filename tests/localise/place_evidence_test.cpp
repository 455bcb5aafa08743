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

/// A world of one line a place on a circle of bins: where it is at each place, whether both have
/// it in common, and what the map and a view hold of it are all discrete, so that probabilities are
/// sums over everything that may be.
struct OneLineWorld {
  static constexpr int bins = 120;
  double common = 0.8, lost = 0.2, background = 0.03, sigma = 2;

  /// Of what is recorded where the line lies at x.
  double recorded(int m, int x) const {
    double sum = 0;
    const auto bell = [&](int d) {
      const int apart = std::min((d % bins + bins) % bins, bins - (d % bins + bins) % bins);
      return std::exp(-0.5 * apart * apart / (sigma * sigma));
    };
    for (int d = 0; d < bins; ++d) sum += bell(d);
    return bell(m - x) / sum;
  }

  /// Of a view's line q and what the map holds at a (for certain) and at b (unless it was lost),
  /// if the view was taken at a or b: the sum over both lines' places.
  double joint(int q, int a, int b, bool at_a) const {
    double sum = 0;
    const auto in_map = [&](int x) { return (1 - lost) * recorded(b, x) + lost / bins; };
    const auto in_view = [&](int x) {
      return (1 - background) * recorded(q, x) + background / bins;
    };
    for (int xa = 0; xa < bins; ++xa) {
      sum += common / bins * recorded(a, xa) * in_map(xa) * in_view(xa);
      for (int xb = 0; xb < bins; ++xb) {
        sum += (1 - common) / bins / bins * recorded(a, xa) * in_map(xb) * in_view(at_a ? xa : xb);
      }
    }
    return sum;
  }

  /// The likeness of two recordings of one line, whose errors both count.
  double likeness(int m, int n) const {
    double sum = 0, most = 0;
    for (int x = 0; x < bins; ++x) {
      sum += recorded(m, x) * recorded(n, x);
      most += recorded(0, x) * recorded(0, x);
    }
    return sum / most;
  }
  /// The density of any line, of that of a perfect one.
  double chance() const {
    double most = 0;
    for (int x = 0; x < bins; ++x) most += recorded(0, x) * recorded(0, x);
    return 1.0 / bins / most;
  }
};

// Oracle: the sum over all places of the two lines, whether they are one, and what was lost.
TEST(PlaceEvidence, IsTheMarginalLikelihoodOfOneLine) {
  for (const double common : {0.1, 0.5, 0.9, 0.99}) {
    for (const double lost : {0.1, 0.3}) {
      OneLineWorld world;
      world.common = common;
      world.lost = lost;
      const RecordingOptions options{static_cast<float>(lost), static_cast<float>(world.chance())};
      const auto stated = [&](int q, int a, int b) {
        const double both = probability_common(world.likeness(a, b), common, options);
        const double c = world.chance(), of_view = world.background * c;
        const double kept = 1 - world.background;
        // By its own recording alone, as if the places had nothing in common.
        const double at_a = of_view + kept * world.likeness(q, a);
        const double at_b = of_view + kept * ((1 - lost) * world.likeness(q, b) + lost * c);
        return seen_evidence(at_a, at_b, both);
      };
      const auto exact = [&](int q, int a, int b) {
        return std::log(world.joint(q, a, b, true) / world.joint(q, a, b, false));
      };
      // The map lost the line at b: it holds something else there, or nothing that is like it.
      EXPECT_NEAR(stated(40, 40, 100), exact(40, 40, 100), 0.05) << common << ' ' << lost;
      EXPECT_NEAR(stated(42, 40, 100), exact(42, 40, 100), 0.05) << common << ' ' << lost;
      // Both hold it, shifted by the errors of recording.
      for (const int shift : {0, 2, 4}) {
        EXPECT_NEAR(stated(40, 40, 40 + shift), exact(40, 40, 40 + shift), 0.4)
            << common << ' ' << lost << ' ' << shift;
      }
    }
  }
}

TEST(PlaceEvidence, IsBoundedByWhatIsInCommon) {
  EXPECT_DOUBLE_EQ(seen_evidence(1, 0.03, 0), std::log(1 / 0.03));
  EXPECT_DOUBLE_EQ(seen_evidence(0.03, 1, 0), -std::log(1 / 0.03));
  EXPECT_DOUBLE_EQ(seen_evidence(1, 0.03, 1), 0);
  EXPECT_DOUBLE_EQ(missed_evidence(0.06, 0), std::log(0.06));
  EXPECT_DOUBLE_EQ(missed_evidence(0.06, 1), 0);
  double before_seen = 10, before_missed = -10;
  for (const double common : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    const double seen = seen_evidence(1, 0.03, common), missed = missed_evidence(0.06, common);
    EXPECT_LT(seen, before_seen);
    EXPECT_GT(missed, before_missed);
    EXPECT_DOUBLE_EQ(seen_evidence(0.03, 1, common), -seen);
    before_seen = seen;
    before_missed = missed;
  }
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
    // Chance is a density to it, and here a probability: 1 / (1 - chance) of the rest.
    EXPECT_NEAR(common_share(lines, options), share, 0.06);
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

/// What a view, taken at the first of two places, says for it, as scores do and as evidence.
struct Said {
  double by_scores = 0, by_evidence = 0;
};
Said said(const std::vector<PlaceLine>& view,
          const std::vector<PlaceLine>& a,
          const std::vector<PlaceLine>& b) {
  const ComparedView seen = compared_view(test::view_of(view));
  const AgreementOptions options = fine_agreement();
  const SpaceLines lines_a = space_lines(a), lines_b = space_lines(b);
  PredictedLines room;
  PlaceEvidence at_a = place_evidence(seen, lines_a, {}, options);
  PlaceEvidence at_b = place_evidence(seen, lines_b, {}, options);
  return {agreement(seen, lines_a, {}, options, room).score -
              agreement(seen, lines_b, {}, options, room).score,
          evidence_between(seen, at_a, at_b, options)};
}

constexpr double share = PosteriorOptions().evidence_share;

/// The error rate that is stated where the posterior prefers a place by so many nats.
double stated_error(double nats) { return 1 / (1 + std::exp(share * std::abs(nats))); }

// Two places of one content, each recorded once: the view is no more like one of them. Of answers
// at a stated error of at most 10 % no more are wrong; false-alarm rate 1e-3. Scores alone fail.
TEST(PlaceEvidence, EqualPlacesStayOpen) {
  constexpr int draws = 400;
  constexpr double stated = 0.1, false_alarm = 1e-3;
  int answers = 0, wrong = 0, answers_by_scores = 0, wrong_by_scores = 0;
  for (int i = 0; i < draws; ++i) {
    const auto room = camera_view(test::random_room(1000 + i, 150)).lines;
    const auto trial = static_cast<std::uint32_t>(i);
    const Said s =
        said(recorded(room, 1, trial), recorded(room, 2, trial), recorded(room, 3, trial));
    if (stated_error(s.by_evidence) <= stated) {
      ++answers;
      wrong += s.by_evidence < 0;
    }
    if (stated_error(s.by_scores) <= stated) {
      ++answers_by_scores;
      wrong_by_scores += s.by_scores < 0;
    }
  }
  RecordProperty("answers", answers);
  RecordProperty("wrong", wrong);
  RecordProperty("answers_by_scores", answers_by_scores);
  RecordProperty("wrong_by_scores", wrong_by_scores);
  EXPECT_GT(binomial_survival(wrong - 1, answers, stated), false_alarm)
      << wrong << " of " << answers;
  EXPECT_LT(binomial_survival(wrong_by_scores - 1, answers_by_scores, stated), false_alarm)
      << wrong_by_scores << " of " << answers_by_scores;
}

// What only one place has tells them apart, and other places are told apart as before.
TEST(PlaceEvidence, DifferencesTellPlacesApart) {
  constexpr int draws = 100;
  int told = 0;
  for (int i = 0; i < draws; ++i) {
    const auto trial = static_cast<std::uint32_t>(i);
    const auto room = camera_view(test::random_room(2000 + i, 150)).lines;
    auto changed = room;
    const auto other = camera_view(test::random_room(5000 + i, 150)).lines;
    const std::size_t few = changed.size() / 4;
    for (std::size_t k = 0; k < few; ++k) changed[k] = other[k];
    const auto view = recorded(room, 1, trial);
    told += share * said(view, recorded(room, 2, trial), recorded(changed, 3, trial)).by_evidence >
            std::log(99);
    const Said elsewhere = said(view, recorded(room, 2, trial), recorded(other, 3, trial));
    EXPECT_GT(elsewhere.by_evidence, 0.6 * elsewhere.by_scores);
  }
  EXPECT_GT(told, 90);
}

}  // namespace
}  // namespace vernier
