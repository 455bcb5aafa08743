// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "fuzz/fuzz_target.h"

namespace vernier {
namespace fuzz {

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

}  // namespace fuzz

namespace {

namespace fs = std::filesystem;

fs::path corpus() { return fs::path(VERNIER_SOURCE_DIR) / "tests" / "corpus"; }

/// Every target on its own seeds and on the kept inputs, tests/corpus/TARGET: the targets throw
/// nothing.
class Replay : public testing::TestWithParam<fuzz::Target> {
 protected:
  void SetUp() override {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
  }
  void TearDown() override { cv::redirectError(nullptr); }

  static void run(const std::string& bytes, const std::string& input) {
    try {
      GetParam().run(bytes);
    } catch (const std::exception& error) {
      ADD_FAILURE() << input << ": " << error.what();
    }
  }
};

TEST_P(Replay, RefusesOrKeepsItsSeeds) {
  int index = 0;
  for (const std::string& seed : GetParam().seeds()) run(seed, "seed " + std::to_string(index++));
  EXPECT_GT(index, 0);
}

TEST_P(Replay, RefusesOrKeepsTheCorpus) {
  std::vector<fs::path> files;
  if (const fs::path folder = corpus() / GetParam().name; fs::is_directory(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) run(fuzz::file_bytes(file), file.string());
}

INSTANTIATE_TEST_SUITE_P(Targets, Replay, testing::ValuesIn(fuzz::targets()), [](const auto& info) {
  return std::string(info.param.name);
});

TEST(Corpus, BelongsToTargetsAndIsSmall) {
  std::set<std::string> names;
  for (const fuzz::Target& target : fuzz::targets()) names.insert(target.name);
  EXPECT_EQ(names.size(), fuzz::targets().size()) << "two targets have one name";
  std::uintmax_t bytes = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(corpus())) {
    if (entry.is_directory()) {
      EXPECT_EQ(names.count(entry.path().filename().string()), 1u) << entry.path();
    } else {
      bytes += entry.file_size();
    }
  }
  EXPECT_LT(bytes, 1'000'000u);
}

}  // namespace
}  // namespace vernier
