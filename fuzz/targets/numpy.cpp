// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/numpy_array.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using vernier::internal::numpy_bytes;
using vernier::internal::NumpyArray;
using vernier::internal::parse_numpy;

void run_numpy(std::string_view bytes) {
  const auto array = accepted([&] { return parse_numpy(bytes, "map.npy"); });
  if (!array) return;
  require(array->values.size() == array->rows * array->columns, "an array has all its values");
  const std::vector<float> values(array->values.begin(), array->values.end());
  const NumpyArray again = parse_numpy(
      numpy_bytes(values, static_cast<int>(array->rows), static_cast<int>(array->columns)),
      "written");
  require(again.rows == array->rows && again.columns == array->columns, "the shape is kept");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    require(again.values[i] == value || value != value, "values are kept");
  }
}

/// Float32 by the writer; the other types and versions with its header changed.
std::vector<std::string> numpy_seeds() {
  std::vector<std::string> seeds{numpy_bytes({1, 2.5F, -3, 0, 1e30F, 0.1F}, 2, 3),
                                 numpy_bytes({7}, 1, 1)};
  for (const char* type : {">f4", "<i4", "<u4", ">i4"}) {
    std::string bytes = seeds[0];
    bytes.replace(bytes.find("<f4"), 3, type);
    seeds.push_back(bytes);
  }
  return seeds;
}

const Registered registered_numpy{{"numpy", 1000, "numpy", run_numpy, numpy_seeds}};

}  // namespace
}  // namespace vernier::fuzz
