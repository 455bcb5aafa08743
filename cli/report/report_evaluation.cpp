// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report_evaluation.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "calib/base/atomic_file.h"
#include "calib/base/json_reader.h"
#include "calib/error.h"
#include "cli/program/session.h"
#include "cli/stereo/evaluate_figures.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

/// RFC 4648, section 4.
std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool padding = i + k > bytes.size();
      text += padding ? '=' : digits[group >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

bool is_scene(const Json& scene) {
  return scene.is_object() && scene.contains("name") && scene.contains("matchers") &&
         scene["matchers"].is_object() &&
         (!scene.contains("pictures") || scene["pictures"].is_object());
}

Json read(const fs::path& folder) {
  const fs::path file = folder / evaluation_file;
  Json json = parse_json(read_whole(file), file.string());
  const bool whole = json.is_object() && json.contains("matchers") &&
                     json["matchers"].is_object() && json.contains("scenes") &&
                     json["scenes"].is_array() && !json["scenes"].empty() &&
                     std::all_of(json["scenes"].begin(), json["scenes"].end(), is_scene);
  if (whole) return json;
  throw Error(file.string(), "is not an evaluation", "create it again with vernier evaluate -o");
}

/// File names of a scene's two pictures; empty if it has none.
std::vector<std::string> pictures_of(const Json& scene) {
  std::vector<std::string> names;
  if (!scene.contains("pictures")) return names;
  for (const char* key : {"disparity", "error"}) {
    const Json& name = scene["pictures"].value(key, Json());
    if (!name.is_string()) continue;
    const fs::path file = name.get<std::string>();
    if (file.filename() == file) names.push_back(file.string());  // only files in the same folder
  }
  return names;
}

}  // namespace

bool is_evaluation(const fs::path& folder) { return fs::is_regular_file(folder / evaluation_file); }

Json report_evaluation(const fs::path& folder) {
  Json json = read(folder);
  for (Json& scene : json["scenes"]) {
    const std::vector<std::string> names = pictures_of(scene);
    if (names.size() != 2) {
      scene.erase("pictures");
      continue;
    }
    const auto address = [&](const std::string& name) {
      return "data:image/png;base64," + base64(read_whole(folder / name));
    };
    scene["pictures"]["disparity"] = address(names[0]);
    scene["pictures"]["error"] = address(names[1]);
  }
  return json;
}

std::vector<fs::path> evaluation_files(const fs::path& folder) {
  std::vector<fs::path> files{folder / evaluation_file};
  const Json json = read(folder);  // must outlive the loop
  for (const Json& scene : json["scenes"]) {
    for (const std::string& name : pictures_of(scene)) files.push_back(folder / name);
  }
  return files;
}

}  // namespace vernier::cli
