// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/share_folder.h"

#include <cstdlib>
#include <set>

#include "calib/error.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

std::string shipped_names(const std::string& kind, const std::string& ending) {
  std::set<std::string> names;
  for (const fs::path& share : share_folders()) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(share / (kind + "s"), ignored)) {
      const std::string name = entry.path().filename().string();
      if (name.size() > ending.size() && name.ends_with(ending)) {
        names.insert(name.substr(0, name.size() - ending.size()));
      }
    }
  }
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
  if (name.find('/') == std::string::npos)
    tried.push_back(shipped_file(kind + "s/" + name + ending));
  for (const fs::path& path : tried) {
    if (fs::is_regular_file(path) || fs::is_fifo(path)) return path;
  }
  for (const fs::path& path : tried) {
    if (fs::is_directory(path)) {
      throw Error(kind + " \"" + name + "\"", "is a folder", "give a file inside it");
    }
  }
  throw Error(kind + " \"" + name + "\"", "no such file, and no shipped one of this name",
              "shipped: " + shipped_names(kind, ending));
}

}  // namespace

std::vector<fs::path> share_folders() {
  std::vector<fs::path> candidates;
  const char* named = std::getenv("VERNIER_SHARE");
  if (named && *named) candidates.emplace_back(named);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    candidates.push_back(program.parent_path() / "share" / "vernier");
    candidates.push_back(program.parent_path() / ".." / "share" / "vernier");
  }
  std::erase_if(candidates, [](const fs::path& folder) { return !fs::is_directory(folder); });
  return candidates;
}

fs::path shipped_file(const fs::path& name) {
  for (const fs::path& folder : share_folders()) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return {};
}

fs::path shipped_script(const std::string& name) {
  for (const fs::path& folder : share_folders()) {
    fs::path script = folder / "python" / name;
    if (script.is_absolute() && fs::is_regular_file(script)) return script;
  }
  return name;
}

fs::path find_world(const std::string& name, const fs::path& beside) {
  return find(name, beside, "world", ".world.toml");
}

fs::path find_rig(const std::string& name, const fs::path& beside) {
  return find(name, beside, "rig", ".rig.json");
}

}  // namespace vernier::cli
