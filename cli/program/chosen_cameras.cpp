// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/chosen_cameras.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <sstream>

#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {

std::vector<std::string> listed(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

std::vector<int> chosen_cameras(const Rig& rig, const std::string& list) {
  std::vector<int> chosen;
  if (list.empty()) {
    chosen.resize(rig.cameras.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    return chosen;
  }
  for (const std::string& name : listed(list)) {
    const auto named = [&](const Camera& camera) { return camera.name == name; };
    const auto found = std::find_if(rig.cameras.begin(), rig.cameras.end(), named);
    const int i = static_cast<int>(found - rig.cameras.begin());
    const bool is_known = found != rig.cameras.end();
    if (!is_known || std::find(chosen.begin(), chosen.end(), i) != chosen.end()) {
      std::string names;
      for (const Camera& camera : rig.cameras) names += (names.empty() ? "" : ",") + camera.name;
      throw Error(
          "--cameras " + list,
          in_quotes(name) + (is_known ? " is given twice" : " is none of the rig's cameras"),
          "give some of " + names);
    }
    chosen.push_back(i);
  }
  if (chosen.empty()) throw Error("--cameras", "names no camera", "give some of the rig's");
  return chosen;
}

void require_chosen_pair(const Rig& rig, const std::string& list, const std::string& file) {
  const auto chosen = static_cast<std::int64_t>(chosen_cameras(rig, list).size());
  if (chosen == 2) return;
  if (rig.cameras.size() < 2) {
    throw Error(file, "it needs a pair and the rig has 1 camera",
                "choose projection or a parameter");
  }
  const std::string remedy =
      fmt::format("name two of them, as in --cameras {},{}", shortened(rig.cameras[0].name),
                  shortened(rig.cameras[1].name));
  throw list.empty()
      ? Error(file, "it needs a pair and the rig has " + counted(chosen, "camera"), remedy)
      : Error("--cameras " + list, "it needs a pair and this is " + counted(chosen, "camera"),
              remedy);
}

}  // namespace vernier::cli
