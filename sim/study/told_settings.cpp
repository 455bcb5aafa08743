// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/told_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;
constexpr int fewest_views = 3, most_views = 1000;  ///< calibrate() needs three

}  // namespace

const toml::table* ToldReader::part(const toml::table& root, const char* name) const {
  const toml::node* node = root.get(name);
  return node ? &table(*node, fmt::format("[{}]", name)) : nullptr;
}

double ToldReader::length(const toml::table& section,
                          const char* key,
                          double otherwise,
                          double most) const {
  const toml::node* node = section.get(key);
  if (!node) return otherwise;
  const double value = number(*node, fmt::format("calibration.{}", key));
  if (!(value > 0 && value <= most)) {
    fail(*node, fmt::format("calibration.{} = {} is out of range", key, value),
         fmt::format("use a value above 0, up to {}", most));
  }
  return value;
}

void ToldReader::read_board(const toml::table& section, ToldSettings& settings) const {
  FreshCalibrationOptions& calibration = *settings.calibration;
  if (const auto* node = section.get("board")) {
    const std::string words = text(*node, "calibration.board");
    int columns = 0, rows = 0, used = 0;
    if (std::sscanf(words.c_str(), "%4dx%4d%n", &columns, &rows, &used) != 2 ||
        used != static_cast<int>(words.size()) || columns < 2 || rows < 2 || columns > 100 ||
        rows > 100) {
      fail(*node, "calibration.board is " + in_quotes(words),
           "give the inner corners, such as \"9x6\", 2 to 100 each way");
    }
    calibration.board.columns = columns;
    calibration.board.rows = rows;
  }
  calibration.board.square_m = length(section, "square_m", calibration.board.square_m, 10);
}

void ToldReader::read_calibration(const toml::table& section, ToldSettings& settings) const {
  check_keys(section,
             {"views", "model", "board", "square_m", "pixel_sigma_px", "distance_m", "tilt_deg",
              "observations"},
             "[calibration]");
  FreshCalibrationOptions& calibration = settings.calibration.emplace();
  if (const auto* node = section.get("views")) {
    const std::int64_t views = integer(*node, "calibration.views");
    if (views < fewest_views || views > most_views) {
      fail(*node, fmt::format("calibration.views = {} is out of range", views),
           fmt::format("use {} to {}: fewer views determine no covariance", fewest_views,
                       most_views));
    }
    calibration.views = static_cast<int>(views);
  }
  if (const auto* node = section.get("model")) {
    settings.model = text(*node, "calibration.model");
    try {
      calibration.model = camera_model(settings.model);
    } catch (const vernier::Error& error) {
      fail(*node, "calibration.model is " + in_quotes(settings.model), error.remedy());
    }
  }
  if (const auto* node = section.get("observations")) {
    settings.observations = text(*node, "calibration.observations");
    if (settings.observations.empty()) {
      fail(*node, "calibration.observations is empty", "name a file of corners, or remove it");
    }
    if (settings.observations.ends_with(".json")) {
      for (const char* known : {"board", "square_m"}) {
        if (const auto* other = section.get(known)) {
          fail(*other, fmt::format("calibration.{} is that of calibration.observations", known),
               "remove it");
        }
      }
    }
    for (const char* simulated : {"pixel_sigma_px", "distance_m", "tilt_deg"}) {
      if (const auto* other = section.get(simulated)) {
        fail(*other, fmt::format("calibration.{} is of simulated views", simulated),
             "remove it, or calibration.observations");
      }
    }
  }
  read_board(section, settings);
  calibration.pixel_sigma_px = length(section, "pixel_sigma_px", calibration.pixel_sigma_px, 100);
  calibration.distance_m = length(section, "distance_m", calibration.distance_m, 1000);
  if (section.contains("tilt_deg")) {
    calibration.tilt_rad = rad_per_deg * length(section, "tilt_deg", 0, 80);
  }
}

void ToldReader::check_told_once(const toml::table& root) const {
  const auto* rig = part(root, "rig");
  if (!rig || !rig->contains("truth")) return;
  for (const char* key : {"file", "error"}) {
    if (const auto* node = rig->get(key)) {
      fail(*node,
           fmt::format("rig.{} has no effect: [calibration] gives the rig that is told", key),
           "remove it, or [calibration]");
    }
  }
}

ToldSettings ToldReader::read(const toml::table& root) const {
  ToldSettings settings;
  if (const auto* rig = part(root, "rig")) {
    check_keys(*rig, {"file", "truth", "error"}, "[rig]");
    if (const auto* node = rig->get("file")) settings.file = file_name(*node, "rig.file");
    if (const auto* node = rig->get("truth")) settings.truth = file_name(*node, "rig.truth");
    if (const auto* node = rig->get("error")) {
      const std::string word = text(*node, "rig.error");
      if (word != "drawn" && word != "given") {
        fail(*node, "rig.error is " + in_quotes(word), "use drawn or given");
      }
      if (settings.truth.empty()) {
        fail(*node, "rig.error needs rig.truth: without, the rig is its own truth",
             "name the true rig as rig.truth");
      }
      if (word == "given") settings.error = ToldSettings::Error::given;
    }
  }
  const auto* calibration = part(root, "calibration");
  if (!calibration) return settings;
  check_told_once(root);
  read_calibration(*calibration, settings);
  return settings;
}

void ToldReader::check_complete(const toml::table& root,
                                const std::vector<std::string>& swept) const {
  const auto* rig = part(root, "rig");
  if (!rig) return;
  const auto is_swept = [&](const std::string& start) {
    return std::any_of(swept.begin(), swept.end(),
                       [&](const std::string& key) { return key.rfind(start, 0) == 0; });
  };
  if (rig->contains("file") || is_swept("rig.file")) return;
  if (!rig->contains("truth")) required(*rig, "file", "[rig]");
  if (root.contains("calibration") || is_swept("calibration.")) return;
  fail(*rig->get("truth"), "rig.truth is given, and nothing that the estimator is told",
       "give rig.file as well, or [calibration]");
}

std::map<std::string, std::string> settings_of(const ToldSettings& told) {
  std::map<std::string, std::string> all;
  if (!told.truth.empty()) all["rig.truth"] = told.truth;
  if (!told.truth.empty() && !told.calibration) {
    all["rig.file"] = told.file;
    all["rig.error"] = told.error == ToldSettings::Error::given ? "given" : "drawn";
  }
  if (!told.calibration) return all;
  const FreshCalibrationOptions& c = *told.calibration;
  all["calibration.views"] = fmt::format("{}", c.views);
  if (!told.model.empty()) all["calibration.model"] = told.model;
  if (told.observations.empty()) {
    all["calibration.pixel_sigma_px"] = fmt::format("{}", c.pixel_sigma_px);
    all["calibration.distance_m"] = fmt::format("{}", c.distance_m);
    all["calibration.tilt_deg"] = fmt::format("{}", c.tilt_rad / rad_per_deg);
  } else {
    all["calibration.observations"] = told.observations;
  }
  all["calibration.board"] = fmt::format("{}x{}", c.board.columns, c.board.rows);
  all["calibration.square_m"] = fmt::format("{}", c.board.square_m);
  return all;
}

std::map<std::string, std::string> shown_settings_of(const ToldSettings& told) {
  std::map<std::string, std::string> all = settings_of(told);
  if (told.observations.ends_with(".json")) {
    all.erase("calibration.board");
    all.erase("calibration.square_m");
  }
  return all;
}

bool names_a_file(const std::string& key) {
  return key == "world.file" || key == "rig.truth" || key == "rig.file" ||
         key == "calibration.observations";
}

}  // namespace vernier::sim::internal
