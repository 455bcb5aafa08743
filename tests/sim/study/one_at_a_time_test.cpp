// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/one_at_a_time.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "calib/error.h"
#include "sim/sources.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_tally.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_work.h"
#include "tests/support/error_message.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace sim;
using namespace vernier::sim::internal;

namespace {

std::vector<StudyCell> cells(const std::string& text) {
  return parse_study("[study]\ntrials = 6\n" + text, "s.toml").cells;
}

std::string value(const StudyCell& cell, const std::string& key) {
  for (const auto& [swept, v] : cell.swept) {
    if (swept == key) return v;
  }
  return "none";
}

/// Sources that are on.
std::set<std::string> on(const StudyCell& cell) {
  std::set<std::string> names;
  for (const SourceParameter& p : source_parameters()) {
    if (p.is_switch && cell.experiment.sources.*p.value != 0) names.insert(std::string(p.name));
  }
  return names;
}

TEST(OneAtATime, SwitchesSourcesOneByOne) {
  const StudyCell as_set = cells("")[0];
  const std::set<std::string> all = on(as_set);
  ASSERT_GT(all.size(), 3u);
  const std::vector<StudyCell> designed =
      cells("[one_at_a_time]\ndesigns = [\"only\", \"all_but\"]\n");
  const std::string rejection = "epipolar_reject_deg";
  ASSERT_EQ(all.count(rejection), 1u);
  const std::size_t acting = all.size() - 3;  // but for those of corners
  const std::size_t only = acting - 1;        // but for the rejection, which stays on
  ASSERT_EQ(designed.size(), 2 + only + acting);
  EXPECT_EQ(on(designed[0]), all);
  EXPECT_EQ(designed[0].settings, as_set.settings);
  EXPECT_EQ(on(designed[1]), std::set{rejection});
  for (std::size_t i = 2; i < designed.size(); ++i) {
    const std::string source = value(designed[i], "source");
    std::set<std::string> expected{source, rejection};
    if (i >= 2 + only) {
      expected = all;
      expected.erase(source);
    }
    EXPECT_EQ(on(designed[i]), expected) << designed[i].label;
    // No setting but the sources differs, and those in effect are the settings' own.
    for (const auto& [key, text] : designed[i].settings) {
      if (!key.starts_with("sources.")) {
        EXPECT_EQ(text, as_set.settings.at(key)) << key;
      }
    }
    EXPECT_EQ(designed[i].settings.at("sources." + source),
              i < 2 + only ? as_set.settings.at("sources." + source) : "0");
  }
}

TEST(OneAtATime, SweepsByFactorsBesideAllOthers) {
  const std::vector<StudyCell> designed = cells(
      "[sources]\nedge_loss = 0.2\n[one_at_a_time]\ndesigns = [\"swept\"]\n"
      "sources = [\"edge_loss\"]\nfactors = [0.5, 3]\n");
  ASSERT_EQ(designed.size(), 3u);
  EXPECT_EQ(designed[0].experiment.sources.edge_loss, 0.2);
  EXPECT_EQ(designed[1].experiment.sources.edge_loss, 0.1);
  EXPECT_NEAR(designed[2].experiment.sources.edge_loss, 0.6, 1e-12);
  EXPECT_EQ(on(designed[0]), on(designed[2]));
  EXPECT_EQ(designed[1].label, "swept edge_loss = 0.1");
}

TEST(OneAtATime, StandsInEveryCellOfASweepAndIsComparedWithinIt) {
  const std::vector<StudyCell> designed = cells(
      "[sweep]\n\"localiser.method\" = [\"lines\", \"pgh\"]\n"
      "[one_at_a_time]\ndesigns = [\"only\", \"swept\"]\nsources = [\"edge_loss\"]\nfactors = "
      "[2]\n");
  ASSERT_EQ(designed.size(), 8u);  // as set, no source, only, swept; for each method
  std::vector<CellResult> results;
  for (const StudyCell& cell : designed) {
    results.emplace_back();
    results.back().cell = cell;
    CellTally(results.back()).add(std::vector<TrialResult>(1));
  }
  const std::vector<std::pair<std::size_t, std::size_t>> expected{{1, 2}, {0, 3}, {5, 6}, {4, 7}};
  std::vector<std::pair<std::size_t, std::size_t>> designs;
  for (const auto& pair : comparable_pairs(results)) designs.push_back(pair);
  EXPECT_EQ(designs, expected);
}

// Half of 2 is 1 and twice 1 is 2: two cells of six differ from others by name only.
TEST(OneAtATime, CellsThatDoNotDifferAreComputedOnce) {
  const Study study = test::office_study(
      "[study]\ntrials = 6\nprotocol = \"near_path\"\n[map]\nspacing_m = 2\n[sweep]\n"
      "\"sources.calibration\" = [1, 2]\n[one_at_a_time]\ndesigns = [\"swept\"]\n"
      "sources = [\"calibration\"]\nfactors = [0.5, 2]\n");
  const StudyWork work = study_work(study);
  EXPECT_EQ(work.same_as, (std::vector<int>{0, 1, 2, 2, 0, 5}));  // 1, 0.5, 2; 2, 1, 4
  EXPECT_EQ(work.blocks.size(), 4u * 6);
  const auto folder =
      std::filesystem::temp_directory_path() / ("vernier_same_" + std::to_string(getpid()));
  int total = 0, done = 0;
  StudyRun run{.folder = folder, .threads = 2, .shard = {}, .command = ""};
  run.progress = [&](int now, int of) {
    done = now;
    total = of;
  };
  run_study(study, run);
  EXPECT_EQ(total, 4 * 6);
  EXPECT_EQ(done, total);
  const StudyResults results = study_results(study, folder);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(results.blocks_total, 4 * 6);
  EXPECT_EQ(results.blocks_done, 4 * 6);
  ASSERT_EQ(results.cells.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto same = static_cast<std::size_t>(work.same_as[i]);
    ASSERT_EQ(results.cells[i].trials.size(), 6u);
    EXPECT_EQ(results.cells[i].maps.size(), 6u);
    EXPECT_EQ(trials_text(results.cells[i].trials), trials_text(results.cells[same].trials));
  }
}

TEST(OneAtATime, RefusesWhatItCannotMake) {
  const auto fault = [](const std::string& table) {
    return test::error_message([&] { cells("[one_at_a_time]\n" + table); });
  };
  EXPECT_NE(fault("designs = [\"each\"]\n").find("s.toml:4"), std::string::npos);
  EXPECT_NE(fault("designs = [\"each\"]\n").find("\"each\" is unknown"), std::string::npos);
  EXPECT_NE(fault("designs = []\n").find("is empty"), std::string::npos);
  EXPECT_NE(fault("sources = [\"edge_loss\"]\n").find("designs"), std::string::npos);
  EXPECT_NE(fault("designs = [\"only\"]\nsources = [\"edge_los\"]\n").find("'edge_loss'"),
            std::string::npos);
  EXPECT_NE(fault("designs = [\"only\"]\nsources = [\"clutter\"]\n").find("it is off everywhere"),
            std::string::npos);
  const std::string named = "sources = [\"edge_loss\", \"epipolar_reject_deg\"]\n";
  EXPECT_NE(fault("designs = [\"only\"]\n" + named).find("keeps it as it is set in all cells"),
            std::string::npos);
  EXPECT_EQ(cells("[one_at_a_time]\ndesigns = [\"only\", \"all_but\"]\n" + named).size(), 5u);
  EXPECT_NE(fault("designs = [\"swept\"]\nfactors = [1]\n").find("is no factor"),
            std::string::npos);
  EXPECT_NE(fault("designs = [\"swept\"]\nsources = [\"edge_loss\"]\nfactors = [50]\n")
                .find("s.toml:6: one_at_a_time.factors: 50 times sources.edge_loss"),
            std::string::npos);
  EXPECT_NE(fault("designs = [\"swept\"]\nfactors = [2, 3, 2]\n").find("factors lists 2 twice"),
            std::string::npos);
  EXPECT_NE(fault("designs = [\"only\"]\nsources = []\n").find("s.toml:5: one_at_a_time.sources"),
            std::string::npos);
  EXPECT_NE(fault("designs = [\"only\"]\nfactor = [2]\n").find("factor"), std::string::npos);
}

}  // namespace
}  // namespace vernier
