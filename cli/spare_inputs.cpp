// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/spare_inputs.h"

#include "calib/error.h"

namespace vernier::cli {

void spare_inputs(const std::vector<std::filesystem::path>& inputs,
                  const std::filesystem::path& output) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code not_there;
    if (!std::filesystem::equivalent(input, output, not_there)) continue;
    throw Error(output.string(), "is an input, which the output would replace",
                "name another output");
  }
}

}  // namespace vernier::cli
