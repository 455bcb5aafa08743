// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/python_literal.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

void run_python_literal(std::string_view bytes) {
  const auto literal =
      accepted([&] { return vernier::internal::parse_python_literal(bytes, "input"); });
  if (!literal) return;
  for (const auto& [key, value] : literal->entries) {
    require(literal->find(key) == &value, "every key of a dictionary finds its value");
  }
}

/// As NumPy and mrcal write them.
std::vector<std::string> python_literal_seeds() {
  return {"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }",
          "{ 'a': [1, 2.5e-3, -inf], # comment\n  'b': b'x\\n', \"c\": None, 'd': ((1,), ()) }"};
}

const Registered registered_python_literal{
    {"python_literal", 1000, "mrcal", run_python_literal, python_literal_seeds}};

}  // namespace
}  // namespace vernier::fuzz
