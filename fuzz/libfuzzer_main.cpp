// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>

#include "fuzz/fuzz_target.h"

/// One target under libFuzzer. All are in one program, since a link takes longer than all of their
/// code: VERNIER_FUZZ_TARGET names the one to run. VERNIER_FUZZ_CPU_S ends the run after that much
/// CPU time, which libFuzzer's own limits do not count.
namespace {

using vernier::fuzz::Target;

Target chosen{};
double cpu_limit_s = 0;

double cpu_time_s() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void list_targets() {
  for (const Target& target : vernier::fuzz::targets()) {
    std::printf("%s %zu %s\n", target.name, target.max_bytes, target.dictionary);
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("VERNIER_FUZZ_TARGET");
  const char* limit = std::getenv("VERNIER_FUZZ_CPU_S");
  for (const Target& target : vernier::fuzz::targets()) {
    if (name != nullptr && std::string(target.name) == name) chosen = target;
  }
  if (chosen.run == nullptr) {
    list_targets();
    std::exit(name == nullptr ? 0 : 2);
  }
  if (limit != nullptr) cpu_limit_s = std::strtod(limit, nullptr);
  cv::setNumThreads(0);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // libFuzzer ends after this input, with its statistics.
  if (cpu_limit_s > 0 && cpu_time_s() > cpu_limit_s) std::raise(SIGUSR1);
  chosen.run({reinterpret_cast<const char*>(data), size});
  return 0;
}
