// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/file_in_progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/program_run.h"
#include "calib/base/unfinished_work.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;
using test::error_message;

namespace fs = std::filesystem;

namespace {

class FileInProgressTest : public testing::Test {
 protected:
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), {}));
  }
  mode_t mode(const fs::path& file) const {
    struct stat state {};
    ::stat(file.c_str(), &state);
    return state.st_mode & 07777;
  }

  TemporaryFolder folder_;
  const fs::path file_ = folder_.path() / "file";
};

TEST_F(FileInProgressTest, AppearsCompleteOrNotAtAll) {
  write_atomically(file_, "old");
  {
    FileInProgress out(file_);
    out.append("half of it");
    out.finish();
    EXPECT_EQ(read_whole(file_), "old");
    EXPECT_EQ(entries(), 2u);
  }
  EXPECT_EQ(read_whole(file_), "old");
  EXPECT_EQ(entries(), 1u);
  FileInProgress out(file_);
  out.append("ne");
  out.append("w");
  out.commit();
  EXPECT_EQ(read_whole(file_), "new");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(FileInProgressTest, KeepsEveryByteInPiecesOfAnySize) {
  std::string all;
  FileInProgress out(file_);
  for (std::size_t size = 1; size < 1'000'000; size = 3 * size + 1) {
    const std::string piece(size, static_cast<char>('a' + size % 26));
    out.append(piece);
    all += piece;
  }
  out.append("");
  out.commit();
  EXPECT_EQ(read_whole(file_), all);
}

TEST_F(FileInProgressTest, UsesANameThatNobodyGuessesAndNoLinkThere) {
  const FileInProgress one(file_), two(file_);
  EXPECT_NE(one.temporary(), two.temporary());
  for (const FileInProgress* out : {&one, &two}) {
    const std::string name = out->temporary().filename();
    EXPECT_EQ(name.rfind(".vernier-", 0), 0u);
    EXPECT_EQ(name.substr(name.size() - 4), ".tmp");
    EXPECT_EQ(out->temporary().parent_path(), folder_.path());
  }
  const fs::path victim = folder_.path() / "victim";
  write_atomically(victim, "untouched");
  fs::create_symlink(victim, file_.string() + "." + std::to_string(::getpid()) + ".tmp");
  write_atomically(file_, "new");
  EXPECT_EQ(read_whole(victim), "untouched");
  EXPECT_FALSE(fs::is_symlink(file_));
}

TEST_F(FileInProgressTest, IsNotInheritedByOtherPrograms) {
  const FileInProgress out(file_);
  const ProgramRun run = run_program({"ls", "-l", "/proc/self/fd"});
  EXPECT_EQ(run.output.find(".vernier-"), std::string::npos) << run.output;
}

TEST_F(FileInProgressTest, TakesOverThePermissionsOfWhatItReplaces) {
  const mode_t mask = ::umask(027);
  write_atomically(file_, "new");
  EXPECT_EQ(mode(file_), 0640u);
  ::chmod(file_.c_str(), 04604);
  write_atomically(file_, "newer");
  EXPECT_EQ(mode(file_), 0604u);  // never a set-user-id bit
  ::umask(mask);
}

TEST_F(FileInProgressTest, FollowsALinkAndRefusesWhatIsNoFile) {
  const fs::path link = folder_.path() / "link", pipe = folder_.path() / "pipe";
  fs::create_symlink("file", link);
  write_atomically(link, "through the link");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_whole(file_), "through the link");
  ::mkfifo(pipe.c_str(), 0600);
  fs::create_symlink("round", folder_.path() / "round");
  const auto refused = [](const fs::path& file) {
    return error_message([&] { write_atomically(file, "x"); });
  };
  EXPECT_NE(refused(pipe).find("not a regular file"), std::string::npos);
  EXPECT_NE(refused(folder_.path()).find("is a folder"), std::string::npos);
  EXPECT_NE(refused("/dev/null").find("not a regular file"), std::string::npos);
  EXPECT_NE(refused(folder_.path() / "round").find("cannot be written"), std::string::npos);
  EXPECT_NE(refused(folder_.path() / "no" / "file").find("make its folder"), std::string::npos);
  EXPECT_NE(refused("").find("cannot be written"), std::string::npos);
}

TEST_F(FileInProgressTest, MovesWithItsTemporaryFile) {
  FileInProgress first(file_);
  first.append("moved");
  {
    FileInProgress second(std::move(first));
    second.commit();
  }
  EXPECT_EQ(read_whole(file_), "moved");
}

/// What a program does that ends by a signal, in a child since nothing may follow.
TEST_F(FileInProgressTest, IsRemovedWhenTheProcessAbandonsItsWork) {
  const pid_t child = ::fork();
  if (child == 0) {
    forget_unfinished(folder_.path());
    FileInProgress out(file_);
    out.append("half of it");
    const TemporaryFolder temporary;
    abandon_unfinished_work();
    ::_exit(fs::exists(temporary.path()) ? 1 : 0);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(entries(), 0u);
}

}  // namespace
}  // namespace vernier
