// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "calib/base/atomic_file.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

class ReadWhole : public testing::Test {
 protected:
  ReadWhole() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ReadWhole() override { std::filesystem::remove_all(folder_); }

  std::string fault(const std::filesystem::path& file, std::size_t most_bytes = 1 << 20) {
    return test::error_message([&] { read_whole(file, most_bytes); });
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("read_whole_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ReadWhole, DevicesAreRefusedAtOnce) {
  for (const char* device : {"/dev/zero", "/dev/null", "/dev/full", "/dev/urandom"}) {
    EXPECT_EQ(fault(device),
              std::string(device) + ": is a device, not a file; give a file or a pipe");
  }
}

TEST_F(ReadWhole, LargeFilesAreRefusedWithoutReadingThem) {
  const std::filesystem::path file = folder_ / "large";
  std::ofstream(file) << "x";
  std::filesystem::resize_file(file, most_file_bytes + 1);  // sparse
  EXPECT_EQ(test::error_message([&] { read_whole(file); }),
            file.string() +
                ": is larger than 1073741824 bytes, more than can be read; check that it is the "
                "right file");
}

TEST_F(ReadWhole, TheLimitItselfIsRead) {
  const std::filesystem::path file = folder_ / "some";
  std::ofstream(file) << std::string(100'000, 'a');
  EXPECT_EQ(read_whole(file, 100'000), std::string(100'000, 'a'));
  EXPECT_NE(fault(file, 99'999), "");
}

TEST_F(ReadWhole, PipesAreReadToTheirEndAndNotBeyondTheLimit) {
  const std::filesystem::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string content(300'000, 'b');
  std::thread writer([&] { std::ofstream(pipe) << content; });
  EXPECT_EQ(read_whole(pipe), content);
  writer.join();
}

TEST_F(ReadWhole, FilesOfTheKernelThatSayTheyAreEmptyAreRead) {
  EXPECT_NE(read_whole("/proc/self/status").find("Name:"), std::string::npos);
}

TEST_F(ReadWhole, FoldersAndMissingFilesAreRefused) {
  EXPECT_NE(fault(folder_).find("is a folder; name a file in it"), std::string::npos);
  EXPECT_NE(fault(folder_ / "none").find("cannot be read: No such file or directory"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
