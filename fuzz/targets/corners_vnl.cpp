// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/observations_file.h"
#include "calib/simulated_board.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

const Chessboard corners_board{3, 2, 0.1};
const std::vector<Eigen::Vector2i> corners_size{{640, 480}};

void run_corners_vnl(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "corners.vnl");
  accepted([&] { return count_coarse_corners(file); });
  const auto corners = accepted([&] { return read_corners(file, corners_board, corners_size); });
  if (!corners) return;
  // An image whose camera has no other is not written where it could be read: refused.
  const bool written = accepted([&] {
                         write_corners(*corners, corners_board, file);
                         return true;
                       }).has_value();
  if (written) require_same(*corners, read_corners(file, corners_board, corners_size));
}

std::vector<std::string> corners_vnl_seeds() {
  std::vector<std::string> seeds;
  for (int cameras = 1; cameras <= 3; ++cameras) {
    const Rig rig = example_rig("radial1", cameras);
    SimulatedBoard board = simulate_board(rig, corners_board, {.frames = 2, .distance_m = 0.8});
    for (BoardView& view : board.observations.views) {
      view.image = rig.cameras[static_cast<std::size_t>(view.camera)].name + "_" +
                   std::to_string(view.frame) + ".png";
    }
    const std::filesystem::path file = input_folder() / "seed.vnl";
    write_corners(board.observations, corners_board, file);
    seeds.push_back(file_bytes(file));
    board.observations.views[0].ids.resize(4);
    board.observations.views[0].pixels_px.resize(4);
    write_corners(board.observations, corners_board, file);
    seeds.push_back(file_bytes(file));
  }
  return seeds;
}

const Registered registered_corners_vnl{
    {"corners_vnl", 4000, "columns", run_corners_vnl, corners_vnl_seeds}};

}  // namespace
}  // namespace vernier::fuzz
