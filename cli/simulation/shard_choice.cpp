// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/shard_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/study/study.h"

namespace vernier::cli {

namespace {

constexpr std::int64_t most_shards = 1'000'000;

/// Digits only, at most 2^63 - 1.
std::optional<std::int64_t> whole_number(std::string_view text) {
  if (text.empty() || text[0] < '0' || text[0] > '9') return std::nullopt;
  if (text.size() > 1 && text[0] == '0') return std::nullopt;  // no octal numbers
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [last, fault] = std::from_chars(text.data(), end, value);
  if (fault != std::errc() || last != end) return std::nullopt;
  return value;
}

[[noreturn]] void refuse_array(const std::string& place, const std::string& fault) {
  throw Error(place, fault, "give --shard i/n, or use an array such as 0-7");
}

/// A variable of the array; nothing if it is not set.
std::optional<std::int64_t> array_variable(const std::string& name) {
  const char* text = std::getenv(name.c_str());
  if (!text) return std::nullopt;
  const std::optional<std::int64_t> value = whole_number(text);
  if (!value) {
    refuse_array(name, in_quotes(text) + " is not a whole number");
  }
  return value;
}

Shard slurm_shard() {
  const std::string prefix = "SLURM_ARRAY_TASK_", id_name = prefix + "ID";
  const auto id = array_variable(id_name), count = array_variable(prefix + "COUNT"),
             low = array_variable(prefix + "MIN"), high = array_variable(prefix + "MAX"),
             stride = array_variable(prefix + "STEP");
  if (!id) {
    if (count) refuse_array(id_name, "is not set, but " + prefix + "COUNT is");
    return {};
  }
  if (!count) refuse_array(prefix + "COUNT", "is not set, but " + id_name + " is");
  const std::int64_t first = low.value_or(0), step = stride.value_or(1);
  if (*count < 1 || *count > most_shards) {
    refuse_array(prefix + "COUNT", fmt::format("{} is not 1 to {}", *count, most_shards));
  }
  if (step < 1) refuse_array(prefix + "STEP", fmt::format("{} is not 1 or more", step));
  const auto is_in_step = [&](std::int64_t task) { return (task - first) % step == 0; };
  if (high && (*high < first || !is_in_step(*high) || (*high - first) / step != *count - 1)) {
    refuse_array(prefix + "COUNT", fmt::format("{} tasks are not {} to {} in steps of {}", *count,
                                               first, *high, step));
  }
  if (*id < first || !is_in_step(*id) || (*id - first) / step >= *count) {
    refuse_array(id_name, fmt::format("{} is not one of {} tasks from {} in steps of {}", *id,
                                      *count, first, step));
  }
  return {static_cast<int>((*id - first) / step), static_cast<int>(*count)};
}

}  // namespace

Shard shard_choice(const std::string& text) {
  if (text.empty()) return slurm_shard();
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto index = whole_number(std::string_view(text).substr(0, slash));
  const auto count = whole_number(std::string_view(text).substr(std::min(slash + 1, text.size())));
  if (!index || !count || *count < 1 || *count > most_shards || *index >= *count) {
    throw Error("--shard",
                fmt::format("{} is not i/n with 0 <= i < n <= {}", in_quotes(text), most_shards),
                "use the form 0/4");
  }
  return {static_cast<int>(*index), static_cast<int>(*count)};
}

}  // namespace vernier::cli
