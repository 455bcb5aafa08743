// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/camera/model_nesting.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/sense.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_scenes.h"
#include "sim/study/study_store.h"
#include "sim/told/fresh_calibrations.h"
#include "tests/support/error_message.h"
#include "tests/support/example_study.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

const std::string head = "[study]\ntrials = 12\nprotocol = \"near_path\"\n[map]\nspacing_m = 2\n";

std::string told_complaint(const std::string& text) {
  return test::error_message([&] { parse_study(text, "s.toml"); });
}

bool complains(const std::string& text, const std::string& about) {
  const std::string complaint = told_complaint(text);
  return complaint.find(about) != std::string::npos || (ADD_FAILURE() << complaint, false);
}

/// The rig with its covariance scaled: another calibration of the same rig.
RigEstimate looser(double factor) {
  RigEstimate rig = test::nominal_rig();
  rig.covariance->matrix *= factor;
  return rig;
}

Study study_of(const std::string& text) {
  Study study = test::office_study(head + text);
  RigEstimate richer = test::nominal_rig();
  richer.rig = vernier::internal::in_models(richer.rig, {OpenCv4{}, OpenCv4{}});
  richer.covariance.reset();
  study.told_rigs["truth.json"] = {test::nominal_rig(), "nominal"};
  study.told_rigs["loose.json"] = {looser(9), "loose"};
  study.told_rigs["richer.json"] = {richer, "richer"};
  OfficeOptions options;
  options.size_m = {8, 9, 2.5};
  study.other_worlds["other"] = {build_world(make_office(32, options)), "other"};
  return study;
}

class ToldStudies : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("vernier_told_" + std::to_string(getpid()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<CellResult> run(const Study& study, int threads = 1) {
    const std::filesystem::path folder = folder_ / std::to_string(++runs_);
    run_study(study, {folder, threads, {}, {}, {}});
    return study_results(study, folder).cells;
  }

  /// Everything but the timings.
  static std::string words(const CellResult& cell) {
    std::string text = std::to_string(cell.ceiling ? cell.ceiling->success : -1) + "\n";
    for (const TrialResult& t : cell.trials) {
      char line[400];
      std::snprintf(line, sizeof line, "%u %d %a %a %a %a %a %a %d\n", t.trial,
                    static_cast<int>(t.status), t.truth.x_m, t.truth.heading_rad, t.answer.x_m,
                    t.answer.heading_rad, t.error, t.score, t.lines);
      text += line;
    }
    return text;
  }

  std::filesystem::path folder_;
  int runs_ = 0;
};

TEST_F(ToldStudies, ARigThatIsItsOwnTruthIsADrawAboutThatTruth) {
  const auto before = run(study_of("[rig]\nfile = \"truth.json\"\n"));
  const auto told = run(study_of("[rig]\ntruth = \"truth.json\"\nfile = \"truth.json\"\n"));
  EXPECT_EQ(words(before[0]), words(told[0]));
}

TEST_F(ToldStudies, TheTruthToldIsNoCalibrationError) {
  const auto none = run(study_of("[sources]\ncalibration = 0\n"));
  const auto given =
      run(study_of("[rig]\ntruth = \"truth.json\"\nfile = \"truth.json\"\nerror = \"given\"\n"));
  const auto unscaled = run(study_of(
      "[rig]\ntruth = \"truth.json\"\nfile = \"loose.json\"\n[sources]\ncalibration = 0\n"));
  EXPECT_EQ(words(none[0]), words(given[0]));
  EXPECT_EQ(words(none[0]), words(unscaled[0]));
}

TEST_F(ToldStudies, CellsOfASweepAreTheStudiesOfTheirValuesToTheBit) {
  const auto rigs =
      run(study_of("[rig]\ntruth = \"truth.json\"\n[sweep]\n"
                   "\"rig.file\" = [\"truth.json\", \"loose.json\"]\n"
                   "\"rig.error\" = [\"drawn\", \"given\"]\n"));
  ASSERT_EQ(rigs.size(), 4u);
  const auto alone = run(study_of("[rig]\ntruth = \"truth.json\"\nfile = \"loose.json\"\n"), 2);
  EXPECT_EQ(words(rigs[2]), words(alone[0]));
  EXPECT_EQ(words(rigs[1]), words(rigs[3]));  // the same rig, whatever its covariance
  EXPECT_NE(words(rigs[0]), words(rigs[2]));
  for (const CellResult& cell : rigs) {
    for (std::size_t i = 0; i < cell.trials.size(); ++i) {
      EXPECT_EQ(cell.trials[i].truth.x_m, rigs[0].trials[i].truth.x_m);
    }
  }
}

TEST_F(ToldStudies, SweptWorldsAreTheStudiesOfEachWorld) {
  const auto both =
      run(study_of("[sweep]\n\"world.file\" = [\"workshop\", \"other\"]\n"
                   "\"sources.calibration\" = [0, 1]\n"));
  ASSERT_EQ(both.size(), 4u);
  const auto first = run(study_of("[sweep]\n\"sources.calibration\" = [0, 1]\n"));
  EXPECT_EQ(words(both[0]), words(first[0]));
  EXPECT_EQ(words(both[1]), words(first[1]));
  Study other = study_of("[world]\nfile = \"other\"\n[sweep]\n\"sources.calibration\" = [0, 1]\n");
  other.world = other.other_worlds.at("other").world;
  other.world_fingerprint = "other";
  other.other_worlds.clear();
  const auto second = run(other);
  EXPECT_EQ(words(both[2]), words(second[0]));
  EXPECT_EQ(words(both[3]), words(second[1]));
  EXPECT_NE(words(both[1]), words(both[3]));
}

TEST_F(ToldStudies, EachTrialAndEachMapIsToldACalibrationOfItsOwn) {
  const Study study =
      study_of("[calibration]\nviews = 4\n[sweep]\n\"sources.calibration\" = [0, 1]\n");
  const auto cells = run(study, 2);
  ASSERT_TRUE(cells[1].calibrations);
  EXPECT_EQ(cells[1].calibrations->calibrations, 100);
  EXPECT_EQ(words(cells[0]), words(run(study_of("[sources]\ncalibration = 0\n"))[0]));
  EXPECT_NE(words(cells[0]), words(cells[1]));
  EXPECT_EQ(words(cells[1]), words(run(study_of("[calibration]\nviews = 4\n"))[0]));
}

TEST_F(ToldStudies, ATrialWhoseCalibrationFailsHasFailed) {
  const auto cells = run(study_of("[calibration]\nviews = 3\ntilt_deg = 0.01\n"));
  ASSERT_TRUE(cells[0].calibrations);
  EXPECT_EQ(cells[0].calibrations->failed, 100);
  for (const TrialResult& trial : cells[0].trials) {
    EXPECT_EQ(trial.status, localise::LocalisationStatus::failed);
    EXPECT_FALSE(trial.success());
  }
}

TEST_F(ToldStudies, AToldLensModelMayDifferFromTheTrueOne) {
  // The richer model with the same coefficients is the same camera.
  const auto none = run(study_of("[sources]\ncalibration = 0\n"));
  const auto richer =
      run(study_of("[rig]\ntruth = \"truth.json\"\nfile = \"richer.json\"\nerror = \"given\"\n"));
  for (std::size_t i = 0; i < none[0].trials.size(); ++i) {
    const TrialResult &a = none[0].trials[i], &b = richer[0].trials[i];
    EXPECT_EQ(a.status, b.status);
    if (a.answered()) {
      EXPECT_NEAR(a.error, b.error, 1e-6);
    }
  }
  const auto pinhole = run(study_of("[calibration]\nviews = 20\nmodel = \"pinhole\"\n"));
  EXPECT_EQ(pinhole[0].trials.size(), 12u);
  EXPECT_GT(pinhole[0].calibrations->depth_error_m, 0.01);  // k1 is -0.05
}

TEST_F(ToldStudies, WhatDoesNotFitIsRefusedBeforeAnythingIsWritten) {
  const auto message = [&](const std::string& text) {
    return test::error_message([&] { run(study_of(text)); });
  };
  const std::string rig = "[rig]\ntruth = \"truth.json\"\nfile = \"richer.json\"\n";
  EXPECT_NE(message(rig).find("richer.json"), std::string::npos);
  EXPECT_NE(message(rig + "error = \"given\"\n[sources]\ncalibration = 2\n")
                .find("cannot scale the difference of lens models"),
            std::string::npos);
  EXPECT_NE(message("[calibration]\nmodel = \"pinhole\"\n[sources]\ncalibration = 2\n")
                .find("cannot scale the difference of lens models"),
            std::string::npos);
  EXPECT_TRUE(!std::filesystem::exists(folder_) || std::filesystem::is_empty(folder_));
}

TEST_F(ToldStudies, RigsThatNoCamerasCanHaveAreFailedTrials) {
  const auto cells = run(study_of("[calibration]\nviews = 4\n[sources]\ncalibration = 1000\n"));
  int failed = 0;
  for (const TrialResult& trial : cells[0].trials) {
    failed += trial.status == localise::LocalisationStatus::failed ? 1 : 0;
  }
  EXPECT_GE(failed, 10);  // the focal length has a standard deviation of a hundred focal lengths
}

TEST_F(ToldStudies, TheTruthNeedsNoCovariance) {
  Study study =
      study_of("[rig]\ntruth = \"truth.json\"\nfile = \"bare.json\"\n[sources]\ncalibration = 0\n");
  study.told_rigs["bare.json"] = study.told_rigs["truth.json"];
  study.told_rigs["bare.json"].estimate.covariance.reset();
  EXPECT_EQ(words(run(study)[0]), words(run(study_of("[sources]\ncalibration = 0\n"))[0]));
}

TEST_F(ToldStudies, TheRecordOfCalibrationsDoesNotDependOnThreadsAndCanBeStopped) {
  const Study study = study_of("[calibration]\nviews = 4\n");
  const std::string key = calibration_key(study, study.file.cells[0]);
  const auto note = [&](const char* name) {
    const StoreNotes notes = stored_results(folder_ / name).notes();
    const auto found = notes.find(key);
    return found == notes.end() ? std::string() : found->second;
  };
  std::vector<int> told;
  StudyRun one{.folder = folder_ / "one", .threads = 1, .shard = {}, .command = ""};
  one.calibration_progress = [&](int done, int total) {
    EXPECT_EQ(total, 100);
    told.push_back(done);
  };
  run_study(study, one);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back(), 100);
  run_study(study, {.folder = folder_ / "four", .threads = 4, .shard = {}, .command = ""});
  EXPECT_EQ(note("one"), note("four"));
  EXPECT_NE(note("one"), "");

  std::stop_source stop;
  StudyRun stopped{.folder = folder_ / "stopped", .threads = 2, .shard = {}, .command = ""};
  stopped.stop = stop.get_token();
  int most = 0;
  stopped.calibration_progress = [&](int done, int) {
    most = std::max(most, done);
    stop.request_stop();
  };
  stopped.progress = [](int done, int) { EXPECT_EQ(done, 0); };
  run_study(study, stopped);
  EXPECT_LT(most, 100);
  EXPECT_EQ(note("stopped"), "");
  stopped.stop = {};
  stopped.progress = {};
  run_study(study, stopped);
  EXPECT_EQ(note("stopped"), note("one"));
}

TEST_F(ToldStudies, OneOfSeveralShardsRecordsTheCalibrations) {
  const Study study =
      study_of("[calibration]\nviews = 3\n[sweep]\n\"sources.calibration\" = [1, 2]\n");
  const std::string key = calibration_key(study, study.file.cells[0]);
  int recorded = 0;
  for (int i = 2; i >= 0; --i) {
    StudyRun run{.folder = folder_, .threads = 1, .shard = {i, 3}, .command = ""};
    run.calibration_progress = [&](int done, int) { recorded += done == 100 ? 1 : 0; };
    run_study(study, run);
    EXPECT_EQ(stored_results(folder_).notes().count(key), i == 0 ? 1u : 0u);
  }
  EXPECT_GE(recorded, 1);
}

TEST(ToldStudy, OfManyCalibrationsThatDifferOnlyTheLatestAreKept) {
  std::string views;
  for (int i = 3; i < 63; ++i) views += (i > 3 ? ", " : "") + std::to_string(i);
  const Study study = study_of("[calibration]\n[sweep]\n\"calibration.views\" = [" + views + "]\n");
  StudyScenes scenes(study);
  std::vector<std::weak_ptr<const FreshCalibrations>> made;
  for (const StudyCell& cell : study.file.cells) made.push_back(scenes.calibrations(cell));
  EXPECT_EQ(std::count_if(made.begin(), made.end(), [](const auto& of) { return !of.expired(); }),
            30);
  EXPECT_TRUE(made.front().expired());
  EXPECT_EQ(scenes.calibrations(study.file.cells.back()), made.back().lock());
}

TEST(ToldStudy, TheBoardOfARigFileIsNotRecordedAsASetting) {
  Study study = study_of("[calibration]\nobservations = \"rig.json\"\n");
  study.corners_fingerprint = "corners";
  const StudyCell& cell = study.file.cells[0];
  EXPECT_EQ(cell.settings.count("calibration.board"), 0u);
  EXPECT_EQ(cell.settings.count("calibration.square_m"), 0u);
  // The key stays as stores have it.
  EXPECT_NE(cell_key(study, cell).find("\"calibration.board\":\"9x6\""), std::string::npos);
  EXPECT_EQ(study_of("[calibration]\nobservations = \"c.vnl\"\n")
                .file.cells[0]
                .settings.count("calibration.board"),
            1u);
}

TEST(ToldStudy, WhatDoesNotFitTheCornersNamesItsLine) {
  Study study = study_of("[calibration]\nviews = 21\nobservations = \"rig.json\"\n");
  study.corners = std::make_shared<const BoardObservations>(
      simulate_board(test::nominal_rig().rig, {}, {.seed = 3, .frames = 20}).observations);
  const auto message = [](const Study& of) {
    return test::error_message([&] { StudyScenes(of).told(of.file.cells[0]); });
  };
  EXPECT_EQ(
      message(study).rfind("s.toml:7: calibration.views = 21: the corners are of 20 frames", 0), 0u)
      << message(study);
  study = study_of("[calibration]\nmodel = \"pinhole\"\n[sources]\ncalibration = 2\n");
  EXPECT_EQ(message(study).rfind("s.toml:7: calibration.model: sources.calibration = 2 cannot", 0),
            0u)
      << message(study);
  study = study_of("[sources]\ncalibration = 2\n[sweep]\n\"calibration.model\" = [\"pinhole\"]\n");
  EXPECT_EQ(message(study).rfind("s.toml:9: calibration.model: ", 0), 0u) << message(study);
}

TEST(ToldStudy, KeysHoldTheContentOfFilesAndNotTheirNames) {
  const auto key = [](const Study& study) { return cell_key(study, study.file.cells[0]); };
  const std::string text = "[rig]\ntruth = \"truth.json\"\nfile = \"loose.json\"\n";
  Study study = study_of(text);
  const std::string loose = key(study);
  study.told_rigs["loose.json"].fingerprint = "changed";
  EXPECT_NE(key(study), loose);
  Study renamed = study_of("[rig]\ntruth = \"t.json\"\nfile = \"l.json\"\n");
  renamed.told_rigs["l.json"] = {looser(9), "loose"};
  EXPECT_EQ(key(renamed), loose);
  std::set<std::string> keys{loose};
  for (const char* other :
       {"[rig]\ntruth = \"truth.json\"\nfile = \"loose.json\"\nerror = \"given\"\n",
        "[rig]\ntruth = \"truth.json\"\nfile = \"truth.json\"\n", "", "[calibration]\n",
        "[calibration]\nviews = 5\n", "[calibration]\nmodel = \"opencv4\"\n",
        "[calibration]\npixel_sigma_px = 0.3\n", "[calibration]\nboard = \"8x6\"\n"}) {
    EXPECT_TRUE(keys.insert(key(study_of(other))).second) << other;
  }
  EXPECT_EQ(key(study_of("")).find("told"), std::string::npos);  // as stores of before have it
}

TEST(ToldStudy, BadInputNamesTheLineAndTheRemedy) {
  const std::string s = "[study]\n";
  EXPECT_TRUE(complains(s + "[rig]\nfile = \"a\"\n[sweep]\n\"rig.file\" = [\"a\", \"b\"]\n",
                        "s.toml:5: a rig is its own truth unless rig.truth is given"));
  EXPECT_TRUE(complains(s + "[rig]\ntruth = \"a\"\n", "s.toml:3: rig.truth is given, and nothing"));
  EXPECT_TRUE(
      complains(s + "[rig]\nerror = \"given\"\nfile = \"a\"\n", "rig.error needs rig.truth"));
  EXPECT_TRUE(
      complains(s + "[rig]\ntruth = \"a\"\nfile = \"b\"\nerror = \"mine\"\n", "s.toml:5: "));
  EXPECT_TRUE(complains(s + "[rig]\ntruth = \"a\"\nfile = \"b\"\n[calibration]\n",
                        "s.toml:4: rig.file has no effect"));
  EXPECT_TRUE(complains(s + "[sweep]\n\"calibration.views\" = [2, 5]\n",
                        "s.toml:3: calibration.views = 2 is out of range"));
  EXPECT_TRUE(complains(s + "[calibration]\nviews = 5.5\n", "s.toml:3: "));
  EXPECT_TRUE(complains(s + "[calibration]\nboard = \"9 x 6\"\n", "s.toml:3: calibration.board"));
  EXPECT_TRUE(complains(s + "[calibration]\nmodel = \"fish\"\n", "s.toml:3: calibration.model"));
  EXPECT_TRUE(complains(s + "[calibration]\nview = 5\n", "views"));
  EXPECT_TRUE(complains(s + "[calibration]\nobservations = \"c.vnl\"\ntilt_deg = 3\n",
                        "s.toml:4: calibration.tilt_deg is of simulated views"));
  EXPECT_TRUE(complains(s + "[calibration]\nobservations = \"\"\n",
                        "s.toml:3: calibration.observations is empty"));
  EXPECT_TRUE(complains(s + "[calibration]\nobservations = \"rig.json\"\nsquare_m = 0.03\n",
                        "s.toml:4: calibration.square_m is that of calibration.observations"));
  EXPECT_TRUE(complains(s + "[calibration]\nobservations = \"rig.json\"\nboard = \"8x5\"\n",
                        "s.toml:4: calibration.board is that of calibration.observations"));
  EXPECT_EQ(told_complaint(s + "[calibration]\nobservations = \"c.vnl\"\nboard = \"8x5\"\n"), "");
  EXPECT_TRUE(
      complains(s + "[rig]\ntruth = \"a\"\nfile = \"b\"\n[sweep]\n\"rig.truth\" = [\"a\"]\n",
                "cannot be swept"));
  EXPECT_EQ(told_complaint(s + "[rig]\ntruth = \"a\"\n[sweep]\n\"rig.file\" = [\"b\", \"c\"]\n"),
            "");
}

// The images of a truth do not know what is told of it.
TEST(ToldExperiment, TheSameIsSensedWhateverIsTold) {
  ExperimentSettings s;
  s.seed = 5;
  const auto& visibility = test::small_office_visibility();
  const RigEstimate& rig = test::nominal_rig();
  const auto views = std::make_shared<MapViews>(map_views(visibility, rig.rig, s));
  const Rig wrong = RigSampler(rig).sample(20, 3, 0);
  const LocalisationExperiment drawn(visibility, rig, views, s);
  const LocalisationExperiment given(visibility, rig, views, s, nullptr, nullptr,
                                     given_rig(rig.rig, wrong, 1, "wrong"));
  EXPECT_EQ(parameters(given.estimator_rig(3)), parameters(wrong));
  EXPECT_EQ(parameters(given.map_estimator_rig(0)), parameters(wrong));
  // Both record with the same rig: then they are the same map, line by line.
  const auto a = drawn.record_map(2, wrong), b = given.record_map(2, wrong);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    const auto &lines = a.nodes[i].view.lines, &others = b.nodes[i].view.lines;
    ASSERT_EQ(lines.size(), others.size());
    for (std::size_t j = 0; j < lines.size(); ++j) EXPECT_EQ(lines[j].a_m, others[j].a_m);
  }
}

}  // namespace
}  // namespace vernier
