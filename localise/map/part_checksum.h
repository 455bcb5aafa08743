// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace vernier::localise::internal {

/// The checksum of a part of a map file: FNV-1a over 64 bits, by words of 8 bytes, the last filled
/// up with 0. Against damage, not against intent.
inline std::uint64_t part_checksum(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u ^ bytes.size();
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    sum = (sum ^ word) * 0x100000001b3u;
    sum ^= sum >> 32;
  }
  return sum;
}

}  // namespace vernier::localise::internal
