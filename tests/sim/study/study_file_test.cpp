// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"
#include "sim/study/reconstruct.h"
#include "sim/study/study.h"
#include "sim/study/study_keys.h"
#include "sim/uncertainty_source.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

std::string complaint_of(const std::string& text) {
  return test::error_message([&] { parse_study(text, "s.toml"); });
}

TEST(StudyFile, ShippedStudiesAreRead) {
  const std::filesystem::path folder =
      std::filesystem::path(VERNIER_SOURCE_DIR) / "datasets" / "studies";
  const std::map<std::string, std::size_t> cells{{"board_views.toml", 4},  {"campaign.toml", 77},
                                                 {"each_source.toml", 31}, {"stages.toml", 5},
                                                 {"tuning.toml", 24},      {"versions.toml", 4}};
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const StudyFile study = read_study(entry.path());
    EXPECT_EQ(study.cells.size(), cells.at(entry.path().filename().string())) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, cells.size());
  const StudyFile campaign = read_study(folder / "campaign.toml");
  constexpr int of_the_memo = 74'110;
  EXPECT_GE(campaign.trials * static_cast<int>(campaign.cells.size()), of_the_memo);
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
  EXPECT_EQ(e.method, "lines");
}

TEST(StudyFile, FewTrialsStillRecordSixMaps) {
  EXPECT_EQ(parse_study("[study]\ntrials = 20\n", "s.toml").trials_per_block, 3);
  EXPECT_EQ(parse_study("[study]\n", "s.toml").trials_per_block, 50);
  for (int trials = 6; trials < 1000; ++trials) {
    const int size = block_size(trials);
    EXPECT_GE((trials + size - 1) / size, 6) << trials;
    EXPECT_EQ(size == 50, trials >= 300) << trials;
  }
  EXPECT_EQ(block_size(1), 1);
}

TEST(StudyFile, TheEstimatorIsToldTheEndpointErrorOnlyWhereAskedFor) {
  const StudyFile study = parse_study(
      "[study]\n[sources]\nendpoint_sigma_px = 0.5\n[sweep]\n"
      "\"localiser.knows_endpoint_sigma\" = [false, true]\n",
      "s.toml");
  ASSERT_EQ(study.cells.size(), 2u);
  EXPECT_EQ(study.cells[1].label, "localiser.knows_endpoint_sigma = true");
  EXPECT_EQ(told_endpoint_sigma_px(study.cells[0].experiment), 0.15);
  EXPECT_EQ(told_endpoint_sigma_px(study.cells[1].experiment), 0.5);
  EXPECT_NE(study.cells[0].settings, study.cells[1].settings);
  EXPECT_EQ(told_endpoint_sigma_px(ExperimentSettings()), 0.15);
  EXPECT_NE(complaint_of("[study]\n[localiser]\nknows_endpoint_sigma = 1\n")
                .find("s.toml:3: localiser.knows_endpoint_sigma is not a boolean"),
            std::string::npos);
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

TEST(StudyFile, LocaliserOptionsBelongToTheCell) {
  const auto cell = [](const std::string& localiser) {
    return parse_study("[study]\ntrials = 10\n[localiser]\n" + localiser, "s.toml").cells.at(0);
  };
  const auto lines = cell(
      "method = \"lines\"\nranker = \"pgh\"\ncandidates = 7\nmax_error_rate = 0.05\noff_map = "
      "0.1\nrepeats = 0.2\nlooks = 3\nlook_error_rate = 0.01\n");
  EXPECT_EQ(lines.experiment.localiser.ranker, "pgh");
  EXPECT_EQ(lines.experiment.localiser.candidates, 7);
  EXPECT_EQ(lines.experiment.localiser.max_error_rate, 0.05);
  EXPECT_EQ(lines.experiment.looks, 3);
  EXPECT_EQ(lines.settings.at("localiser.max_error_rate"), "0.05");
  EXPECT_EQ(lines.experiment.localiser.off_map, 0.1);
  EXPECT_EQ(lines.experiment.localiser.repeats, 0.2);
  EXPECT_EQ(lines.settings.at("localiser.repeats"), "0.2");
  EXPECT_EQ(lines.settings.at("localiser.off_map"), "0.1");
  EXPECT_EQ(lines.settings.at("localiser.looks"), "3");
  EXPECT_EQ(lines.experiment.localiser.look_error_rate, 0.01);
  EXPECT_EQ(lines.settings.at("localiser.look_error_rate"), "0.01");
  EXPECT_EQ(cell("method = \"pgh\"\ncandidates = 4\n").settings.at("localiser.candidates"), "4");
  const auto staged = cell("stages = \"compare+align\"\n");
  EXPECT_TRUE(staged.experiment.localiser.stages.align);
  EXPECT_FALSE(staged.experiment.localiser.stages.refine);
  EXPECT_TRUE(staged.experiment.localiser.stages.compare);
  EXPECT_FALSE(staged.experiment.localiser.stages.deepen);
  EXPECT_EQ(staged.settings.at("localiser.stages"), "align+compare");
  EXPECT_EQ(cell("stages = \"none\"\n").settings.at("localiser.stages"), "none");
  EXPECT_EQ(cell("").settings.count("localiser.stages"), 0u);
  // Keys of older stores hold none of these.
  EXPECT_EQ(cell("method = \"pgh\"\n").settings.count("localiser.candidates"), 0u);
  EXPECT_EQ(cell("method = \"pgh\"\n").settings.count("localiser.looks"), 0u);
  EXPECT_EQ(cell("").settings.count("localiser.look_error_rate"), 0u);
  for (const char* wrong : {"ranker = \"sift\"\n", "candidates = 0\n", "max_error_rate = 0\n",
                            "max_error_rate = 1.5\n", "off_map = 1\n", "repeats = 1\n",
                            "looks = 13\n", "method = \"sift\"\n", "stages = \"align+think\"\n",
                            "stages = \"align+align\"\n", "stages = \"\"\n", "stages = 3\n"}) {
    EXPECT_THROW(cell(wrong), Error) << wrong;
  }
}

TEST(StudyFile, HistogramsAreThoseOfTheCellsMethod) {
  const auto cells = [](const std::string& rest) {
    return parse_study("[study]\ntrials = 10\n" + rest, "s.toml").cells;
  };
  const auto both = cells(
      "[histograms]\nangle_sigma_deg = 10\nmax_distance = 3\n[sweep]\n"
      "\"localiser.method\" = [\"pgh\", \"pgh_baseline\"]\n"
      "\"histograms.type\" = [\"mirror\", \"directed\"]\n");
  ASSERT_EQ(both.size(), 4u);
  const LocaliserOptions usual;
  const LocaliserOptions& in_space = both[1].experiment.localiser;
  const LocaliserOptions& in_image = both[3].experiment.localiser;
  EXPECT_EQ(in_space.histograms.type, PghType::directed);
  EXPECT_NEAR(in_space.histograms.angle_sigma_rad, 0.17453293, 1e-8);
  EXPECT_EQ(in_space.histograms.max_distance, 3);
  EXPECT_EQ(in_space.image_histograms.max_distance, usual.image_histograms.max_distance);
  EXPECT_EQ(in_image.image_histograms.type, PghType::directed);
  EXPECT_EQ(in_image.image_histograms.max_distance, 3);
  EXPECT_EQ(in_image.histograms.max_distance, usual.histograms.max_distance);
  EXPECT_EQ(both[1].settings.at("histograms.type"), "directed");
  EXPECT_EQ(both[0].settings.count("histograms.type"), 0u);  // keys of older stores hold none
  for (const char* wrong :
       {"type = \"mirro\"\n", "type = 1\n", "blur = \"none\"\n", "angle_bins = 0\n",
        "angle_bins = 2.5\n", "distance_bins = 1001\n", "height_bands = 21\n", "max_lines = 1\n",
        "max_distance = 0\n", "max_distance = inf\n", "angle_sigma_deg = nan\n",
        "distance_sigma = 0\n", "angle_bins = 100\ndistance_bins = 100\nheight_bands = 2\n",
        "bins = 3\n"}) {
    EXPECT_THROW(cells(std::string("[histograms]\n") + wrong), Error) << wrong;
  }
}

TEST(StudyFile, CornersArePartOfACellThatLooksForThem) {
  const auto cells = [](const std::string& rest) {
    return parse_study("[study]\ntrials = 10\n" + rest, "s.toml").cells;
  };
  const auto of_corners = cells(
      "[corners]\nview_change = 2\n[localiser]\nmethod = \"corners\"\nmin_corners = 12\n[sweep]\n"
      "\"corners.noise\" = [0, 0.5]\n");
  ASSERT_EQ(of_corners.size(), 2u);
  EXPECT_EQ(of_corners[1].experiment.appearance.view_change, 2);
  EXPECT_EQ(of_corners[1].experiment.appearance.noise, 0.5);
  EXPECT_EQ(of_corners[1].settings.at("corners.noise"), "0.5");
  EXPECT_EQ(of_corners[1].settings.at("localiser.min_corners"), "12");
  // Keys of older stores hold none of these.
  const auto usual = cells("[corners]\nnoise = 1\n").at(0);
  EXPECT_EQ(usual.settings.count("corners.noise"), 0u);
  EXPECT_EQ(usual.settings.count("localiser.corners"), 0u);
  EXPECT_EQ(cells("[localiser]\ncorners = true\n").at(0).settings.at("localiser.corners"), "true");
  for (const char* wrong : {"[corners]\nnoise = -1\n", "[corners]\nsize = 3\n",
                            "[localiser]\nmin_corners = 3\n", "[localiser]\ncorners = 1\n"}) {
    EXPECT_THROW(cells(wrong), Error) << wrong;
  }
}

TEST(StudyFile, AProgramIsPartOfTheCell) {
  const StudyFile study = parse_study(
      "[study]\ntrials = 10\n[localiser]\ncommand = \"./mine --fast\"\ntime_limit_s = 2\n"
      "[sweep]\n\"localiser.method\" = [\"lines\", \"program\"]\n",
      "s.toml");
  ASSERT_EQ(study.cells.size(), 2u);
  EXPECT_EQ(study.cells[0].settings.count("localiser.command"), 0u);
  EXPECT_EQ(study.cells[1].experiment.localiser.command, "./mine --fast");
  EXPECT_EQ(study.cells[1].experiment.localiser.time_limit_s, 2);
  EXPECT_EQ(study.cells[1].settings.at("localiser.command"), "./mine --fast");
  const std::string program = "[study]\n[localiser]\nmethod = \"program\"\n";
  EXPECT_NE(complaint_of(program).find("command"), std::string::npos);
  EXPECT_NE(
      complaint_of(program + "command = \" \"\n").find("s.toml:4: localiser.command is empty"),
      std::string::npos);
  EXPECT_NE(complaint_of(program + "command = \"a 'b\"\n").find("unclosed quote"),
            std::string::npos);
  EXPECT_NE(complaint_of(program + "command = \"a\"\ntime_limit_s = 0\n").find("out of range"),
            std::string::npos);
}

TEST(StudyFile, ComplaintsNameLineAndRemedy) {
  EXPECT_EQ(complaint_of("[study]\ntrails = 9\n"),
            "s.toml:2: unknown key 'trails' in [study]; did you mean 'trials'?");
  EXPECT_EQ(complaint_of("[study]\n[world]\nzoom = 1\n"),
            "s.toml:3: unknown key 'zoom' in [world]; use 'file' or 'visibility'");
  EXPECT_EQ(parse_study("[study]\n[world]\nvisibility = \"exact\"\n", "s.toml").world, "workshop");
  EXPECT_NE(complaint_of("[study\n").find("s.toml:1: not TOML"), std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sources]\nedge_loss = 2\n")
                .find("s.toml:3: sources.edge_loss = 2 is out of range"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sources]\nedge_loss = \"much\"\n").find("s.toml:3:"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\nprotocol = \"far\"\n").find("unknown protocol"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[localiser]\nmethod = \"sift\"\n").find("unknown localiser"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\n\"sources.edge_los\" = [1]\n")
                .find("s.toml:3: unknown key 'edge_los' in [sources]"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\nsources.edge_loss = [1]\n").find("quoted"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\n").find("s.toml:2: [sweep] sweeps nothing"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\n\"sources.edge_loss\" = []\n")
                .find("s.toml:3: the sweep of sources.edge_loss is empty"),
            std::string::npos);
  for (const std::string key : {"study.trials", "sources.file", "rig.truth", "robot.wheels"}) {
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

/// All keys measured, each with a value of its own.
MeasuredSources all_measured() {
  const auto measured = [](double value) {
    return MeasuredValue{value, {0.9 * value, 1.1 * value}, 500};
  };
  MeasuredSources sources;
  sources.pairs = {"a \"pair\"", "b\n[study]"};
  sources.edge_loss.share = measured(0.2);
  sources.lateral_shift.independent_px = measured(0.05);
  sources.endpoints.across_px = measured(0.12);
  sources.corners.loss = measured(0.17);
  sources.corners.mismatch = measured(0.02);
  sources.corners.reach_px = measured(7);
  sources.stereo_mismatch.share = measured(0.03);
  sources.stereo_mismatch.reach_px = measured(30);
  return sources;
}

TEST(StudyFile, ReadsMeasuredSources) {
  const test::Folder folder;
  write_atomically(folder.path() / "measured.toml", sources_toml(all_measured()));
  const std::filesystem::path file = folder.path() / "study.toml";
  write_atomically(file,
                   "[study]\n[sources]\nfile = \"measured.toml\"\ncorner_loss = 0.5\n"
                   "[sweep]\n\"sources.edge_loss\" = [0, 0.1]\n");
  const StudyFile study = read_study(file);
  EXPECT_EQ(study.sources, folder.path() / "measured.toml");
  ASSERT_EQ(study.cells.size(), 2u);
  const SourceSettings& s = study.cells[1].experiment.sources;
  EXPECT_EQ(s.edge_loss, 0.1);    // swept
  EXPECT_EQ(s.corner_loss, 0.5);  // the study's own
  EXPECT_EQ(s.endpoint_sigma_px, 0.12);
  EXPECT_EQ(s.corner_mismatch, 0.02);
  EXPECT_EQ(s.corner_mismatch_px, 7);
  EXPECT_EQ(s.stereo_mismatch, 0.03);
  EXPECT_EQ(s.stereo_mismatch_px, 30);
  EXPECT_EQ(s.lateral_shift_px, 3);  // not to be measured
  EXPECT_EQ(s.lateral_shift_mode, ShiftMode::common);
  EXPECT_EQ(s.epipolar_reject_deg, 5);
  EXPECT_EQ(s.calibration, 1);
}

TEST(StudyFile, ReadsWhatTheEyesDifferByWhereAskedFor) {
  const test::Folder folder;
  const std::filesystem::path file = folder.path() / "measured.toml";
  write_atomically(file, sources_toml(all_measured(), ShiftMode::independent));
  const StudyFile study =
      parse_study("[study]\n[sources]\nfile = \"elsewhere.toml\"\n", "s.toml", file);
  EXPECT_EQ(study.cells[0].experiment.sources.lateral_shift_px, 0.05);
  EXPECT_EQ(study.cells[0].experiment.sources.lateral_shift_mode, ShiftMode::independent);
  EXPECT_EQ(study.cells[0].experiment.sources.edge_loss, 0.2);
}

TEST(StudyFile, LeavesDefaultsWhereNothingWasMeasured) {
  const std::string text = "[study]\n" + sources_toml(MeasuredSources{});  // copied into a study
  const StudyFile study = parse_study(text, "s.toml");
  for (const SourceParameter& parameter : source_parameters()) {
    EXPECT_EQ(study.cells[0].experiment.sources.*parameter.value, SourceSettings().*parameter.value)
        << parameter.name;
  }
}

std::string key_of(const std::string& sources) {
  Study study;
  study.file = parse_study("[study]\n[sources]\n" + sources, "s.toml");
  return cell_key(study, study.file.cells[0]);
}

/// Stores that are older than a source stay valid as long as it is off.
TEST(StudyFile, NewerSourcesAreInTheKeyOnlyWhereTheyAct) {
  const std::string usual = key_of("");
  for (const SourceParameter& parameter : source_parameters()) {
    const std::string name(parameter.name);
    EXPECT_EQ(usual.find("sources." + name + "\"") == std::string::npos, parameter.is_newer)
        << name;
    if (!parameter.is_newer) continue;
    const double usual_value = SourceSettings().*parameter.value;
    EXPECT_TRUE(usual_value == 0 || !parameter.is_switch) << name;
    EXPECT_EQ(key_of(fmt::format("{} = {}\n", name, usual_value)), usual) << name;
    EXPECT_NE(key_of(name + " = 0.5\n"), usual) << name;
    EXPECT_NE(
        complaint_of("[study]\n[sources]\n" + name + " = -1\n").find("is out of range; use 0"),
        std::string::npos);
  }
}

TEST(StudyFile, ReadsSourcesOfOnesOwn) {
  class Nothing : public UncertaintySource {
    std::string_view name() const override { return "nothing"; }
    void apply(const SensingContext&, SensedView&) const override {}
  };
  for (const char* name : {"dust", "rain"}) {
    register_source(name, [](const SourceOptions&) { return std::make_unique<Nothing>(); });
  }
  const StudyFile study = parse_study(
      "[study]\n[sources]\nown = [\"rain\", \"dust\"]\n[sources.rain]\nshare = 0.5\n"
      "[sweep]\n\"sources.dust.size_px\" = [0, 3]\n",
      "s.toml");
  ASSERT_EQ(study.cells.size(), 2u);
  const std::vector<OwnSource>& own = study.cells[1].experiment.sources.own;
  ASSERT_EQ(own.size(), 2u);
  EXPECT_EQ(own[0].name, "rain");
  EXPECT_EQ(own[0].options.at("share"), 0.5);
  EXPECT_EQ(own[1].options.at("size_px"), 3);
  EXPECT_EQ(study.cells[1].settings.at("sources.own"), "rain, dust");
  EXPECT_EQ(study.cells[1].settings.at("sources.dust.size_px"), "3");
  EXPECT_NE(key_of("own = [\"rain\"]\n"), key_of("own = [\"dust\"]\n"));

  const auto complaint = [](const std::string& sources) {
    return complaint_of("[study]\n[sources]\n" + sources);
  };
  EXPECT_NE(complaint("own = [\"snow\"]\n").find("s.toml:3: unknown source"), std::string::npos);
  EXPECT_NE(complaint("own = [\"rain\", \"rain\"]\n").find("twice"), std::string::npos);
  EXPECT_NE(complaint("own = \"rain\"\n").find("s.toml:3"), std::string::npos);
  EXPECT_NE(complaint("[sources.rain]\nshare = 1\n").find("unknown key 'rain'"), std::string::npos);
  EXPECT_NE(complaint("own = [\"rain\"]\n[sources.rain]\nshare = \"x\"\n").find("s.toml:5"),
            std::string::npos);
}

TEST(StudyFile, ReadsASourceThatIsAProgram) {
  const StudyFile study =
      parse_study("[study]\n[sources]\ncommand = \"mine --hard\"\ntime_limit_s = 3\n", "s.toml");
  EXPECT_EQ(study.cells[0].experiment.sources.command, "mine --hard");
  EXPECT_EQ(study.cells[0].experiment.sources.time_limit_s, 3);
  EXPECT_EQ(study.cells[0].settings.at("sources.command"), "mine --hard");
  EXPECT_NE(key_of("command = \"a\"\n"), key_of("command = \"b\"\n"));
  const auto complaint = [](const std::string& sources) {
    return complaint_of("[study]\n[sources]\n" + sources);
  };
  EXPECT_NE(complaint("command = \"\"\n").find("s.toml:3: sources.command is empty"),
            std::string::npos);
  EXPECT_NE(complaint("command = \"'x\"\n").find("unclosed quote"), std::string::npos);
  EXPECT_NE(complaint("time_limit_s = 0\n").find("out of range"), std::string::npos);
}

TEST(StudyFile, ComplaintsAboutAFileOfSourcesNameIt) {
  const test::Folder folder;
  const std::filesystem::path file = folder.path() / "measured.toml";
  const auto error_output = [&](const std::string& content) {
    write_atomically(file, content);
    return test::error_message(
        [&] { parse_study("[study]\n[sources]\nfile = \"x\"\n", "s.toml", file); });
  };
  EXPECT_NE(
      error_output("[sources]\nedge_los = 1\n").find("measured.toml:2: unknown key 'edge_los'"),
      std::string::npos);
  EXPECT_NE(
      error_output("[sources]\nedge_loss = 7\n").find("measured.toml:2: sources.edge_loss = 7"),
      std::string::npos);
  EXPECT_NE(error_output("[study]\n").find("unknown key 'study'"), std::string::npos);
  EXPECT_NE(error_output("").find("has no 'sources'"), std::string::npos);
  EXPECT_NE(error_output("[sources]\nfile = \"y\"\n").find("in a sources file"), std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sources]\nfile = \"nowhere.toml\"\n")
                .find("s.toml:3: sources.file: no such file"),
            std::string::npos);
  EXPECT_NE(complaint_of("[study]\n[sweep]\n\"sources.file\" = [\"a\"]\n").find("cannot be swept"),
            std::string::npos);
}

TEST(StudyFile, AnErrorOfAWordKeepsItsParts) {
  const auto parts =
      test::error_parts([] { parse_study("[study]\nprotocol = \"far\"\n", "s.toml"); });
  EXPECT_EQ(parts[0], "s.toml:2");
  EXPECT_NE(parts[1].find("far"), std::string::npos);
  EXPECT_NE(parts[2], "");
  EXPECT_EQ(complaint_of("[study]\nprotocol = 3\n").find("s.toml:2"),
            complaint_of("[study]\nprotocol = 3\n").rfind("s.toml:2"));  // said once
}

}  // namespace
}  // namespace vernier
