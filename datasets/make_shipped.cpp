// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Writes the two frozen inputs of every study, worlds/workshop.world.toml and
// rigs/nominal.rig.json, to a folder. tests/datasets/ checks that the shipped files equal this
// program's output, and their sha256: neither may be tuned to a method under test.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "calib/rig_file.h"
#include "datasets/shipped.h"
#include "sim/world_file.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_shipped FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder / "worlds");
    std::filesystem::create_directories(folder / "rigs");
    vernier::sim::write_world(vernier::datasets::workshop(),
                              folder / "worlds" / "workshop.world.toml");
    vernier::write_rig(vernier::datasets::nominal(), folder / "rigs" / "nominal.rig.json");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_shipped: %s\n", error.what());
    return 1;
  }
  return 0;
}
