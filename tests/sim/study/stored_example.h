// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>

#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/study_store.h"

namespace vernier::test {

/// A block of five trials, one of them without an answer.
inline sim::internal::StoredBlock example_block(const std::string& cell, int block) {
  sim::internal::StoredBlock stored{cell, block, {}};
  for (int i = 0; i < 5; ++i) {
    sim::TrialResult t;
    t.trial = static_cast<std::uint32_t>(5 * block + i);
    t.truth = {1.0 / 3 + i, -2.0 / 7, 0.1 * block};
    t.status =
        i < 4 ? localise::LocalisationStatus::answered : localise::LocalisationStatus::no_match;
    t.error = t.node_error_m = t.heading_error_rad = i < 4 ? 0.3 / (i + 1) : std::nan("");
    t.lines = 17 + i;
    t.score = 1e-17;
    t.cpu_ms = 0.1;
    stored.trials.push_back(t);
  }
  return stored;
}

/// A folder of its own for each test, removed afterwards.
class TestFolder {
 public:
  explicit TestFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("vernier_" + name + "_" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace vernier::test
