// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/share_folder.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "calib/error.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

std::string shipped_names(const fs::path& folder, const std::string& ending) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.size() > ending.size() && name.ends_with(ending)) {
      names.push_back(name.substr(0, name.size() - ending.size()));
    }
  }
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none found" : list;
}

fs::path find(const std::string& name,
              const fs::path& beside,
              const std::string& kind,
              const std::string& ending) {
  std::vector<fs::path> tried;
  if (!beside.empty()) tried.push_back(beside / name);
  tried.emplace_back(name);
  const fs::path folder = share_folder() / (kind + "s");
  if (name.find('/') == std::string::npos) tried.push_back(folder / (name + ending));
  for (const fs::path& path : tried) {
    if (fs::is_regular_file(path)) return path;
  }
  throw Error(kind + " \"" + name + "\"", "there is no such file and no shipped one of this name",
              "shipped: " + shipped_names(folder, ending));
}

}  // namespace

fs::path share_folder() {
  if (const char* folder = std::getenv("VERNIER_SHARE")) return folder;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  for (const fs::path& candidate : {program.parent_path() / "share" / "vernier",
                                    program.parent_path() / ".." / "share" / "vernier"}) {
    if (fs::is_directory(candidate)) return candidate;
  }
  return {};
}

fs::path find_world(const std::string& name, const fs::path& beside) {
  return find(name, beside, "world", ".world.toml");
}

fs::path find_rig(const std::string& name, const fs::path& beside) {
  return find(name, beside, "rig", ".rig.json");
}

}  // namespace vernier::cli
