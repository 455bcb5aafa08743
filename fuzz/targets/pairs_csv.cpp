// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/pairs_file.h"
#include "calib/pair_observations.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

using vernier::internal::read_pairs;
using vernier::internal::write_pairs;

void run_pairs_csv(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "pairs.csv");
  const auto pairs = accepted([&] { return read_pairs(file); });
  if (!pairs) return;
  accepted([&] {
    check_pairs(*pairs, example_rig("radial1", 2), "pairs.csv");
    return true;
  });
  write_pairs(*pairs, file);
  require_same(*pairs, read_pairs(file));
}

std::vector<std::string> pairs_csv_seeds() {
  PairObservations pairs;
  for (int i = 0; i < 9; ++i) {
    add_pair(pairs, i / 4, {100 + i / 3.0, 50.0 + 20 * i, 80 + i / 7.0, 50.25 + 20 * i},
             0.1 + 0.05 * (i % 3));
  }
  const std::filesystem::path file = input_folder() / "seed.csv";
  write_pairs(pairs, file);
  return {file_bytes(file)};
}

const Registered registered_pairs_csv{
    {"pairs_csv", 4000, "columns", run_pairs_csv, pairs_csv_seeds}};

}  // namespace
}  // namespace vernier::fuzz
