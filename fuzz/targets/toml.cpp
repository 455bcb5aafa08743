// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/toml_reader.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

void run_toml(std::string_view bytes) {
  accepted([&] {
    const auto table = vernier::internal::parse_toml(bytes, "input.toml");
    return table.size();
  });
}

std::vector<std::string> toml_seeds() {
  return {
      "a.b = [1, -2.5e3, 0x1F, true, inf]\n[t.\"u v\"]\nx = { y = 'z', \"w\" = \"\\u00e9\" }\n"
      "[[list]]\nd = 1979-05-27T07:32:00Z\ns = \"\"\"a\nb\"\"\"\n[[list]]\n# comment\n"};
}

const Registered registered_toml{{"toml", 1000, "toml", run_toml, toml_seeds}};

}  // namespace
}  // namespace vernier::fuzz
