// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace vernier::internal {

/// The number stored in the bytes at `at`, in either byte order.
template <typename Value>
Value number_at(std::string_view bytes, std::size_t at, bool big_endian) {
  std::array<char, sizeof(Value)> own;
  std::memcpy(own.data(), bytes.data() + at, sizeof(Value));
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(own.begin(), own.end());
  }
  return std::bit_cast<Value>(own);
}

/// Appends the bytes of a number in either byte order.
template <typename Value>
void append_number(std::string& bytes, Value value, bool big_endian) {
  auto own = std::bit_cast<std::array<char, sizeof(Value)>>(value);
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(own.begin(), own.end());
  }
  bytes.append(own.data(), own.size());
}

}  // namespace vernier::internal
