// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "calib/error.h"

namespace vernier {

void write_atomically(const std::filesystem::path& named, std::string_view content) {
  // A rename would replace a link by a file, and a device or pipe too: links are followed, what is
  // no file is refused.
  std::error_code unknown;
  std::filesystem::path file = named;
  for (int links = 0; links < 40 && std::filesystem::is_symlink(file, unknown); ++links) {
    file = file.parent_path() / std::filesystem::read_symlink(file, unknown);
  }
  if (std::filesystem::exists(file, unknown) && !std::filesystem::is_regular_file(file, unknown)) {
    throw Error(named.string(), "is there and is no regular file", "name a file");
  }
  const std::filesystem::path temporary = file.string() + "." + std::to_string(::getpid()) + ".tmp";
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.flush();
    if (!out) {
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      throw Error(file.string(), "cannot be written", "check that its folder exists and has room");
    }
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(file.string(), "cannot be written: " + error.message(), "choose another name");
  }
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

}  // namespace vernier
