// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace vernier::internal {

/// A JSON value as a whole number; std::nullopt if it is none, or not in the range of Whole, where
/// nlohmann's own conversion would cut it off.
template <typename Whole, typename Json>
std::optional<Whole> json_whole(const Json& json) {
  const auto in_range = [](auto number) {
    return std::in_range<Whole>(number) ? std::optional(static_cast<Whole>(number)) : std::nullopt;
  };
  if (!json.is_number_integer()) return std::nullopt;
  return json.is_number_unsigned() ? in_range(json.template get<std::uint64_t>())
                                   : in_range(json.template get<std::int64_t>());
}

}  // namespace vernier::internal
