// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::internal {

/// A two-dimensional NumPy array.
struct NumpyArray {
  std::size_t rows = 0, columns = 0;
  bool of_whole_numbers = false;
  std::vector<double> values;  ///< row by row
};

bool is_numpy(std::string_view bytes);

/// Decodes the bytes of a .npy file (NumPy Enhancement Proposal 1), versions 1 to 3. Throws
/// Error(place) unless the array has two dimensions, C order and real or integer values.
NumpyArray parse_numpy(std::string_view bytes, const std::string& place);

/// The head of a .npy file whose description is this dictionary: version 1 has room for 64 KiB,
/// version 3 for 4 GiB of UTF-8. The data begin at a multiple of 64 bytes.
std::string numpy_head(std::string dictionary);

/// The bytes of a .npy file of float32, little-endian.
std::string numpy_bytes(const std::vector<float>& values, int rows, int columns);

}  // namespace vernier::internal
