// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// system.success_error: what counts as a success is asked of what is stored.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_summary.h"
#include "sim/study/reliability.h"
#include "sim/study/study.h"
#include "sim/study/study_difference.h"
#include "sim/systems/systems.h"
#include "tests/sim/study/stored_example.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

Study limited_study(const std::string& text) {
  register_systems();
  return test::office_study(text);
}

/// How many blocks a run in the folder has left to compute; -1 if it does not say.
int blocks_computed(const Study& study, const std::filesystem::path& folder) {
  int asked = -1;
  StudyRun run{folder, 2, {}, {}, {}};
  run.progress = [&](int, int total) { asked = total; };
  run_study(study, run);
  return asked;
}

const std::string of_calibrations =
    "[study]\ntrials = 36\nseed = 3\n[system]\nname = \"calibration\"\nrange_m = 4\n"
    "success_error = 0.05\n[calibration]\npixel_sigma_px = 0.3\n[sweep]\n"
    "\"calibration.views\" = [4, 8]\n";

/// What counts as a success is asked of stored trials: no trial is made for it.
TEST(SuccessLimits, AnotherLimitNeedsNoNewTrials) {
  const auto with_limit = [](const std::string& study, const std::string& limit) {
    std::string text = study;
    const std::string usual = "success_error = 0.05";
    return limited_study(text.replace(text.find(usual), usual.size(), "success_error = " + limit));
  };
  const test::TestFolder folder("systems");
  const Study loose = with_limit(of_calibrations, "0.05");
  run_study(loose, {folder / "a", 2, {}, {}, {}});
  const StudyResults before = study_results(loose, folder / "a");
  for (const std::string limit : {"0.01", "0.02"}) {
    const Study strict = with_limit(of_calibrations, limit);
    EXPECT_EQ(study_difference(loose, strict), "");
    EXPECT_EQ(blocks_computed(strict, folder / "a"), 0);
    const StudyResults after = study_results(strict, folder / "a");
    for (std::size_t c = 0; c < after.cells.size(); ++c) {
      const std::vector<TrialResult>& trials = before.cells[c].trials;
      ASSERT_EQ(after.cells[c].trials.size(), trials.size());
      const auto within = std::count_if(trials.begin(), trials.end(), [&](const TrialResult& t) {
        return t.answered() && t.error <= std::stod(limit);
      });
      EXPECT_DOUBLE_EQ(after.cells[c].summary.success, static_cast<double>(within) / 36);
      EXPECT_LT(after.cells[c].summary.success, before.cells[c].summary.success);
    }
  }
}

/// Of a localiser too, whose trials, stated probabilities and world's ceiling are the same.
TEST(SuccessLimits, ALocalisersLimitNeedsNoNewTrials) {
  const auto within = [](const std::string& limit) {
    return limited_study(
        "[study]\ntrials = 60\nseed = 4\n[system]\nname = \"localiser\"\nsuccess_error = " + limit +
        "\n[map]\nspacing_m = 1\n[sources]\ncalibration = 3\n");
  };
  const test::TestFolder folder("systems");
  const Study usual = limited_study(
      "[study]\ntrials = 60\nseed = 4\n[map]\nspacing_m = 1\n[sources]\n"
      "calibration = 3\n");
  run_study(usual, {folder / "a", 2, {}, {}, {}});
  const CellResult before = study_results(usual, folder / "a").cells[0];
  for (const std::string limit : {"1", "0.1", "0.03"}) {
    const Study strict = within(limit);
    EXPECT_EQ(study_difference(usual, strict), "");
    EXPECT_EQ(blocks_computed(strict, folder / "a"), 0);
    const CellResult after = study_results(strict, folder / "a").cells[0];
    const auto right = std::count_if(
        before.trials.begin(), before.trials.end(),
        [&](const TrialResult& t) { return t.answered() && t.error <= std::stod(limit); });
    EXPECT_DOUBLE_EQ(after.summary.success, static_cast<double>(right) / 60);
    EXPECT_EQ(after.ceiling->success, before.ceiling->success);
    ASSERT_EQ(after.stated.reliability().size(), before.stated.reliability().size());
    for (std::size_t i = 0; i < before.stated.reliability().size(); ++i) {
      EXPECT_EQ(after.stated.reliability()[i].wrong, before.stated.reliability()[i].wrong);
    }
  }
  EXPECT_LT(study_results(within("0.03"), folder / "a").cells[0].summary.success,
            before.summary.success);
}

/// A budget by width goes by the cell's own limit.
TEST(SuccessLimits, ALocalisersBudgetIsByItsLimit) {
  const std::string text =
      "[study]\ntrials = 600\nseed = 4\ninterval_width = 0.4\n[map]\nspacing_m = 1\n[sources]\n"
      "calibration = 3\n";
  const std::string name = "[system]\nname = \"localiser\"\n";
  const Study swept =
      limited_study(text + name + "[sweep]\n\"system.success_error\" = [1, 0.04]\n");
  const test::TestFolder folder("systems");
  run_study(swept, {folder / "a", 2, {}, {}, {}});
  const StudyResults both = study_results(swept, folder / "a");
  ASSERT_EQ(both.cells.size(), 2U);
  EXPECT_LT(both.cells[0].summary.trials, both.cells[1].summary.trials);
  const Study alone = limited_study(text + name + "success_error = 0.04\n");
  run_study(alone, {folder / "b", 2, {}, {}, {}});
  const CellSummary& by_itself = study_results(alone, folder / "b").cells[0].summary;
  EXPECT_EQ(both.cells[1].summary.trials, by_itself.trials);
  EXPECT_EQ(both.cells[1].summary.success, by_itself.success);
  // Another limit is another question: nothing is compared.
  EXPECT_TRUE(compare_all(both.cells).empty());
}

/// Cells that differ in it share their trials, and each goes as far as its own interval needs.
TEST(SuccessLimits, SweptOnesShareTrialsAndHaveTheirOwnBudgets) {
  const std::string start =
                        "[study]\ntrials = 900\nseed = 3\ninterval_width = 0.3\n"
                        "[system]\nname = \"calibration\"\nrange_m = 4\n",
                    end = "[calibration]\nviews = 4\npixel_sigma_px = 0.3\n";
  const auto limited = [&](const std::string& limit) {
    return limited_study(start + "success_error = " + limit + "\n" + end);
  };
  const Study swept =
      limited_study(start + end + "[sweep]\n\"system.success_error\" = [1, 0.03]\n");
  const test::TestFolder folder("systems");
  run_study(swept, {folder / "a", 2, {}, {}, {}});
  const StudyResults both = study_results(swept, folder / "a");
  ASSERT_EQ(both.cells.size(), 2U);
  EXPECT_LT(both.cells[0].summary.trials, both.cells[1].summary.trials);  // one hardly scatters
  EXPECT_EQ(both.blocks_done, both.cells[1].summary.trials / swept.file.trials_per_block);
  EXPECT_EQ(both.blocks_total, both.blocks_done);
  int place = 0;
  for (const std::string limit : {"1", "0.03"}) {
    const Study alone = limited(limit);
    run_study(alone, {folder / limit, 1, {}, {}, {}});
    const CellResult& cell = study_results(alone, folder / limit).cells[0];
    EXPECT_EQ(both.cells[place].summary.trials, cell.summary.trials);
    EXPECT_EQ(both.cells[place].summary.success, cell.summary.success);
    ++place;
  }
}

}  // namespace
}  // namespace vernier
