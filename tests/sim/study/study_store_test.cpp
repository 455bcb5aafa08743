// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_store.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "sim/experiment.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

class Store : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("vernier_store_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(Store, BlocksRoundTripToTheBit) {
  TrialResult t;
  t.trial = 7;
  t.truth = {1.0 / 3, -2.0 / 7, 0.1};
  t.status = LocalisationStatus::too_few_lines;
  t.error_m = std::nan("");
  t.score = 1e-17;
  {
    StudyStore store(folder_ / "a.sqlite");
    store.put({"cell", 3, {t}});
    store.set_metadata("k", "v");
  }
  const StudyStore again(folder_ / "a.sqlite");
  const auto blocks = again.blocks();
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].block, 3);
  EXPECT_EQ(blocks[0].trials[0].truth.x_m, 1.0 / 3);
  EXPECT_EQ(blocks[0].trials[0].score, 1e-17);
  EXPECT_TRUE(std::isnan(blocks[0].trials[0].error_m));
  EXPECT_EQ(again.note("k"), "v");
  EXPECT_EQ(again.note("none"), "");
}

TEST_F(Store, AnotherKindOfFileIsRefusedAndKept) {
  write_atomically(folder_ / "b.sqlite", "this is no database at all, but it is somebody's file\n");
  EXPECT_THROW(StudyStore(folder_ / "b.sqlite"), Error);
  EXPECT_NE(read_whole(folder_ / "b.sqlite").find("somebody"), std::string::npos);
}

TEST_F(Store, AnotherInstructionSetIsRefused) {
  {
    StudyStore store(folder_ / "c.sqlite");
    store.set_metadata("instruction_set", "ABACUS");
  }
  try {
    StudyStore store(folder_ / "c.sqlite");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("instruction set ABACUS"), std::string::npos);
  }
}

}  // namespace
}  // namespace vernier
