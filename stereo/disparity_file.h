// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

namespace vernier::stereo {

/// A dense disparity map u_left − u_right of the left image, in pixels, row by row from the top;
/// not a number where it is not known.
struct DisparityMap {
  int width_px = 0, height_px = 0;
  std::vector<float> values;

  float operator()(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)];
  }
  bool known(int x, int y) const { return (*this)(x, y) == (*this)(x, y); }
};

struct DisparityFileOptions {
  double scale = 1;  ///< values a pixel, in every format: disparity = value / scale (KITTI: 256)
  std::optional<bool> zero_is_unknown;  ///< unset: in files of whole numbers, not of real ones
  double min_px = -std::numeric_limits<double>::infinity();  ///< smaller ones are unknown
};

/// Reads a disparity map; its content, not its name, says which format it has:
///
///  - PFM of one channel ("Pf"): either order of bytes, rows from the bottom; what is not finite is
///    unknown. The magnitude of its scale is ignored: Middlebury's files hold 1/255 there and
///    pixels nevertheless.
///  - PNG of 8 or 16 bits, grey or with three equal channels, and binary PGM: 0 is unknown.
///  - NumPy's .npy of two dimensions in C order, either order of bytes: real numbers of 4 or 8
///    bytes (what is not finite is unknown) or whole ones of 1 to 8 bytes (0 is unknown). No .npz.
///
/// Throws Error for any other file, one that is cut off or has bytes left over, and a size of 0.
DisparityMap read_disparity(const std::filesystem::path& file,
                            const DisparityFileOptions& options = {});

/// Writes a map as its name ends: .pfm, .npy (both float32: they read back as the same bits;
/// unknown is infinity in the first, not a number in the second), or .png of 16 bits with 256 a
/// pixel as KITTI's (unknown is 0, known disparities below 1/512 px become 1/256 px). Throws Error
/// for other names and, PNG, for disparities below 0 or above 255.99 px.
void write_disparity(const std::filesystem::path& file, const DisparityMap& map);

}  // namespace vernier::stereo
