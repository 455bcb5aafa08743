// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "sim/moved_furniture.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/python_program.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::sim;

namespace {

class Experiments : public testing::Test {
 protected:
  static ExperimentSettings settings(QueryProtocol protocol, int headings = 0) {
    ExperimentSettings s;
    s.method = "lines";
    s.protocol = protocol;
    s.map_headings = headings;
    s.seed = 77;
    return s;
  }

  LocalisationExperiment experiment(const ExperimentSettings& s) const {
    return {visibility_, rig_, std::make_shared<MapViews>(map_views(visibility_, rig_.rig, s)), s};
  }

  World world_ = test::small_office();
  Visibility visibility_{world_};
  RigEstimate rig_ = test::nominal_rig();
};

// False alarms below 1e-6 if 9 of 10 are right at least.
TEST_F(Experiments, LinesFindTheRobotUnderAllSources) {
  const auto trials =
      experiment(settings(QueryProtocol::path)).run_block({.block = 0, .first = 0, .count = 60});
  int right = 0, wrong_though_sure = 0;
  std::vector<double> errors;
  for (const TrialResult& t : trials) {
    right += t.error <= 1;
    wrong_though_sure += t.answered() && !(t.error <= 1);
    if (t.error <= 1) errors.push_back(t.error);
    EXPECT_EQ(t.looks, 1);
    EXPECT_GE(t.probability, 0);
    EXPECT_LE(t.probability, 1);
    if (t.answered()) {
      EXPECT_GE(t.probability, 0.99);
    }
  }
  EXPECT_GE(right, 42);
  EXPECT_LE(wrong_though_sure, 3);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.05);
}

/// A camera above the other sees level lines as well as one beside it sees upright ones: 60 queries
/// each, 40 or more right (at 9 of 10, as few as that once in 1e7 times).
TEST_F(Experiments, LinesFindTheRobotWithCamerasAboveEachOther) {
  Rig& rig = rig_.rig;
  rig.T_camera_first[1] = {Eigen::Matrix3d::Identity(), {0, -rig.T_camera_first[1].t.norm(), 0}};
  ExperimentSettings s = settings(QueryProtocol::path);
  s.sources.calibration = 0;
  const auto trials = experiment(s).run_block({.block = 0, .first = 0, .count = 60});
  EXPECT_GE(std::count_if(trials.begin(), trials.end(),
                          [](const TrialResult& t) { return t.error <= 1; }),
            40);
}

TEST_F(Experiments, FurtherLooksAreTakenWhereTheFirstIsUnsure) {
  ExperimentSettings s = settings(QueryProtocol::anywhere, 8);
  const TrialBlock block{.block = 0, .first = 0, .count = 30};
  const auto one = experiment(s).run_block(block);
  s.looks = 4;
  const auto four = experiment(s).run_block(block);
  int sure_of_one = 0, sure_of_four = 0, more = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].truth.x_m, four[i].truth.x_m);
    EXPECT_EQ(four[i].looks == 1, one[i].answered()) << i;
    if (four[i].looks == 1) {
      EXPECT_EQ(one[i].score, four[i].score);
      EXPECT_EQ(one[i].answer.x_m, four[i].answer.x_m);
    }
    EXPECT_LE(four[i].looks, 4);
    more += four[i].looks > 1;
    sure_of_one += one[i].success();
    sure_of_four += four[i].success();
  }
  EXPECT_GT(more, 0);
  EXPECT_GT(sure_of_four, sure_of_one);
}

TEST_F(Experiments, LooksDoNotDependOnWhatIsAnsweredWhereTheyAreAskedForApart) {
  ExperimentSettings s = settings(QueryProtocol::near_path);
  s.looks = 2;
  s.localiser.max_error_rate = 0.001;
  const TrialBlock block{.block = 0, .first = 0, .count = 40};
  const auto careful = experiment(s).run_block(block);
  s.localiser.look_error_rate = 0.001;
  s.localiser.max_error_rate = 1;
  const auto bold = experiment(s).run_block(block);
  int twice = 0, other = 0;
  for (std::size_t i = 0; i < careful.size(); ++i) {
    EXPECT_TRUE(bold[i].answered());
    twice += bold[i].looks == 2;
    if (bold[i].looks != careful[i].looks) {
      // Where the map tells no turn that helps, what is answered already asks for none.
      ++other;
      EXPECT_LT(bold[i].looks, careful[i].looks);
      continue;
    }
    EXPECT_EQ(bold[i].probability, careful[i].probability);
    EXPECT_EQ(bold[i].answer.x_m, careful[i].answer.x_m);
  }
  EXPECT_GT(twice, 0);
  EXPECT_LE(other, 2);
}

/// Answers the first node, whatever it sees, and counts the looks.
class First : public Localiser {
 public:
  explicit First(const TopologicalMap& map) : map_(map) {}
  LocalisationAnswer localise(const PlaceView& query) const override {
    LocalisationAnswer answer;
    answer.status = LocalisationStatus::unsure;
    answer.node = 0;
    answer.pose = map_.nodes[0].pose;
    answer.next_turn_rad = 0.5;
    headings.push_back(query.lines.size());
    return answer;
  }
  LocalisationAnswer localise_looks(std::span<const Look> looks) const override {
    turns.push_back(looks.back().turn_rad);
    return localise(looks[0].view);
  }
  mutable std::vector<std::size_t> headings;
  mutable std::vector<double> turns;

 private:
  const TopologicalMap& map_;
};

/// A program that gives up in the middle spoils its trial and no other.
TEST_F(Experiments, SurviveAProgramThatDies) {
  const test::Folder folder;
  const auto program = folder.write(
      "mine.py",
      test::python_program(test::python_reads_map,
                           "if number == 3: sys.exit('no more')\n"
                           "    assert asked['looks'][0]['lines']\n"
                           "    say({'status': 'answered', 'node': 2, 'pose': nodes[2]['pose']})"));
  ExperimentSettings s = settings(QueryProtocol::path);
  s.method = "program";
  s.localiser.command = "python3 '" + program.string() + "'";
  const LocalisationExperiment robot = experiment(s);
  const auto trials = robot.run_block({.block = 0, .first = 0, .count = 10});
  ASSERT_EQ(trials.size(), 10u);
  const TopologicalMap map = robot.record_map(0, robot.map_estimator_rig(0));
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const bool dies = i % 4 == 3;
    EXPECT_EQ(trials[i].status, dies ? LocalisationStatus::failed : LocalisationStatus::answered);
    EXPECT_FALSE(dies && trials[i].success());
    if (!dies) {
      EXPECT_NEAR(trials[i].node.x_m, map.nodes[2].pose.x_m, 1e-9);
      EXPECT_GT(trials[i].cpu_ms, 0);
    }
  }
}

TEST_F(Experiments, RunsALocaliserOfOnesOwn) {
  ExperimentSettings s = settings(QueryProtocol::near_path);
  s.looks = 3;
  const LocalisationExperiment robot = experiment(s);
  const TopologicalMap map = robot.record_map(0, robot.map_estimator_rig(0));
  const First first(map);
  const TrialResult trial = robot.run_trial(5, robot.estimator_rig(5), map, first);
  EXPECT_EQ(trial.looks, 3);
  EXPECT_EQ(first.turns, (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(trial.status, LocalisationStatus::unsure);
  EXPECT_FALSE(trial.success());
  EXPECT_NEAR(trial.error, distance_m(map.nodes[0].pose, trial.truth), 1e-12);
}

/// Corners in views change nothing of what is drawn, nor of what other methods answer.
TEST_F(Experiments, LinesAreTheSameWithCornersInTheViews) {
  ExperimentSettings s = settings(QueryProtocol::path);
  const auto without = experiment(s).run_block({.block = 0, .first = 0, .count = 6});
  s.localiser.corners = true;
  const LocalisationExperiment with_corners = experiment(s);
  const auto with = with_corners.run_block({.block = 0, .first = 0, .count = 6});
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].status, without[i].status);
    EXPECT_EQ(with[i].score, without[i].score);
    EXPECT_EQ(with[i].answer.x_m, without[i].answer.x_m);
    EXPECT_EQ(with[i].lines, without[i].lines);
    EXPECT_EQ(with[i].corners, without[i].corners);
  }
  const TopologicalMap map = with_corners.record_map(0, rig_.rig);
  std::size_t corners = 0;
  for (const MapNode& node : map.nodes) corners += node.view.corners.size();
  EXPECT_GT(corners, 10 * map.nodes.size());
}

TEST_F(Experiments, CornersFindTheRobotExactlyWithoutErrors) {
  ExperimentSettings s = settings(QueryProtocol::near_path);
  s.method = "corners";
  s.sources = no_sources();
  s.appearance = {};
  int answered = 0;
  for (const TrialResult& t : experiment(s).run_block({.block = 0, .first = 0, .count = 20})) {
    answered += t.answered();
    if (t.answered()) {
      EXPECT_LT(t.error, 1e-4);
    }
  }
  EXPECT_GE(answered, 14);
}

struct CornerShares {
  double corners = 0, mismatched = 0, answered = 0, wrong = 0;
};

CornerShares shares_of(const std::vector<TrialResult>& trials) {
  CornerShares shares;
  const auto n = static_cast<double>(trials.size());
  for (const TrialResult& t : trials) {
    shares.corners += t.corners / n;
    shares.mismatched += t.corner_mismatches / n;
    shares.answered += t.answered() / n;
    shares.wrong += (t.answered() && !t.success()) / n;
  }
  return shares;
}

/// psi_cd takes its share of corners, and answers with them; psi_cm spoils its share, which the
/// consensus sorts out.
TEST_F(Experiments, LostAndMismatchedCornersActOnCorners) {
  ExperimentSettings s = settings(QueryProtocol::path);
  s.method = "corners";
  const auto shares = [&](double lost, double mismatched) {
    s.sources.corner_loss = lost;
    s.sources.corner_mismatch = mismatched;
    return shares_of(experiment(s).run_block({.block = 0, .first = 0, .count = 30}));
  };
  const CornerShares all = shares(0, 0), lost = shares(0.6, 0), wrong = shares(0, 0.3);
  EXPECT_NEAR(lost.corners / all.corners, 0.4, 0.05);
  EXPECT_NEAR(wrong.mismatched / wrong.corners, 0.3, 0.05);
  EXPECT_GT(all.answered, 0.5);
  EXPECT_LT(lost.answered, all.answered);
  EXPECT_GE(lost.answered + 1e-9, shares(0.9, 0).answered);
  EXPECT_LE(all.wrong + wrong.wrong, 0.1);
}

/// Two rooms of the same furniture are a tie for corners; with corners of their own they are not.
TEST(RepeatedRooms, ConfuseCorners) {
  const auto answered_of = [](bool repeated) {
    WorldDescription description;
    description.templates = {{"room", {}}, {"other", {}}};
    for (int i = 0; i < 60; ++i) {
      const double a = 0.7 * i, height = 0.3 + 0.033 * i;
      const Eigen::Vector3d at(3.5 + 1.5 * std::cos(a), 2 * std::sin(1.3 * a), height);
      for (WorldTemplate& room : description.templates) {
        room.features.corners_m.push_back(at);
        room.features.segments_m.emplace_back(at, at + Eigen::Vector3d(0, 0, 0.3));
      }
    }
    description.instances = {{"room", {0, 0, 0}, 0}, {repeated ? "room" : "other", {30, 0, 0}, 0}};
    for (const double x : {0.0, 30.0}) description.route.push_back({{{x, 0}, {x + 1.5, 0}}});
    const World world = build_world(description);
    const Visibility visibility(world);
    ExperimentSettings s;
    s.method = "corners";
    s.protocol = QueryProtocol::near_path;
    const auto views =
        std::make_shared<MapViews>(map_views(visibility, test::nominal_rig().rig, s));
    const LocalisationExperiment experiment(visibility, test::nominal_rig(), views, s);
    return shares_of(experiment.run_block({.block = 0, .first = 0, .count = 20})).answered;
  };
  EXPECT_LT(answered_of(true), 0.3);
  EXPECT_GT(answered_of(false), 0.8);
}

bool same(const TrialResult& a, const TrialResult& b) {
  return a.truth.x_m == b.truth.x_m && a.truth.heading_rad == b.truth.heading_rad &&
         a.status == b.status && a.answer.x_m == b.answer.x_m && a.score == b.score &&
         a.lines == b.lines;
}

/// The told mount stays, the true one varies: queries stand where they stood, and see otherwise.
TEST_F(Experiments, MountErrorsActOnWhatIsSeen) {
  ExperimentSettings s = settings(QueryProtocol::path);
  const TrialBlock block{.block = 0, .first = 0, .count = 12};
  const auto exact = experiment(s).run_block(block);
  s.sources.mount_height_m = 0.02;
  s.sources.mount_pitch_deg = 1;
  s.sources.mount_roll_deg = 1;
  const LocalisationExperiment robot = experiment(s);
  const auto off = robot.run_block(block), again = experiment(s).run_block(block);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(exact[i].truth.x_m, off[i].truth.x_m);
    EXPECT_FALSE(same(exact[i], off[i]));
    EXPECT_TRUE(same(off[i], again[i]));
    before += exact[i].error <= 1;
    after += off[i].error <= 1;
  }
  EXPECT_LE(after, before);
  // Each map's drive has a mount of its own.
  const TopologicalMap a = robot.record_map(0, rig_.rig), b = robot.record_map(1, rig_.rig);
  s.sources.mount_height_m = s.sources.mount_pitch_deg = s.sources.mount_roll_deg = 0;
  const TopologicalMap told = experiment(s).record_map(0, rig_.rig);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  EXPECT_EQ(a.nodes[1].view.mount.height_m, s.mount.height_m);
  EXPECT_EQ(a.nodes[1].pose.x_m, told.nodes[1].pose.x_m);
  EXPECT_NE(a.nodes[1].view.lines[0].a_m, told.nodes[1].view.lines[0].a_m);
  EXPECT_NE(a.nodes[1].view.lines[0].a_m, b.nodes[1].view.lines[0].a_m);
}

/// The map is of the world as it was, queries of the changed one, where they can stand.
TEST_F(Experiments, MovedFurnitureActsOnQueriesOnly) {
  ExperimentSettings s = settings(QueryProtocol::anywhere);
  const auto before = experiment(s).run_block({.block = 0, .first = 0, .count = 16});
  const TopologicalMap recorded = experiment(s).record_map(0, rig_.rig);
  s.sources.moved = 0.5;
  const LocalisationExperiment robot = experiment(s);
  const TopologicalMap map = robot.record_map(0, rig_.rig);
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    ASSERT_EQ(map.nodes[i].view.lines.size(), recorded.nodes[i].view.lines.size());
    for (std::size_t k = 0; k < map.nodes[i].view.lines.size(); ++k) {
      EXPECT_EQ(map.nodes[i].view.lines[k].a_m, recorded.nodes[i].view.lines[k].a_m);
    }
  }
  const ChangedWorld changed(world_, 0.5, s.seed);
  const auto after = robot.run_block({.block = 0, .first = 0, .count = 16});
  int differ = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto trial = static_cast<std::uint32_t>(i);
    const Pose2D stands =
        draw_query(changed.visibility, s.protocol, s.mount.height_m, s.seed, trial);
    EXPECT_EQ(after[i].truth.x_m, stands.x_m);
    EXPECT_EQ(after[i].truth.y_m, stands.y_m);
    differ += !same(before[i], after[i]);
  }
  EXPECT_GT(differ, 8);
}

/// Everything together, by blocks in 1, 2 and 8 threads.
TEST_F(Experiments, AreTheSameInAnyNumberOfThreads) {
  ExperimentSettings s = settings(QueryProtocol::path);
  s.sources.clutter = 0.2;
  s.sources.merge_px = 2;
  s.sources.mount_height_m = 0.01;
  s.sources.mount_roll_deg = 0.5;
  s.sources.moved = 0.1;
  const LocalisationExperiment robot = experiment(s);
  constexpr std::uint32_t blocks = 8;
  const auto all = [&](std::uint32_t threads) {
    std::vector<std::vector<TrialResult>> results(blocks);
    std::vector<std::thread> running;
    for (std::uint32_t t = 0; t < threads; ++t) {
      running.emplace_back([&, t] {
        for (std::uint32_t i = t; i < blocks; i += threads) {
          results[i] = robot.run_block({.block = i, .first = 2 * i, .count = 2});
        }
      });
    }
    for (std::thread& thread : running) thread.join();
    return results;
  };
  const auto one = all(1);
  for (const std::uint32_t threads : {2u, 8u}) {
    const auto many = all(threads);
    for (std::uint32_t i = 0; i < blocks; ++i) {
      for (int k = 0; k < 2; ++k) EXPECT_TRUE(same(one[i][k], many[i][k])) << i;
    }
  }
}

/// A source's program that gives up in a query spoils its trial, in the map all trials of it.
TEST_F(Experiments, SurviveASourceThatDies) {
  const test::Folder folder;
  const auto run = [&](const std::string& when) {
    const auto program = folder.write(
        "mine.py",
        test::python_program("sys.stdin.readline()\n",
                             "view = asked\n"
                             "    if " +
                                 when +
                                 ": sys.exit('no more')\n"
                                 "    say({'edges': [{'id': e['id']} for e in view['edges']]})"));
    ExperimentSettings s = settings(QueryProtocol::path);
    s.map_spacing_m = 2;
    s.sources.command = "python3 '" + program.string() + "'";
    return experiment(s).run_block({.block = 0, .first = 0, .count = 6});
  };
  const auto query_fails = run("view['trial'] == 3"),
             map_fails = run("view['trial'] == 2**31 and view['frame'] == 2");
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(query_fails[i].status == LocalisationStatus::failed, i == 3) << i;
    EXPECT_EQ(query_fails[i].failure.find("no more") != std::string::npos, i == 3) << i;
    EXPECT_EQ(map_fails[i].status, LocalisationStatus::failed);
    EXPECT_EQ(map_fails[i].truth.x_m, query_fails[i].truth.x_m);
    EXPECT_FALSE(map_fails[i].success());
  }
}

/// Answers what no method may.
class Nonsense : public Localiser {
 public:
  explicit Nonsense(LocalisationAnswer answer) : answer_(std::move(answer)) {}
  LocalisationAnswer localise(const PlaceView&) const override {
    if (answer_.score < 0) throw std::runtime_error("no luck");
    return answer_;
  }

 private:
  LocalisationAnswer answer_;
};

TEST_F(Experiments, NonsenseOfALocaliserIsAFailedTrial) {
  const ExperimentSettings s = settings(QueryProtocol::path);
  const LocalisationExperiment e{visibility_, rig_, nullptr, s};
  LocalisationAnswer sound;
  sound.status = LocalisationStatus::answered;
  sound.probability = 0.5;
  const auto trial = [&](const LocalisationAnswer& answer) {
    return e.run_trial(0, rig_.rig, {}, Nonsense(answer));
  };
  EXPECT_EQ(trial(sound).status, LocalisationStatus::answered);
  EXPECT_EQ(trial(sound).probability, 0.5);
  const auto expect_failed = [&](const LocalisationAnswer& answer, const char* why) {
    const TrialResult failed = trial(answer);
    EXPECT_EQ(failed.status, LocalisationStatus::failed);
    EXPECT_EQ(failed.failure, why);
    EXPECT_FALSE(failed.success());
  };
  LocalisationAnswer answer = sound;
  answer.probability = 7;
  expect_failed(answer, "the localiser states a probability of 7");
  answer = sound;
  answer.pose.y_m = std::nan("");
  expect_failed(answer, "the localiser's pose is not finite");
  answer = sound;
  answer.score = -1;
  expect_failed(answer, "the localiser threw: no luck");
}

TEST_F(Experiments, ABlockWithoutViewsOfTheMapIsRefused) {
  const LocalisationExperiment e{visibility_, rig_, nullptr, settings(QueryProtocol::path)};
  EXPECT_EQ(test::error_message([&] { e.run_block({.count = 1}); }),
            "localisation experiment: has no views of the map; give those of map_views");
}

}  // namespace
}  // namespace vernier
