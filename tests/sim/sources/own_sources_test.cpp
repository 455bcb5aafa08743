// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "calib/error.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/python_program.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;

namespace {

using test::error_message;
using test::Folder;

/// Leaves out every n-th edge.
class EveryNth : public UncertaintySource {
 public:
  explicit EveryNth(const SourceOptions& options) : n_(options.at("n")) {}
  std::string_view name() const override { return "every_nth"; }
  void apply(const SensingContext&, SensedView& view) const override {
    std::size_t i = 0;
    std::erase_if(view.edges,
                  [&](const SensedEdge&) { return ++i % static_cast<std::size_t>(n_) == 0; });
  }

 private:
  double n_;
};

void register_every_nth() {
  static const bool once = [] {
    register_source("every_nth", [](const SourceOptions& options) {
      return std::make_unique<EveryNth>(options);
    });
    return true;
  }();
  (void)once;
}

TEST(OwnSource, ActsAfterTheOthersWhereItIsNamed) {
  register_every_nth();
  SourceSettings settings;
  const auto& rig = test::nominal_rig().rig;
  const StereoObservation without = Sensor(rig, settings).sense(test::office_look());
  settings.own = {{"every_nth", {{"n", 2}}}};
  const StereoObservation with = Sensor(rig, settings).sense(test::office_look());
  const auto edges = without.segments.size() + without.left_only.size();
  EXPECT_EQ(with.segments.size() + with.left_only.size(), edges - edges / 2);
  // What is left is what it was.
  std::size_t at = 0;
  for (const stereo::StereoSegment& s : with.segments) {
    while (at < without.segments.size() && without.segments[at].feature != s.feature) ++at;
    ASSERT_LT(at, without.segments.size());
    EXPECT_EQ(without.segments[at].left.a_px, s.left.a_px);
    EXPECT_EQ(without.segments[at].right.b_px, s.right.b_px);
  }
}

TEST(OwnSource, IsRefusedWithoutANameOrUnderATakenOne) {
  register_every_nth();
  const auto refused = [](const std::string& name) {
    return error_message(
        [&] { register_source(name, [](const SourceOptions&) { return nullptr; }); });
  };
  EXPECT_NE(refused("every_nth").find("is taken"), std::string::npos);
  EXPECT_NE(refused("edge_loss").find("is taken"), std::string::npos);
  EXPECT_NE(refused("command").find("is taken"), std::string::npos);
  EXPECT_NE(refused("").find("no name"), std::string::npos);
  EXPECT_NE(refused("a.b").find("no name"), std::string::npos);
  SourceSettings settings;
  settings.own = {{"unheard_of", {}}};
  const std::string complaint = error_message([&] { Sensor(test::nominal_rig().rig, settings); });
  EXPECT_NE(complaint.find("is not registered; use"), std::string::npos) << complaint;
}

/// A program in Python, and what it does with each view.
std::string python(const Folder& folder, const std::string& with_view) {
  const std::string program =
      test::python_program("cameras = json.loads(sys.stdin.readline())['cameras']\n",
                           "view = asked\n    edges = view['edges']\n    " + with_view);
  return "python3 '" + folder.write("program.py", program).string() + "'";
}

SourceSettings running(const std::string& command, double time_limit_s = 10) {
  SourceSettings settings;
  settings.command = command;
  settings.time_limit_s = time_limit_s;
  return settings;
}

StereoObservation sensed_with(const SourceSettings& settings, std::uint32_t trial = 0) {
  return Sensor(test::nominal_rig().rig, settings)
      .sense(test::office_look(), {.seed = 7, .trial = trial, .frame = 2});
}

StereoObservation sense_by(const Sensor& sensor, std::uint32_t trial) {
  return sensor.sense(test::office_look(), {.seed = 7, .trial = trial, .frame = 2});
}

const std::string answer = "say({'edges': edges})";

TEST(ProgramSource, ThatReturnsEverythingChangesNothing) {
  const Folder folder;
  const StereoObservation bare = sensed_with({}),
                          echoed = sensed_with(running(python(
                              folder, "edges = [{'id': e['id']} for e in edges]; " + answer)));
  EXPECT_EQ(echoed.failure, "");
  ASSERT_EQ(bare.segments.size(), echoed.segments.size());
  ASSERT_EQ(bare.left_only.size(), echoed.left_only.size());
  for (std::size_t i = 0; i < bare.segments.size(); ++i) {
    EXPECT_EQ(bare.segments[i].feature, echoed.segments[i].feature);
    EXPECT_EQ(bare.segments[i].left.a_px, echoed.segments[i].left.a_px);
    EXPECT_EQ(bare.segments[i].right.b_px, echoed.segments[i].right.b_px);
  }
}

TEST(ProgramSource, LeavesOutMovesAndAdds) {
  const Folder folder;
  const StereoObservation bare = sensed_with({});
  const StereoObservation changed = sensed_with(running(python(
      folder,
      "assert view['seed'] == 7 and view['trial'] == 0 and view['frame'] == 2 and len(cameras) == "
      "2\n"
      "    edges = [e for e in edges if e['in_stereo']][1:]\n"
      "    edges[0]['left_px'] = [x + 1 for x in edges[0]['left_px']]\n"
      "    edges[1]['in_stereo'] = False\n"
      "    edges.append({'left_px': [320, 200, 320, 260], 'right_px': [300, 200, 300, 260]})\n"
      "    " +
          answer)));
  EXPECT_EQ(changed.failure, "");
  ASSERT_EQ(changed.segments.size(), bare.segments.size() - 1);
  ASSERT_EQ(changed.left_only.size(), 1u);
  EXPECT_LT((changed.left_only[0].a_px - bare.segments[2].left.a_px).norm(), 1e-9);
  EXPECT_LT(
      (changed.segments[0].left.a_px - bare.segments[1].left.a_px - Eigen::Vector2d(1, 1)).norm(),
      1e-9);
  EXPECT_LT((changed.segments[0].right.a_px - bare.segments[1].right.a_px).norm(), 1e-9);
  const stereo::StereoSegment& added = changed.segments.back();
  EXPECT_TRUE(changed.true_edges.back().is_false());
  EXPECT_FALSE(changed.true_edges.front().is_false());
  EXPECT_LT((added.left.b_px - Eigen::Vector2d(320, 260)).norm(), 1e-9);
  EXPECT_LT((added.right.a_px - Eigen::Vector2d(300, 200)).norm(), 1e-9);
  EXPECT_GT(changed.true_edges.back().a_m.z(), 0.1);
}

TEST(ProgramSource, WorksAsTheManualSays) {
  const SourceSettings settings =
      running("python3 " VERNIER_SOURCE_DIR "/docs/examples/own_source.py");
  const Sensor sensor(test::nominal_rig().rig, settings);
  double before = 0, kept = 0, ghosts = 0;
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const StereoObservation bare = sensed_with({}, trial), seen = sense_by(sensor, trial);
    ASSERT_EQ(seen.failure, "");
    before += static_cast<double>(bare.segments.size());
    for (const VisibleEdge& edge : seen.true_edges) (edge.is_false() ? ghosts : kept) += 1;
    const StereoObservation again = sense_by(sensor, trial);
    ASSERT_EQ(seen.segments.size(), again.segments.size());
    EXPECT_EQ(seen.segments.back().left.a_px, again.segments.back().left.a_px);
  }
  // 20 % missed, 10 % with a ghost, also of edges that stereo cannot use; six standard deviations.
  EXPECT_NEAR(kept / before, 0.8, 6 * std::sqrt(0.16 / before));
  EXPECT_GT(ghosts / before, 0.1 - 6 * std::sqrt(0.09 / before));
  EXPECT_LT(ghosts / before, 0.2);
}

/// What a program does wrong spoils the view, and the next one finds it started again.
TEST(ProgramSource, SurvivesItsProgram) {
  struct Fault {
    std::string does, says;
  };
  const Fault faults[] = {
      {"sys.exit('lost my way')", "lost my way"},
      {"time.sleep(60)", "no answer within"},
      {"print('hello', flush=True)", "nonsense"},
      {"say('{}')", "edges"},
      {"say('{\"edges\": 3}')", "nonsense"},
      {"say('{\"edges\": [{\"id\": 1}]}')", "no edge of the view"},
      {"say('{\"edges\": [{\"lft_px\": [1, 2, 3, 4]}]}')", "has an unknown key \"lft_px\""},
      {"say('{\"edges\": [{\"id\": -1}]}')", "no edge of the view"},
      {"say('{\"edges\": [{\"id\": 1e300}]}')", "no edge of the view"},
      {"say({'edges': edges + edges[:1]})", "twice"},
      {"say('{\"edges\": [{\"left_px\": [1, 2, 3, 4]}]}')", "right_px"},
      {"say('{\"edges\": [{\"left_px\": [1, 2, 3], \"right_px\": [1, 2, 3, 4]}]}')", "segment"},
      {"say('{\"edges\": [{\"left_px\": [1, 2, 1, 2], \"right_px\": [1, 2, 3, 4]}]}')", "segment"},
      {"say('{\"edges\": [{\"left_px\": [1, 2, 1, 9e9], \"right_px\": [1, 2, 3, 4]}]}')",
       "segment"},
      {"os.write(1, b'x' * 20000000)", "16 MB"},
      {"os.kill(os.getpid(), 9)", "ended"},
  };
  for (const Fault& fault : faults) {
    const Folder folder;
    const std::string mark = (folder.path() / "again").string();
    const Sensor sensor(
        test::nominal_rig().rig,
        running(python(folder, "if not os.path.exists('" + mark + "'): open('" + mark +
                                   "', 'w').close(); " + fault.does + "\n    else: " + answer),
                1.5));
    const StereoObservation spoilt = sensor.sense(test::office_look());
    EXPECT_NE(spoilt.failure.find(fault.says), std::string::npos)
        << fault.does << ": " << spoilt.failure;
    EXPECT_EQ(sensor.sense(test::office_look()).failure, "") << fault.does;
  }
}

TEST(ProgramSource, IsLeftAloneAfterThreeFailures) {
  const Folder folder;
  const Sensor sensor(test::nominal_rig().rig, running(python(folder, "time.sleep(60)"), 0.3));
  for (int i = 0; i < 300; ++i) {
    EXPECT_NE(sensor.sense(test::office_look()).failure.find("no answer"), std::string::npos);
  }
}

TEST(ProgramSource, SaysWhatItDoesWithTheRig) {
  const auto first = [](const std::string& command) {
    return sensed_with(running(command)).failure;
  };
  EXPECT_NE(first("python3 -c 'print(1)'").find("instead of"), std::string::npos);
  EXPECT_NE(first("false").find("ended"), std::string::npos);
}

TEST(ProgramSource, IsRefusedIfItCannotRun) {
  const auto message = [](const SourceSettings& settings) {
    return error_message([&] { Sensor(test::nominal_rig().rig, settings); });
  };
  EXPECT_NE(message(running("no-such-program-here --x")).find("no-such-program-here"),
            std::string::npos);
  EXPECT_NE(message(running("python3 'x")).find("unclosed quote"), std::string::npos);
  EXPECT_NE(message(running(" ")).find("is blank"), std::string::npos);
  EXPECT_NE(message(running("true", 0)).find("time_limit_s"), std::string::npos);
}

TEST(ProgramSource, AnswersSeveralThreadsAsOne) {
  const Folder folder;
  const Sensor sensor(test::nominal_rig().rig,
                      running(python(folder, "edges = edges[view['trial'] % 7:]; " + answer)));
  constexpr std::uint32_t trials = 16;
  const auto all = [&](std::size_t threads) {
    std::vector<StereoObservation> seen(trials);
    std::vector<std::thread> running_threads;
    for (std::size_t t = 0; t < threads; ++t) {
      running_threads.emplace_back([&, t] {
        for (std::size_t i = t; i < trials; i += threads) {
          seen[i] = sensor.sense(test::office_look(),
                                 {.seed = 7, .trial = static_cast<std::uint32_t>(i)});
        }
      });
    }
    for (std::thread& thread : running_threads) thread.join();
    return seen;
  };
  const auto one = all(1), eight = all(8);
  for (std::size_t i = 0; i < trials; ++i) {
    EXPECT_EQ(one[i].failure, "");
    ASSERT_EQ(one[i].segments.size(), eight[i].segments.size());
    for (std::size_t k = 0; k < one[i].segments.size(); ++k) {
      EXPECT_EQ(one[i].segments[k].left.a_px, eight[i].segments[k].left.a_px);
    }
  }
}

/// Does what a source must not do.
class Careless : public UncertaintySource {
 public:
  explicit Careless(double fault) : fault_(fault) {}
  std::string_view name() const override { return "careless"; }
  void apply(const SensingContext&, SensedView& view) const override {
    if (fault_ == 0) throw std::runtime_error("no\nluck");
    if (fault_ == 1) throw Error("careless", "gives up", "");
    if (fault_ == 2) view.edges.at(0).offset_px[1][0].y() = std::nan("");
    if (fault_ == 3) view.corners.at(0).pixel_px[0].x() = std::nan("");
  }

 private:
  double fault_;
};

TEST(OwnSource, ItsFaultsFailTheViewInItsName) {
  register_source("careless", [](const SourceOptions& options) {
    return std::make_unique<Careless>(options.at("fault"));
  });
  const auto& rig = test::nominal_rig().rig;
  const auto failure = [&](double fault) {
    SourceSettings settings;
    settings.own = {{"careless", {{"fault", fault}}}};
    return Sensor(rig, settings).sense(test::office_look()).failure;
  };
  const std::string not_finite =
      "source \"careless\" left a number that is not finite in an edge or a corner";
  EXPECT_EQ(failure(0), "source \"careless\" threw: no\\x0aluck");
  EXPECT_EQ(error_message([&] { failure(1); }), "careless: gives up");
  EXPECT_EQ(failure(2), not_finite);
  EXPECT_EQ(failure(3), not_finite);
  EXPECT_EQ(failure(4), "");
  SourceSettings settings;
  settings.own = {{"careless", {}}};
  EXPECT_EQ(error_message([&] { Sensor(rig, settings); }),
            "source \"careless\": an option that it needs is missing; give all its options");
}

TEST(Sensor, RefusesALengthOutOfRange) {
  for (const double length_px : {-1.0, std::nan("")}) {
    EXPECT_EQ(error_message([&] { Sensor(test::nominal_rig().rig, {}, length_px); }),
              "sensor: the least length of a line is negative or not finite; give it in pixels");
  }
}

}  // namespace
}  // namespace vernier
