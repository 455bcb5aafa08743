// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/json_reader.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using Json = nlohmann::ordered_json;
using vernier::internal::parse_json;

void run_json(std::string_view bytes) {
  const auto json = accepted([&] { return parse_json(bytes, "input.json"); });
  if (!json) return;
  require(parse_json(json->dump(), "written") == *json, "values are kept");
}

std::vector<std::string> json_seeds() {
  const Json json{{"a", {1, -2.5, 1e-320, 18446744073709551615U, true, nullptr}},
                  {"b", {{"c", "\"\\\n\u00e9"}, {"d", Json::array()}, {"e", Json::object()}}}};
  return {json.dump(), json.dump(2), json.dump(-1, ' ', true)};
}

const Registered registered_json{{"json", 2000, "json", run_json, json_seeds}};

}  // namespace
}  // namespace vernier::fuzz
