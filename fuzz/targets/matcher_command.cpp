// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "stereo/matching/external_matcher.h"

namespace vernier::fuzz {
namespace {

void run_matcher_command(std::string_view bytes) {
  accepted([&] { return stereo::internal::external_matcher(std::string(bytes)).name; });
}

std::vector<std::string> matcher_command_seeds() {
  return {"my_matcher --left {left} --right {right} --max-disparity {most} -o {output}",
          "sh -c '\"$1\" \\'a\\'' sh {left} {right} {least} {output.png}"};
}

const Registered registered_matcher_command{
    {"matcher_command", 300, "command", run_matcher_command, matcher_command_seeds}};

}  // namespace
}  // namespace vernier::fuzz
