// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/utf8.h"

#include <fmt/format.h>

#include <algorithm>

#include "calib/error.h"

namespace vernier::internal {

std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0U;
  };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const unsigned first = byte(0);
  if (at >= text.size()) return 0;
  if (first < 0x80U) return 1;
  if (first < 0xC2U || first > 0xF4U || !follows(1)) return 0;
  if (first < 0xE0U) return 2;
  if (!follows(2)) return 0;
  if (first < 0xF0U) {
    const bool overlong = first == 0xE0U && byte(1) < 0xA0U;
    const bool surrogate = first == 0xEDU && byte(1) > 0x9FU;
    return overlong || surrogate ? 0 : 3;
  }
  const bool overlong = first == 0xF0U && byte(1) < 0x90U;
  const bool beyond = first == 0xF4U && byte(1) > 0x8FU;
  return !follows(3) || overlong || beyond ? 0 : 4;
}

std::size_t first_bad_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    if (static_cast<unsigned char>(text[at]) < 0x80U) {
      ++at;
      continue;
    }
    const std::size_t length = utf8_length(text, at);
    if (length == 0) return at;
    at += length;
  }
  return std::string_view::npos;
}

std::size_t line_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

void check_text(std::string_view text,
                const std::string& place,
                const std::string& what,
                std::size_t most_bytes) {
  if (text.size() > most_bytes) {
    throw Error(place,
                fmt::format("is {:.1f} MB long, and {} may have {} MB",
                            static_cast<double>(text.size()) / 1e6, what, most_bytes / 1'000'000),
                "split it or name another file");
  }
  const auto at = [&](std::size_t byte) {
    return fmt::format("{}:{}", place, line_of(text, byte));
  };
  if (const std::size_t bad = first_bad_utf8(text); bad != std::string_view::npos) {
    throw Error(at(bad), "is not UTF-8", "save the file as UTF-8, or name another one");
  }
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    throw Error(at(zero), "holds a zero byte", "write it again, or name another file");
  }
}

}  // namespace vernier::internal
