// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/shown_text.h"

#include <fmt/format.h>

#include "calib/base/utf8.h"

namespace vernier::internal {
namespace {

constexpr std::size_t most_quoted = 60;
constexpr std::string_view ellipsis = "…";

/// Whether a terminal would obey a character instead of showing it: control characters (C0, DEL,
/// C1), line separators, and marks of the direction of writing.
bool acts(std::string_view c) {
  if (c.size() == 1) return static_cast<unsigned char>(c[0]) < 0x20U || c[0] == 0x7f;
  if (c.size() == 2) return c[0] == '\xC2' && static_cast<unsigned char>(c[1]) < 0xA0U;
  const auto third = static_cast<unsigned char>(c.size() == 3 ? c[2] : '\0');
  if (c.substr(0, 2) == "\xE2\x80")
    return third == 0x8E || third == 0x8F || (third >= 0xA8 && third <= 0xAE);
  return c.substr(0, 2) == "\xE2\x81" && third >= 0xA6 && third <= 0xA9;
}

/// Appends the character at `at` as it is shown; returns the bytes it takes in the text.
std::size_t append_shown(std::string_view text, std::size_t at, std::string& shown) {
  const std::size_t length = utf8_length(text, at);
  const std::string_view bytes = text.substr(at, length == 0 ? 1 : length);
  if (length > 0 && !acts(bytes)) {
    shown += bytes;
  } else {
    for (const char byte : bytes) {
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
  }
  return bytes.size();
}

}  // namespace

std::string shortened(std::string_view text) {
  std::string shown;
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size(); ++count) {
    if (count == most_quoted) return shown + std::string(ellipsis);
    at += append_shown(text, at, shown);
  }
  return shown;
}

std::string in_quotes(std::string_view text) { return '"' + shortened(text) + '"'; }

std::string counted(std::int64_t count, std::string_view noun) {
  return std::to_string(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

std::string alternatives(std::span<const std::string> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
  }
  return text;
}

std::string printable(std::string_view message, std::size_t most) {
  // Half of the line is its beginning, half its end: the file is named first, the remedy last.
  const std::size_t half = most / 2;
  std::string begin, end;
  std::size_t at = 0;
  while (at < message.size() && begin.size() < half) at += append_shown(message, at, begin);
  // No character is longer when shown than four times its bytes.
  const std::size_t rest = message.size() - at;
  if (rest > most) {
    begin += ellipsis;
    at = message.size() - half;
    while (at < message.size() && utf8_length(message, at) == 0) ++at;
  }
  while (at < message.size()) at += append_shown(message, at, end);
  if (begin.size() + end.size() > most) {
    std::size_t cut = end.size() - (most > begin.size() ? most - begin.size() : 0);
    while (cut < end.size() && utf8_length(end, cut) == 0) ++cut;
    if (rest <= most) begin += ellipsis;
    end.erase(0, cut);
  }
  return begin + end;
}

}  // namespace vernier::internal
