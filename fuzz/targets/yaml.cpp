// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/yaml_reader.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using vernier::internal::parse_yaml;
using vernier::internal::YamlValue;

void require_found(const YamlValue& value) {
  for (const auto& [key, entry] : value.entries) {
    require(value.find(key) == &entry, "every key of a map finds its value");
    require_found(entry);
  }
  for (const YamlValue& item : value.items) require_found(item);
}

void run_yaml(std::string_view bytes) {
  const auto value = accepted([&] { return parse_yaml(bytes, "input.yaml"); });
  if (value) require_found(*value);
}

/// Nothing here writes YAML of every kind.
std::vector<std::string> yaml_seeds() {
  return {"%YAML:1.0\n---\na: !!opencv-matrix\n  rows: 1\n  data: [ 1., -2.5e-3 ]\n",
          "a: {b: 'c''d', \"e\\n\": [~, null, true]}\nf:\n  - - 1\n    - 2\n  - |\n    text\n"
          "g: >-\n  folded\n  text\n# comment\n"};
}

const Registered registered_yaml{{"yaml", 2000, "yaml", run_yaml, yaml_seeds}};

}  // namespace
}  // namespace vernier::fuzz
