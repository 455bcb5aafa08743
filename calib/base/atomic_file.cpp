// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "calib/error.h"

namespace vernier::internal {

namespace {

/// A temporary file that replaces its target on commit; removed if it is not committed.
class Staged {
 public:
  Staged(const std::filesystem::path& named, std::string_view content);
  Staged(Staged&& other) noexcept
      : file_(std::move(other.file_)), temporary_(std::exchange(other.temporary_, {})) {}
  ~Staged() {
    std::error_code ignored;
    if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  }
  void put_in_place();

 private:
  std::filesystem::path file_, temporary_;
};

Staged::Staged(const std::filesystem::path& named, std::string_view content) : file_(named) {
  // rename() would replace a link, a device or a pipe by a regular file: follow links and refuse
  // anything that is not a regular file.
  std::error_code unknown;
  for (int links = 0; links < 40 && std::filesystem::is_symlink(file_, unknown); ++links) {
    file_ = file_.parent_path() / std::filesystem::read_symlink(file_, unknown);
  }
  if (std::filesystem::exists(file_, unknown) &&
      !std::filesystem::is_regular_file(file_, unknown)) {
    throw Error(named.string(), "exists and is not a regular file", "choose another name");
  }
  temporary_ = file_.string() + "." + std::to_string(::getpid()) + ".tmp";
  std::ofstream out(temporary_, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.flush();
  if (!out) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    throw Error(file_.string(), "cannot be written",
                "check that its folder exists and has free space");
  }
}

void Staged::put_in_place() {
  std::error_code error;
  std::filesystem::rename(temporary_, file_, error);
  if (error) {
    throw Error(file_.string(), "cannot be written: " + error.message(), "choose another name");
  }
  temporary_.clear();
}

}  // namespace

void write_atomically(const std::filesystem::path& file, std::string_view content) {
  Staged(file, content).put_in_place();
}

void write_atomically(
    const std::vector<std::pair<std::filesystem::path, std::string>>& named_contents) {
  std::vector<Staged> staged;
  staged.reserve(named_contents.size());
  for (const auto& [file, content] : named_contents) staged.emplace_back(file, content);
  for (Staged& file : staged) file.put_in_place();
}

std::string read_whole(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw Error(file.string(), "is a folder", "name a file in it");
  }
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw Error(file.string(), std::string("cannot be read: ") + std::strerror(errno ? errno : EIO),
                "check the name");
  }
  std::ostringstream content;
  content << in.rdbuf();
  return std::move(content).str();
}

}  // namespace vernier::internal
