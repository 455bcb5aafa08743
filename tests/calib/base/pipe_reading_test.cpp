// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "calib/base/atomic_file.h"
#include "calib/base/program_run.h"

namespace vernier {

using namespace vernier::internal;

namespace {

TEST(PipeReading, GivesTheSameContentEveryTime) {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string content(300'000, 'x');
  std::thread writer([&] { std::ofstream(pipe) << content; });
  EXPECT_EQ(read_whole(pipe), content);
  writer.join();
  EXPECT_EQ(read_whole(pipe), content);  // nobody writes any more
}

}  // namespace
}  // namespace vernier
