// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/machine.h"

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <thread>

#include "calib/base/instruction_set.h"
#include "calib/base/shown_text.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {
namespace {

/// As Linux names it; "unknown processor" elsewhere.
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      return printable(line.substr(colon + 2), 100);
    }
  }
  return "unknown processor";
}

}  // namespace

std::string program_and_machine() {
  const unsigned cores = std::thread::hardware_concurrency();
  return fmt::format("vernier {}, {}, {} core{}, {}", VERNIER_VERSION, processor_name(), cores,
                     cores == 1 ? "" : "s", instruction_set());
}

}  // namespace vernier::cli
