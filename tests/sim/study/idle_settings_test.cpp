// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/idle_settings.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "localise/localiser.h"
#include "sim/moved_furniture.h"
#include "sim/sources.h"
#include "sim/study/one_at_a_time.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/systems/systems.h"
#include "sim/world.h"
#include "tests/support/error_message.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace sim;
using namespace vernier::sim::internal;

namespace {

const std::string six_trials = "[study]\ntrials = 6\n";

std::vector<std::string> idle_sources(const Study& study) {
  std::vector<std::string> keys;
  for (const IdleSource& source : check_settings_act(study)) keys.push_back(source.key);
  return keys;
}

TEST(IdleSettings, ARequestThatIsNotHeardIsRefused) {
  register_systems();
  const struct {
    const char *text, *complaint;
  } cases[] = {
      {"[localiser]\nmethod = \"pgh\"\nlooks = 2\n",
       "s.toml:5: localiser.looks has no effect: localiser.method is \"pgh\""},
      {"[localiser]\nmethod = \"pgh_baseline\"\ncandidates = 7\n",
       "s.toml:5: localiser.candidates"},
      {"[sweep]\n\"localiser.stages\" = [\"align+refine+compare\", \"none\"]\n",
       "s.toml:4: localiser.stages = \"none\" states no probability"},
      {"[localiser]\nmax_error_rate = 0.001\nlook_error_rate = 0.01\n",
       "s.toml:5: localiser.look_error_rate = 0.01 is above localiser.max_error_rate = 0.001"},
      {"[localiser]\nstages = \"align\"\nmax_error_rate = 1\nlook_error_rate = 0.01\n",
       "s.toml:6: localiser.look_error_rate has no effect: localiser.stages is \"align\""},
      {"[localiser]\nstages = \"align\"\nmax_error_rate = 1\nrepeats = 0.2\n",
       "s.toml:6: localiser.repeats has no effect: localiser.stages is \"align\""},
      {"[localiser]\nmethod = \"pgh\"\n[sweep]\n\"localiser.candidates\" = [16, 64]\n",
       "s.toml:6: localiser.candidates has no effect: pgh looks at 12 at most"},
      {"[localiser]\nmethod = \"pgh_baseline\"\n[sweep]\n\"sources.calibration\" = [0, 1]\n",
       "s.toml:6: sources.calibration has no effect: localiser.method is \"pgh_baseline\""},
      {"[localiser]\ncommand = \"./mine\"\n", "s.toml:4: localiser.command has no effect"},
      {"[localiser]\nmin_corners = 9\n", "s.toml:4: localiser.min_corners has no effect"},
      {"[localiser]\ncorners = true\n", "s.toml:4: localiser.corners has no effect"},
      {"[localiser]\nmethod = \"pgh\"\nmax_error_rate = 0.1\n", "localiser.max_error_rate"},
      {"[histograms]\nmax_lines = 40\n",
       "s.toml:4: histograms.max_lines has no effect: localiser.ranker is \"view\""},
      {"[localiser]\nmethod = \"pgh_baseline\"\n[histograms]\nheight_bands = 2\n",
       "s.toml:6: histograms.height_bands"},
      {"[localiser]\nmethod = \"pgh\"\n[histograms]\nblur = \"per_entry\"\nangle_sigma_deg = 3\n",
       "s.toml:7: histograms.angle_sigma_deg has no effect: histograms.blur is \"per_entry\""},
      {"[corners]\nnoise = 0.4\n", "s.toml:4: corners.noise has no effect"},
      {"[map]\nrig = \"same\"\n[sources]\ncalibration = 0\n",
       "s.toml:4: map.rig has no effect: sources.calibration is 0"},
      {"[sources]\ntime_limit_s = 3\n", "s.toml:4: sources.time_limit_s has no effect"},
      {"[sweep]\n\"localiser.looks\" = [1, 2]\n\"localiser.method\" = [\"pgh\", \"corners\"]\n",
       "s.toml:4: localiser.looks has no effect"},
      {"[sweep]\n\"sources.corner_loss\" = [0, 0.5]\n",
       "s.toml:4: sources.corner_loss has no effect: localiser.method is \"lines\""},
      {"[sources]\nstereo_mismatch = 0\n[sweep]\n\"sources.stereo_mismatch_px\" = [5, 10]\n",
       "s.toml:6: sources.stereo_mismatch_px has no effect: sources.stereo_mismatch is 0"},
      {"[system]\nname = \"servoing\"\n[sweep]\n\"sources.corner_loss\" = [0, 0.5]\n",
       "s.toml:6: sources.corner_loss has no effect: a servoing robot sees no corners"},
      {"[one_at_a_time]\ndesigns = [\"only\"]\nsources = [\"corner_loss\"]\n",
       "s.toml:5: one_at_a_time varies sources.corner_loss, which has no effect"},
  };
  for (const auto& one : cases) {
    const Study study = test::office_study(six_trials + one.text);
    const std::string complaint = test::error_message([&] { check_settings_act(study); });
    EXPECT_NE(complaint.find(one.complaint), std::string::npos) << one.text << complaint;
  }
}

TEST(IdleSettings, WhatActsInOneCellPassesAndSoDoDefaults) {
  for (const char* text :
       {"", "[localiser]\nmethod = \"pgh\"\nlooks = 1\nmin_corners = 8\n[corners]\nnoise = 0.3\n",
        "[localiser]\nlooks = 2\n[sweep]\n\"localiser.method\" = [\"pgh\", \"lines\"]\n",
        "[localiser]\nranker = \"pgh\"\n[histograms]\nmax_lines = 40\n",
        "[localiser]\nmethod = \"corners\"\nmin_corners = 12\n[corners]\nnoise = 1\n",
        "[sources]\nstereo_mismatch = 0\nstereo_mismatch_px = 20\ncorner_loss = 0.15\n",
        "[sweep]\n\"sources.missed\" = [0, 0.1]\n\"sources.missed_alike\" = [0, 0.5]\n",
        "[map]\nrig = \"same\"\n[sweep]\n\"sources.calibration\" = [0, 1]\n",
        "[one_at_a_time]\ndesigns = [\"only\", \"all_but\", \"swept\"]\n"}) {
    EXPECT_TRUE(idle_sources(test::office_study(six_trials + text)).empty()) << text;
  }
}

// What the manual and the shipped studies say must pass.
TEST(IdleSettings, ShippedStudiesActInAllTheirSettings) {
  register_systems();
  const std::filesystem::path root(VERNIER_SOURCE_DIR);
  std::vector<std::filesystem::path> files{root / "scripts" / "corner_errors_study.toml"};
  for (const auto& entry : std::filesystem::directory_iterator(root / "datasets" / "studies")) {
    files.push_back(entry.path());
  }
  ASSERT_GE(files.size(), 7u);
  for (const auto& file : files) {
    Study study = test::office_study(six_trials);
    study.file = read_study(file);
    for (const std::string& world : worlds_of(study.file))
      study.other_worlds[world] = {study.world, ""};
    EXPECT_TRUE(check_settings_act(study).empty()) << file;
  }
}

TEST(IdleSettings, SourcesThatFindNothingToActOnAreTold) {
  using Keys = std::vector<std::string>;
  EXPECT_EQ(idle_sources(test::office_study(six_trials +
                                            "[sources]\ncorner_loss = 0.3\nmissed_alike = 0.5\n")),
            (Keys{"sources.corner_loss", "sources.missed_alike"}));
  EXPECT_EQ(idle_sources(test::office_study(
                six_trials + "[sources]\nedge_loss = 0.3\n[localiser]\nmethod = \"corners\"\n"
                             "[sweep]\n\"sources.corner_loss\" = [0, 0.5]\n")),
            Keys{"sources.edge_loss"});
  EXPECT_EQ(idle_sources(test::office_study(six_trials +
                                            "[sources]\nlateral_shift_px = 0\nlateral_shift_mode = "
                                            "\"independent\"\n")),
            Keys{"sources.lateral_shift_mode"});
  EXPECT_EQ(idle_sources(test::office_study(six_trials + "[sources]\ncorner_loss = 0\n")), Keys{});
}

TEST(IdleSettings, AWorldMayHaveNothingToMove) {
  Study study = test::office_study(six_trials + "[sources]\nmoved = 0.5\n");
  ASSERT_TRUE(has_furniture(study.world));
  EXPECT_TRUE(check_settings_act(study).empty());
  for (WorldObject& object : study.world.objects) {
    if (!object.template_name.empty()) object.template_name = "window";
  }
  ASSERT_FALSE(has_furniture(study.world));
  const std::vector<IdleSource> idle = check_settings_act(study);
  ASSERT_EQ(idle.size(), 1u);
  EXPECT_EQ(idle[0].reason, "the world workshop has no furniture");
  study.file = parse_study(
      six_trials + "[sources]\nmoved = 0.5\n[one_at_a_time]\ndesigns = [\"all_but\"]\n", "s.toml");
  EXPECT_EQ(check_settings_act(study).size(), 1u);  // chosen by the program, not named
  Study designed = test::office_study(
      six_trials +
      "[sources]\nmoved = 0.5\n[one_at_a_time]\ndesigns = [\"all_but\"]\nsources = [\"moved\"]\n");
  EXPECT_TRUE(check_settings_act(designed).empty());
  designed.world = study.world;
  EXPECT_EQ(test::error_message([&] {
              check_settings_act(designed);
            }).rfind("s.toml:7: one_at_a_time varies sources.moved", 0),
            0u);
}

// Each source is varied where it acts, so that the table has no comparison that must be a tie.
TEST(IdleSettings, DesignsTakeTheSourcesThatActOnTheMethod) {
  const auto varied = [](const std::string& method) {
    std::set<std::string> sources;
    for (const StudyCell& cell :
         test::office_study(six_trials + "[localiser]\nmethod = \"" + method +
                            "\"\n[one_at_a_time]\ndesigns = [\"all_but\"]\n")
             .file.cells) {
      if (!varied_source(cell).empty()) sources.insert(varied_source(cell));
    }
    return sources;
  };
  EXPECT_EQ(varied("lines"),
            (std::set<std::string>{"calibration", "edge_loss", "endpoint_sigma_px",
                                   "epipolar_reject_deg", "lateral_shift_px", "stereo_mismatch"}));
  EXPECT_EQ(varied("corners"), (std::set<std::string>{"calibration", "corner_loss",
                                                      "corner_mismatch", "corner_sigma_px"}));
}

}  // namespace
}  // namespace vernier
