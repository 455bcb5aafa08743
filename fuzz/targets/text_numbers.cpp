// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/text_lines.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

void run_text_numbers(std::string_view bytes) {
  for (const std::string_view field : split_fields(bytes, " \t,\n")) {
    accepted([&] { return parse_whole(field, "input", "a number"); });
    const auto real = accepted([&] { return parse_real(field, "input", "a number"); });
    require(real.has_value() == to_real(field).has_value(), "both readers accept the same numbers");
    if (!real || *real != *real) continue;
    require(to_real(fmt::format("{}", *real)) == *real, "a number survives writing");
  }
}

std::vector<std::string> text_numbers_seeds() {
  return {fmt::format("{} {} {} {}", 1, -2.5, 1e-320, 1.7976931348623157e308),
          "0.1,+3,1e400,nan,-inf,0x10,1e-400,2147483648,.5,5.,00012,1e5"};
}

const Registered registered_text_numbers{
    {"text_numbers", 400, "columns", run_text_numbers, text_numbers_seeds}};

}  // namespace
}  // namespace vernier::fuzz
