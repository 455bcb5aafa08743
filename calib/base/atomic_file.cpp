// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "calib/base/file_in_progress.h"
#include "calib/base/output_files.h"
#include "calib/error.h"

namespace vernier::internal {

namespace {

/// A file opened for reading, closed at the end.
struct OpenedFile {
  explicit OpenedFile(const std::filesystem::path& file)
      : descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY)) {}
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;
  ~OpenedFile() {
    if (descriptor >= 0) ::close(descriptor);
  }

  const int descriptor;
};

/// Pipes can be read once only, but callers look at a file before they read it, or read it for two
/// purposes: what a pipe held is kept, until somebody writes to it again.
struct PipeContents {
  struct Held {
    timespec written;
    std::string content;
  };
  std::mutex mutex;
  std::map<std::tuple<std::string, dev_t, ino_t>, Held> held;
};

bool same_time(const timespec& a, const timespec& b) {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

PipeContents& pipe_contents() {
  static PipeContents contents;
  return contents;
}

}  // namespace

void write_atomically(const std::filesystem::path& file, std::string_view content) {
  FileInProgress out(file);
  out.append(content);
  out.commit();
}

void write_atomically(
    const std::vector<std::pair<std::filesystem::path, std::string>>& named_contents) {
  OutputFiles outputs;
  for (const auto& [file, content] : named_contents) outputs.add(file, content);
  outputs.commit();
}

std::string read_whole(const std::filesystem::path& file, std::size_t most_bytes) {
  const auto refuse = [&](const std::string& fault, const std::string& remedy) {
    throw Error(file.string(), fault, remedy);
  };
  const auto refuse_for = [&](int error) {
    refuse(std::string("cannot be read: ") + std::strerror(error ? error : EIO), "check the name");
  };
  struct stat named {};
  const bool is_pipe = ::stat(file.c_str(), &named) == 0 && S_ISFIFO(named.st_mode);
  std::unique_lock<std::mutex> pipes;
  if (is_pipe) {
    pipes = std::unique_lock(pipe_contents().mutex);
    const auto held = pipe_contents().held.find({file.string(), named.st_dev, named.st_ino});
    if (held != pipe_contents().held.end() && same_time(held->second.written, named.st_mtim)) {
      return held->second.content;
    }
  }
  errno = 0;
  const OpenedFile opened(file);
  struct stat facts {};
  if (opened.descriptor < 0 || ::fstat(opened.descriptor, &facts) != 0) refuse_for(errno);
  if (S_ISDIR(facts.st_mode)) refuse("is a folder", "name a file in it");
  if (!S_ISREG(facts.st_mode) && !S_ISFIFO(facts.st_mode)) {
    refuse("is a device, not a file", "give a file or a pipe");
  }
  const auto refuse_size = [&] {
    refuse("is larger than " + std::to_string(most_bytes) + " bytes, more than can be read",
           "check that it is the right file");
  };
  std::string content;
  if (S_ISREG(facts.st_mode)) {
    if (static_cast<std::size_t>(facts.st_size) > most_bytes) refuse_size();
    content.reserve(static_cast<std::size_t>(facts.st_size));
  }
  std::array<char, 1 << 16> block{};
  for (;;) {
    const ssize_t got = ::read(opened.descriptor, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse_for(errno);
    if (got == 0) break;
    content.append(block.data(), static_cast<std::size_t>(got));
    if (content.size() > most_bytes) refuse_size();
  }
  if (is_pipe && ::fstat(opened.descriptor, &facts) == 0) {
    pipe_contents().held[{file.string(), facts.st_dev, facts.st_ino}] = {facts.st_mtim, content};
  }
  return content;
}

}  // namespace vernier::internal
