// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/world_summary.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/study/study.h"

namespace vernier {

using namespace vernier::sim::internal;

namespace {

CellResult cell(std::vector<std::pair<std::string, std::string>> swept, int successes, int trials) {
  CellResult result;
  result.cell.swept = std::move(swept);
  if (trials > 0) result.maps = {{successes, trials}};
  return result;
}

TEST(WorldSummary, TakesCellsThatDifferInTheWorldOnly) {
  std::vector<CellResult> cells;
  for (int world = 0; world < 6; ++world) {
    for (const char* psi : {"1", "10"}) {
      cells.push_back(
          cell({{"world.file", "w" + std::to_string(world)}, {"sources.calibration", psi}},
               psi == std::string("1") ? 90 + world : 50, 100));
    }
  }
  const std::vector<WorldSummary> all = summarise_over_worlds(cells);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].label, "sources.calibration = 1");
  EXPECT_EQ(all[0].cells, (std::vector<std::size_t>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(all[0].worlds, 6);
  EXPECT_DOUBLE_EQ(all[0].success, 0.925);
  ASSERT_TRUE(all[0].success_interval_95);
  EXPECT_LT(all[0].success_interval_95->low, 0.92);
  EXPECT_GT(all[0].success_interval_95->high, 0.93);
}

TEST(WorldSummary, NeedsSixWorldsWithTrials) {
  std::vector<CellResult> cells;
  for (int world = 0; world < 6; ++world) {
    cells.push_back(cell({{"world.file", std::to_string(world)}}, 9, world == 3 ? 0 : 10));
  }
  const std::vector<WorldSummary> all = summarise_over_worlds(cells);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].label, "all worlds");
  EXPECT_FALSE(all[0].success_interval_95);
  EXPECT_EQ(all[0].why_no_interval, "needs 6 worlds, has 5");
}

TEST(WorldSummary, HasNoneWithoutSweptWorlds) {
  EXPECT_TRUE(summarise_over_worlds({cell({{"sources.calibration", "1"}}, 9, 10)}).empty());
  EXPECT_TRUE(summarise_over_worlds({cell({}, 9, 10)}).empty());
}

}  // namespace
}  // namespace vernier
