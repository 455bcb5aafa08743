// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study_file.h"

#include <gtest/gtest.h>

#include "tests/support/error_message.h"

namespace vernier {
namespace {

std::string complaint_of(const std::string& text) {
  return test::error_message([&] { parse_study(text, "s.toml"); });
}

TEST(StudyFile, DefaultsAreTheMemos) {
  const StudyFile study = parse_study("[study]\n", "s.toml");
  ASSERT_EQ(study.cells.size(), 1u);
  EXPECT_EQ(study.trials, 900);
  const ExperimentSettings& e = study.cells[0].experiment;
  EXPECT_EQ(e.sources.lateral_shift_px, 3);
  EXPECT_EQ(e.sources.edge_loss, 0.1125);
  EXPECT_EQ(e.sources.endpoint_sigma_px, 0.15);
  EXPECT_EQ(e.sources.corner_loss, 0.15);
  EXPECT_EQ(e.sources.corner_mismatch, 0.01);
  EXPECT_EQ(e.sources.stereo_mismatch, 0.01);
  EXPECT_EQ(e.sources.calibration, 1);
  EXPECT_EQ(e.mount.height_m, 1.2);
  EXPECT_EQ(e.method, "pgh");
}

TEST(StudyFile, SweepsFormAGridTheFirstKeySlowest) {
  const StudyFile study = parse_study(
      "[study]\ntrials = 10\n[sweep]\n\"sources.edge_loss\" = [0, 0.2]\n"
      "\"study.protocol\" = [\"path\", \"near_path\"]\n",
      "s.toml");
  ASSERT_EQ(study.cells.size(), 4u);
  EXPECT_EQ(study.cells[1].label, "sources.edge_loss = 0, study.protocol = near_path");
  EXPECT_EQ(study.cells[2].experiment.sources.edge_loss, 0.2);
  EXPECT_EQ(study.cells[2].experiment.protocol, QueryProtocol::path);
  EXPECT_NE(study.cells[1].settings, study.cells[0].settings);
}

TEST(StudyFile, ComplaintsNameLineAndRemedy) {
  EXPECT_EQ(complaint_of("[study]\ntrails = 9\n"),
            "s.toml:2: unknown key 'trails' in [study]; did you mean 'trials'?");
  EXPECT_NE(complaint_of("[study\n").find("s.toml:1: not TOML"), std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sources]\nedge_loss = 2\n")
                .find("s.toml:3: sources.edge_loss = 2 is out of range"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sources]\nedge_loss = \"much\"\n").find("s.toml:3:"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\nprotocol = \"far\"\n").find("there is no such protocol"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[localiser]\nmethod = \"sift\"\n").find("no localiser"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\n\"sources.edge_los\" = [1]\n")
                .find("s.toml:3: unknown key 'edge_los' in [sources]"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\nsources.edge_loss = [1]\n").find("quoted"),
            std::string::npos);
  for (const std::string key : {"study.trials", "world.file", "rig.file", "robot.wheels"}) {
    EXPECT_NE(complaint_of("[study]\n[sweep]\n\"" + key + "\" = [1]\n")
                  .find("s.toml:3: '" + key + "' cannot be swept"),
              std::string::npos);
  }
  EXPECT_NE(complaint_of("[study]\n[sweep]\n\"study.trails\" = [1]\n").find("trials"),
            std::string::npos);
  EXPECT_NE(complaint_of("[world]\nfile = \"x\"\n").find("has no 'study'"), std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\n\"sources.edge_loss\" = [0.1,\n 3]\n")
                .find("s.toml:4: sources.edge_loss = 3 is out of range"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\ntrials = 4294967298\n").find("trials = 4294967298 is out"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\ntrials = 0\n").find("study.trials = 0"), std::string::npos);
}

}  // namespace
}  // namespace vernier
