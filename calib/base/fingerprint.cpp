// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/fingerprint.h"

#include <fmt/format.h>
#include <cstdint>

namespace vernier::internal {

std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const unsigned char byte : text) hash = (hash ^ byte) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

}  // namespace vernier::internal
