// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/store_rows.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/fingerprint.h"
#include "calib/base/json_whole.h"
#include "calib/base/utf8.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

namespace {

using TrialJson = nlohmann::json;

/// Older stores have no number of looks and no probability. Trials of other systems than localisers
/// have fields of their own.
constexpr std::size_t fields_of_a_trial = 17, fields_of_old_trials = 15,
                      fields_of_other_systems = 10;

TrialJson number_or_null(double value) {
  return std::isfinite(value) ? TrialJson(value) : TrialJson(nullptr);
}

TrialJson pose_json(const Pose2D& pose) { return {pose.x_m, pose.y_m, pose.heading_rad}; }

/// Reads the fields of one trial, in order, each in its range.
class TrialRow {
 public:
  TrialRow(const TrialJson& row, const std::string& place) : row_(row), place_(place) {
    if (!row.is_array() || (row.size() != fields_of_a_trial && row.size() != fields_of_old_trials &&
                            row.size() != fields_of_other_systems)) {
      fail("a trial is no list of 17, 15 or 10 fields");
    }
  }

  std::int64_t whole(std::int64_t low, std::int64_t high) {
    const TrialJson& field = next();
    if (!field.is_number_integer()) fail("a field is no whole number");
    const auto value = json_whole<std::int64_t>(field);
    if (!value || *value < low || *value > high) fail(beyond);
    return *value;
  }
  int count() { return static_cast<int>(whole(0, std::numeric_limits<int>::max())); }
  double real() { return real(next()); }
  bool is_old() const { return row_.size() == fields_of_old_trials; }
  bool is_of_other_system() const { return row_.size() == fields_of_other_systems; }
  double probability() {
    const double value = real();
    if (value < 0 || value > 1) fail(beyond);
    return value;
  }
  double time_ms() {
    const double value = real();
    if (value < 0) fail(beyond);
    return value;
  }
  /// Null, read as not a number, unless `needed`.
  double error(bool needed) {
    const TrialJson& field = next();
    if (field.is_null() && !needed) return std::numeric_limits<double>::quiet_NaN();
    return real(field);
  }
  /// The largest error of a success.
  double limit() {
    const double value = real();
    if (!(value > 0)) fail(beyond);
    return value;
  }
  /// Of numbers, null for those that are unknown.
  std::vector<double> measured() {
    const TrialJson& field = next();
    if (!field.is_array()) fail("what was measured is no list");
    std::vector<double> values;
    for (const TrialJson& value : field) {
      values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : real(value));
    }
    return values;
  }
  std::string text() {
    const TrialJson& field = next();
    if (!field.is_string() || field.get_ref<const std::string&>().size() > longest_reason) {
      fail(fmt::format("a reason is no text of {} bytes at most", longest_reason));
    }
    return field;
  }
  Pose2D pose() {
    const TrialJson& field = next();
    if (!field.is_array() || field.size() != 3) fail("a pose is no list of 3 numbers");
    return {real(field[0]), real(field[1]), real(field[2])};
  }

 private:
  static constexpr const char* beyond = "a field is out of range";

  const TrialJson& next() { return row_[at_++]; }
  double real(const TrialJson& field) const {
    const double value =
        field.is_number() ? field.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(value)) fail("a field is no number");
    return value;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(place_, "is damaged: " + why, "");
  }

  const TrialJson& row_;
  const std::string& place_;
  std::size_t at_ = 0;
};

TrialResult trial_of(const TrialJson& json, const std::string& place) {
  TrialRow row(json, place);
  TrialResult t;
  t.trial = static_cast<std::uint32_t>(row.whole(0, std::numeric_limits<std::uint32_t>::max()));
  t.status = static_cast<LocalisationStatus>(
      row.whole(0, static_cast<std::int64_t>(LocalisationStatus::too_few_corners)));
  t.truth = row.pose();
  if (row.is_of_other_system()) {
    t.answer = row.pose();
    t.error = row.error(t.answered());
    t.limit = row.limit();
    t.measured = row.measured();
    t.cpu_ms = row.time_ms();
    t.wall_ms = row.time_ms();
    t.failure = row.text();
    return t;
  }
  t.answer = row.pose();
  t.node = row.pose();
  t.error = row.error(t.answered());
  t.node_error_m = row.error(t.answered());
  t.heading_error_rad = row.error(t.answered());
  t.lines = row.count();
  t.score = row.real();
  t.runner_up = row.real();
  t.corners = row.count();
  t.corner_mismatches = row.count();
  t.cpu_ms = row.time_ms();
  t.wall_ms = row.time_ms();
  if (row.is_old()) return t;
  t.looks = row.count();
  t.probability = row.probability();
  return t;
}

/// As much of a reason as is stored: whole characters.
std::string shown_failure(const std::string& failure) {
  const std::string start = failure.substr(0, longest_reason);
  return start.substr(0, first_bad_utf8(start));
}

TrialJson other_trial_json(const TrialResult& t) {
  TrialJson measured = TrialJson::array();
  for (const double value : *t.measured) measured.push_back(number_or_null(value));
  return {t.trial,
          static_cast<int>(t.status),
          pose_json(t.truth),
          pose_json(t.answer),
          number_or_null(t.error),
          t.limit,
          measured,
          t.cpu_ms,
          t.wall_ms,
          shown_failure(t.failure)};
}

}  // namespace

std::array<int, 3> row_counts(const std::vector<TrialResult>& trials) {
  std::array<int, 3> counted{static_cast<int>(trials.size()), 0, 0};
  for (const TrialResult& trial : trials) {
    counted[1] += trial.answered();
    counted[2] += trial.success();
  }
  return counted;
}

BlockRow block_row(std::string cell, int block, const std::vector<TrialResult>& trials) {
  return {std::move(cell), block, row_counts(trials), trials_text(trials)};
}

std::string trials_text(const std::vector<TrialResult>& trials) {
  TrialJson rows = TrialJson::array();
  for (const TrialResult& t : trials) {
    if (t.measured) {
      rows.push_back(other_trial_json(t));
      continue;
    }
    rows.push_back({t.trial, static_cast<int>(t.status), pose_json(t.truth), pose_json(t.answer),
                    pose_json(t.node), number_or_null(t.error), number_or_null(t.node_error_m),
                    number_or_null(t.heading_error_rad), t.lines, t.score, t.runner_up, t.corners,
                    t.corner_mismatches, t.cpu_ms, t.wall_ms, t.looks, t.probability});
  }
  return rows.dump();
}

std::vector<TrialResult> parse_trials(const std::string& text, const std::string& place) {
  TrialJson rows;
  try {
    rows = TrialJson::parse(text);
  } catch (const TrialJson::exception&) {
    throw Error(place, "is damaged: it is no JSON", "");
  }
  if (!rows.is_array() || rows.empty()) throw Error(place, "is damaged: it has no trials", "");
  std::vector<TrialResult> trials;
  trials.reserve(rows.size());
  for (const TrialJson& row : rows) {
    trials.push_back(trial_of(row, place));
    if (trials.back().trial != trials.front().trial + (trials.size() - 1)) {
      throw Error(place, "is damaged: its trials do not follow one another", "");
    }
  }
  return trials;
}

std::string row_checksum(const std::vector<std::string>& fields) {
  std::string all;
  for (const std::string& field : fields) all += std::to_string(field.size()) + ":" + field;
  return fingerprint(all);
}

}  // namespace vernier::sim::internal
