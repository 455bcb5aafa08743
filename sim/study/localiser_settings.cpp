// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The tables [localiser] and [histograms] of a study file.
#include <algorithm>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "sim/experiment.h"
#include "sim/study/settings_reader.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

void SettingsReader::read_localiser(const toml::table& table, ExperimentSettings& settings) const {
  check_keys(table,
             {"method", "looks", "knows_endpoint_sigma", "ranker", "candidates", "max_error_rate",
              "look_error_rate", "off_map", "repeats", "stages", "command", "time_limit_s",
              "corners", "min_corners"},
             "[localiser]");
  if (const auto* method = table.get("method")) {
    settings.method = text(*method, "localiser.method");
    const std::vector<std::string> known = localiser_names();
    if (std::find(known.begin(), known.end(), settings.method) == known.end()) {
      fail(*method, "unknown localiser " + in_quotes(settings.method),
           "use " + alternatives(known));
    }
  }
  if (const auto* knows = table.get("knows_endpoint_sigma")) {
    if (!knows->is_boolean()) {
      fail(*knows, "localiser.knows_endpoint_sigma is not a boolean", "use true or false");
    }
    settings.knows_endpoint_sigma = knows->as_boolean()->get();
  }
  if (const auto* ranker = table.get("ranker")) {
    settings.localiser.ranker = text(*ranker, "localiser.ranker");
    const Keys known{"view", "pgh", "pgh_aggregate"};
    if (std::find(known.begin(), known.end(), settings.localiser.ranker) == known.end()) {
      fail(*ranker, "unknown ranker " + in_quotes(settings.localiser.ranker),
           "use view, pgh or pgh_aggregate");
    }
  }
  if (const auto* candidates = table.get("candidates")) {
    const std::int64_t count = integer(*candidates, "localiser.candidates");
    if (count < 1 || count > 10'000) {
      fail(*candidates, "localiser.candidates is not from 1 to 10000", "use 256");
    }
    settings.localiser.candidates = static_cast<int>(count);
  }
  if (const auto* rate = table.get("max_error_rate")) {
    settings.localiser.max_error_rate = number_in(*rate, "localiser.max_error_rate", 1e-6, 1);
  }
  if (const auto* rate = table.get("look_error_rate")) {
    settings.localiser.look_error_rate = number_in(*rate, "localiser.look_error_rate", 1e-6, 1);
  }
  if (const auto* repeats = table.get("repeats")) {
    settings.localiser.repeats = number_in(*repeats, "localiser.repeats", 0, 0.999);
  }
  if (const auto* off_map = table.get("off_map")) {
    settings.localiser.off_map = number_in(*off_map, "localiser.off_map", 0, 0.999);
  }
  if (const auto* stages = table.get("stages")) {
    settings.localiser.stages =
        word(*stages, "localiser.stages", [](const std::string& w) { return localiser_stages(w); });
  }
  if (const auto* looks = table.get("looks")) {
    const std::int64_t count = integer(*looks, "localiser.looks");
    if (count < 1 || count > 12) {
      fail(*looks, "localiser.looks is not from 1 to 12", "use 1, or 2 for a second look");
    }
    settings.looks = static_cast<int>(count);
  }
  read_views(table, settings.localiser);
  read_program(table, settings);
}

void SettingsReader::read_views(const toml::table& table, LocaliserOptions& options) const {
  if (const auto* node = table.get("corners")) {
    if (!node->is_boolean()) {
      fail(*node, "localiser.corners is not a boolean", "use true or false");
    }
    options.corners = node->as_boolean()->get();
  }
  if (const auto* node = table.get("min_corners")) {
    const std::int64_t count = integer(*node, "localiser.min_corners");
    if (count < 4 || count > 10'000) {
      fail(*node, "localiser.min_corners is not from 4 to 10000", "use 8");
    }
    options.min_corners = static_cast<int>(count);
  }
}

void SettingsReader::read_program(const toml::table& table, ExperimentSettings& settings) const {
  if (settings.method != "program") return;  // a sweep may set both
  settings.localiser.command =
      command(required(table, "command", "[localiser]"), "localiser.command");
  if (const auto* limit = table.get("time_limit_s")) {
    settings.localiser.time_limit_s = number_in(*limit, "localiser.time_limit_s", 1e-3, 86400);
  }
}

void SettingsReader::read_histograms(const toml::table& table, PghOptions& options) const {
  constexpr double degree = std::numbers::pi / 180;
  check_keys(table,
             {"type", "blur", "angle_bins", "distance_bins", "max_distance", "height_bands",
              "angle_sigma_deg", "distance_sigma", "max_lines"},
             "[histograms]");
  const auto count = [&](const char* key, int& value, std::int64_t low, std::int64_t high) {
    const auto* node = table.get(key);
    if (!node) return;
    const std::string what = fmt::format("histograms.{}", key);
    const std::int64_t given = integer(*node, what);
    if (given < low || given > high) {
      fail(*node, fmt::format("{} is not from {} to {}", what, low, high),
           fmt::format("use {}", value));
    }
    value = static_cast<int>(given);
  };
  const auto size = [&](const char* key, double& value, double low, double high, double unit) {
    const auto* node = table.get(key);
    if (node) value = unit * number_in(*node, fmt::format("histograms.{}", key), low, high);
  };
  if (const auto* type = table.get("type")) {
    options.type = word(*type, "histograms.type", [](const std::string& w) { return pgh_type(w); });
  }
  if (const auto* blur = table.get("blur")) {
    options.blur = word(*blur, "histograms.blur", [](const std::string& w) { return pgh_blur(w); });
  }
  count("angle_bins", options.angle_bins, 1, 180);
  count("distance_bins", options.distance_bins, 1, 1000);
  count("height_bands", options.height_bands, 1, 20);
  count("max_lines", options.max_lines, 2, 10'000);
  constexpr double most_bins = 1e5;  // of a directed histogram: 8 quadrants
  if (8.0 * options.angle_bins * options.distance_bins * options.height_bands > most_bins) {
    fail(table, "a histogram has more than 12500 bins in a quadrant", "use fewer bins or bands");
  }
  size("max_distance", options.max_distance, 0.1, 1e5, 1);
  size("angle_sigma_deg", options.angle_sigma_rad, 0.01, 90, degree);
  size("distance_sigma", options.distance_sigma, 1e-4, 1e4, 1);
}

}  // namespace vernier::sim::internal
