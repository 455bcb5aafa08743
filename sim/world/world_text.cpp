// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "sim/world.h"
#include "sim/world/world_check.h"
#include "sim/world_file.h"

namespace vernier::sim {

using namespace internal;
using namespace vernier::internal;

namespace {

constexpr double steps_per_unit =
    1e4;  ///< a tenth of a millimetre, or a ten-thousandth of a degree
constexpr double largest = 1e9;

double rounded(double value) { return std::round(value * steps_per_unit) / steps_per_unit; }

template <int N>
Eigen::Matrix<double, N, 1> rounded(const Eigen::Matrix<double, N, 1>& value) {
  return value.unaryExpr([](double v) { return rounded(v); });
}

FeatureSet rounded(const FeatureSet& features) {
  FeatureSet result = features;
  for (auto& [a, b] : result.segments_m) {
    a = rounded<3>(a);
    b = rounded<3>(b);
  }
  for (auto& corner : result.corners_m) corner = rounded<3>(corner);
  for (auto& polygon : result.surfaces_m) {
    for (auto& point : polygon) point = rounded<3>(point);
  }
  return result;
}

// Rounds as the text does, so that the checks apply to the values of the file.
WorldDescription rounded(const WorldDescription& description) {
  WorldDescription result = description;
  for (auto& entry : result.templates) entry.features = rounded(entry.features);
  for (auto& instance : result.instances) instance.at_m = rounded<3>(instance.at_m);
  result.loose = rounded(result.loose);
  for (auto& leg : result.route) {
    for (auto& point : leg.points_m) point = rounded<2>(point);
  }
  return result;
}

// Integer arithmetic: the bytes do not depend on the locale or printf.
std::string number(double value) {
  if (!(std::abs(value) < largest)) {
    throw Error("world", "a number exceeds 1e9 or is not finite", "check the description");
  }
  const std::int64_t steps = std::llround(value * steps_per_unit);
  const std::int64_t size = steps < 0 ? -steps : steps;
  std::string text = fmt::format("{}{}.{:04}", steps < 0 ? "-" : "", size / 10000, size % 10000);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

template <typename Vector>
std::string numbers(const Vector& values) {
  std::string text;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    text += (i ? ", " : "") + number(values[i]);
  }
  return text;
}

std::string quoted(const std::string& text) {
  static constexpr char hex[] = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      result += std::string("\\u00") + hex[byte >> 4] + hex[byte & 15];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

// One entry per line, so that the line number of an error identifies the feature.
template <typename Entries, typename Format>
void append_list(const char* key, const Entries& entries, const Format& format, std::string& text) {
  if (entries.empty()) return;
  text += std::string(key) + " = [\n";
  for (const auto& entry : entries) text += "  [" + format(entry) + "],\n";
  text += "]\n";
}

template <typename Points>
std::string bracketed(const Points& points) {
  std::string text;
  for (const auto& point : points) text += (text.empty() ? "[" : ", [") + numbers(point) + "]";
  return text;
}

void append_features(const FeatureSet& features, std::string& text) {
  append_list(
      "segments", features.segments_m,
      [](const auto& ends) { return numbers(ends.first) + ", " + numbers(ends.second); }, text);
  append_list(
      "surfaces", features.surfaces_m, [](const auto& polygon) { return bracketed(polygon); },
      text);
  append_list(
      "corners", features.corners_m, [](const auto& corner) { return numbers(corner); }, text);
}

void append_instance(const WorldInstance& instance, std::string& text) {
  text += "\n[[instance]]\ntemplate = " + quoted(instance.template_name) + "\nat_m = [" +
          numbers(instance.at_m) + "]\n";
  const std::string yaw_deg = number(instance.yaw_rad * (180 / std::numbers::pi));
  if (yaw_deg != "0") text += "yaw_deg = " + yaw_deg + "\n";
}

void append_view_set(const ViewSet& set, std::string& text) {
  text += "\n[[view_dependency]]\nat_m = [" + numbers(Eigen::Vector2d(set.at.x_m, set.at.y_m)) +
          "]\nheading_deg = " + number(set.at.heading_rad * (180 / std::numbers::pi)) +
          "\nsegments = [";
  for (std::size_t i = 0; i < set.segments.size(); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(set.segments[i]);
  }
  text += "]\n";
}

}  // namespace

std::string format_world(const WorldDescription& description) {
  const WorldDescription world = rounded(description);
  check_world(world);
  std::string text = "format = \"vernier/world\"\nversion = 1\n";
  if (!world.name.empty()) text += "name = " + quoted(world.name) + "\n";
  for (const auto& entry : world.templates) {
    text += "\n[[template]]\nname = " + quoted(entry.name) + "\n";
    append_features(entry.features, text);
  }
  for (const auto& instance : world.instances) append_instance(instance, text);
  const FeatureSet& loose = world.loose;
  if (!(loose.segments_m.empty() && loose.surfaces_m.empty() && loose.corners_m.empty())) {
    text += "\n[loose]\n";
    append_features(loose, text);
  }
  for (const auto& leg : world.route) {
    text += "\n[[route]]\npoints_m = [" + bracketed(leg.points_m) + "]\n";
  }
  for (const ViewSet& set : world.view_sets) append_view_set(set, text);
  return text;
}

void write_world(const WorldDescription& description, const std::filesystem::path& file) {
  write_atomically(file, format_world(description));
}

}  // namespace vernier::sim
