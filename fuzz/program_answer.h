// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {

/// What `read` makes of an answer of a program, or nothing if it or the line is refused.
template <typename Read>
auto accepted_answer(std::string_view line, const Read& read) {
  return accepted([&] {
    const nlohmann::ordered_json json = vernier::internal::parse_json(line, "answer");
    return read(vernier::internal::JsonNode(json, "answer:"));
  });
}

}  // namespace vernier::fuzz
