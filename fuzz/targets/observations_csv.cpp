// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board_observations.h"
#include "calib/observations_file.h"
#include "calib/simulated_board.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

const std::vector<Eigen::Vector2i> observations_size{{640, 480}};

void run_observations_csv(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "observations.csv");
  const auto observations = accepted([&] { return read_observations(file, observations_size); });
  if (!observations) return;
  write_observations(*observations, file);
  require_same(*observations, read_observations(file, observations_size));
}

std::vector<std::string> observations_csv_seeds() {
  std::vector<std::string> seeds;
  for (int cameras = 1; cameras <= 3; ++cameras) {
    const SimulatedBoard board = simulate_board(example_rig("radial1", cameras), {3, 2, 0.1},
                                                {.frames = cameras, .distance_m = 0.8});
    const std::filesystem::path file = input_folder() / "seed.csv";
    write_observations(board.observations, file);
    seeds.push_back(file_bytes(file));
  }
  return seeds;
}

const Registered registered_observations_csv{
    {"observations_csv", 4000, "columns", run_observations_csv, observations_csv_seeds}};

}  // namespace
}  // namespace vernier::fuzz
