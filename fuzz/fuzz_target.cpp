// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/fuzz_target.h"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "calib/base/shown_text.h"

namespace vernier::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<Target>& registered_targets() {
  static std::vector<Target> all;
  return all;
}

/// Removed at the end of a process that ends by itself; scripts/fuzz.sh removes the others.
class ProcessFolder {
 public:
  ProcessFolder() {
    std::string name = (fs::temp_directory_path() / "vernier-fuzz-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
    path_ = name;
  }
  ~ProcessFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ProcessFolder(const ProcessFolder&) = delete;
  ProcessFolder& operator=(const ProcessFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

std::vector<Target> targets() {
  std::vector<Target> all = registered_targets();
  std::sort(all.begin(), all.end(),
            [](const Target& a, const Target& b) { return std::strcmp(a.name, b.name) < 0; });
  return all;
}

Registered::Registered(const Target& target) { registered_targets().push_back(target); }

void check_message(const Error& error) {
  require(!error.place().empty() && !error.fault().empty(), "an error has a place and a fault");
  const std::string line = vernier::internal::printable(error.what());  // as it is printed
  require(line.size() < 600 && line.find('\n') == std::string::npos, "a message is one short line");
}

fs::path input_folder() {
  static const ProcessFolder folder;
  return folder.path();
}

void clear_input_folder() {
  for (const fs::directory_entry& entry : fs::directory_iterator(input_folder())) {
    fs::remove_all(entry.path());
  }
}

fs::path input_file(std::string_view bytes, const std::string& name) {
  fs::path file = input_folder() / name;
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
  return file;
}

std::string file_bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::pair<std::string_view, std::string_view> split_at_line(std::string_view bytes,
                                                            std::string_view separator) {
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    if (bytes.substr(at, end - at) == separator) {
      return {bytes.substr(0, at), bytes.substr(std::min(end + 1, bytes.size()))};
    }
    at = end + 1;
  }
  return {bytes, {}};
}

}  // namespace vernier::fuzz
