// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Peak memory of one solve: mrcal_memory vernier|resolver|mrcal FRAMES. Prints one line: solver,
// frames, MiB before the solve, additional MiB at the peak. One run per process
// (bench/memory_vs_mrcal.sh).
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "bench/mrcal_problem_set.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/resolve.h"

namespace {

double status_mib(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key + ":")) return std::atof(line.c_str() + key.size() + 1) / 1024;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace vernier;
  using namespace vernier::internal;
  if (argc != 3) return 2;
  const std::string solver = argv[1];
  const bench::StereoProblem p = bench::stereo_problem(std::atoi(argv[2]));
  std::ofstream("/proc/self/clear_refs") << 5;  // reset the peak counter
  const double before = status_mib("VmRSS");
  if (solver == "vernier") minimise_reprojection(p.observations, p.start);
  if (solver == "resolver") Resolver(p.observations, p.start).resolve();
  if (solver == "mrcal") mrcal_optimise_only(p.observations, p.start);
  fmt::print("{} {} {:.1f} {:.1f}\n", solver, argv[2], before, status_mib("VmHWM") - before);
}
