// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/system_kind.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/text_lines.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

SystemKind localiser_kind() {
  return {.name = "localiser",
          .noun = "a localiser",
          .error_name = "error_m",
          .error_title = "error",
          .unit = "m",
          .success_error = success_radius_m,
          .sections = {"world", "calibration", "sources", "corners", "camera", "map", "localiser",
                       "histograms", "one_at_a_time"},
          .sources = SourcesUsed::all,
          .uses_protocol = true,
          .tells_rigs = true};
}

std::map<std::string, SystemKind>& kinds() {
  static std::map<std::string, SystemKind> known{{"localiser", localiser_kind()}};
  return known;
}

}  // namespace

double SystemSettings::number(const std::string& option) const {
  return to_finite(text(option)).value();
}

int SystemSettings::whole(const std::string& option) const {
  return static_cast<int>(number(option));
}

const std::string& SystemSettings::text(const std::string& option) const {
  return options.at(option);
}

std::string SystemSettings::command() const {
  const auto found = options.find("command");
  return found == options.end() ? "" : found->second;
}

bool SystemKind::uses(std::string_view section) const {
  return std::find(sections.begin(), sections.end(), section) != sections.end();
}

void register_system(SystemKind kind) {
  std::string name = kind.name;
  kinds().insert_or_assign(std::move(name), std::move(kind));
}

const SystemKind& system_kind(const std::string& name) { return kinds().at(name); }

std::vector<std::string> system_names() {
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds()) names.push_back(name);
  return names;
}

}  // namespace vernier::sim::internal
