// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/ordered_parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace vernier::internal {
namespace {

TEST(ForEachIndexOnThreads, CallsEachOnce) {
  for (const int threads : {1, 2, 7, 0}) {
    std::vector<int> calls(1000, 0);
    for_each_index(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(1000, 1)) << threads;
  }
}

TEST(ForEachIndexOnThreads, ThrowsTheFirstByIndex) {
  for (const int threads : {1, 3, 8}) {
    std::atomic<int> calls{0};
    try {
      for_each_index(200, threads, [&](std::size_t i) {
        ++calls;
        if (i % 50 == 49) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "49") << threads;
    }
    EXPECT_GE(calls, 50);
  }
}

TEST(ForEachIndexOnThreads, MayBeCalledWithinItself) {
  std::vector<int> sums(8, 0);
  for_each_index(sums.size(), 4, [&](std::size_t i) {
    std::vector<int> parts(16, 0);
    for_each_index(parts.size(), 2, [&](std::size_t k) { parts[k] = static_cast<int>(k); });
    for (const int part : parts) sums[i] += part;
  });
  EXPECT_EQ(sums, std::vector<int>(8, 120));
}

}  // namespace
}  // namespace vernier::internal
