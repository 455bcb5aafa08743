// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/output_files.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>

#include "calib/base/atomic_file.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/program_run.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;
using test::error_message;

namespace fs = std::filesystem;

namespace {

class OutputFilesTest : public testing::Test {
 protected:
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::recursive_directory_iterator(folder_.path()), {}));
  }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
};

TEST_F(OutputFilesTest, AppearTogether) {
  write_atomically(path("b"), "old");
  OutputFiles outputs;
  outputs.add_folder(path("new/folder/"));
  outputs.add(path("a"), "1");
  outputs.add(path("b"), "2");
  FileInProgress& streamed = outputs.add(path("new/folder/c"));
  streamed.append("3");
  streamed.append("4");
  EXPECT_FALSE(fs::exists(path("a")));
  EXPECT_EQ(read_whole(path("b")), "old");
  outputs.commit();
  EXPECT_EQ(read_whole(path("a")), "1");
  EXPECT_EQ(read_whole(path("b")), "2");
  EXPECT_EQ(read_whole(path("new/folder/c")), "34");
  EXPECT_EQ(entries(), 5u);
}

TEST_F(OutputFilesTest, LeaveNothingWithoutCommit) {
  write_atomically(path("b"), "old");
  {
    OutputFiles outputs;
    outputs.add_folder(path("new/folder"));
    outputs.add(path("new/folder/a"), "1");
    outputs.add(path("b"), "2");
  }
  EXPECT_EQ(read_whole(path("b")), "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(OutputFilesTest, AreNoneWhereOneCannotBeRenamed) {
  write_atomically(path("b"), "old");
  {
    OutputFiles outputs;
    outputs.add(path("a"), "1");
    outputs.add(path("b"), "2");
    outputs.add(path("c"), "3");
    fs::create_directory(path("c"));  // somebody else's, meanwhile
    const std::string said = error_message([&] { outputs.commit(); });
    EXPECT_NE(said.find("c: cannot be written"), std::string::npos) << said;
  }
  EXPECT_FALSE(fs::exists(path("a")));
  EXPECT_EQ(read_whole(path("b")), "old");
  EXPECT_TRUE(fs::is_directory(path("c")));
  EXPECT_EQ(entries(), 2u);
}

TEST_F(OutputFilesTest, AreRefusedWhereTwoAreOneFile) {
  write_atomically(path("a"), "old");
  fs::create_symlink("a", path("link"));
  OutputFiles outputs;
  outputs.add(path("a"), "1");
  for (const char* same : {"a", "./a", "link"}) {
    const std::string said = error_message([&] { outputs.add(path(same), "2"); });
    EXPECT_NE(said.find("already used"), std::string::npos) << same;
  }
}

TEST_F(OutputFilesTest, NeedAFolderThatIsOne) {
  write_atomically(path("a"), "old");
  OutputFiles outputs;
  for (const char* name : {"a", "a/b"}) {
    EXPECT_NE(error_message([&] { outputs.add_folder(path(name)); }), "") << name;
  }
}

TEST_F(OutputFilesTest, AreCheckedBeforeTheyAreWritten) {
  write_atomically(path("a"), "old");
  const std::size_t before = entries();
  // a check of names says what writing them would say, and makes nothing
  for (const char* name : {"a", "new", "none/new", "a/new", "."}) {
    const auto write = [&] {
      const FileInProgress file(path(name));
      return 0;
    };
    EXPECT_EQ(error_message([&] { check_writable_file(path(name)); }), error_message(write))
        << name;
  }
  EXPECT_NE(error_message([&] {
              check_writable_file(path(std::string(300, 'a')));
            }).find("choose a shorter name"),
            std::string::npos);
  for (const char* name : {"a", "a/b", "new", "new/folder/", "."}) {
    const auto make = [&] {
      OutputFiles outputs;
      outputs.add_folder(path(name));
    };
    EXPECT_EQ(error_message([&] { check_writable_folder(path(name)); }) == "",
              error_message(make) == "")
        << name;
  }
  EXPECT_EQ(entries(), before);
}

TEST_F(OutputFilesTest, MayBeMoreThanTheDescriptorsOfAProcess) {
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const rlimit few{30, before.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &few);
  EXPECT_NO_THROW({
    OutputFiles outputs;
    constexpr int many = 40;
    for (int i = 0; i < many; ++i) outputs.add(path(std::to_string(i)), "x");
  });
  ::setrlimit(RLIMIT_NOFILE, &before);
}

}  // namespace
}  // namespace vernier
