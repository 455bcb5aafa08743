// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace vernier::stereo {

/// A dense disparity map u_left − u_right of the left image, in pixels, row-major from the top; NaN
/// where unknown.
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
  /// File values per pixel of disparity, in every format: disparity = value / scale (KITTI: 256).
  double scale = 1;
  /// Default: true for integer formats, false for floating-point ones.
  std::optional<bool> zero_is_unknown;
  /// A further value of the file that means unknown; NaN: none.
  double unknown = std::numeric_limits<double>::quiet_NaN();
  /// Smaller disparities are set to unknown.
  double min_px = -std::numeric_limits<double>::infinity();
};

/// Reads a disparity map; the format is detected from the content, not the name:
///
///  - PFM with one channel ("Pf"): either byte order, rows from the bottom; non-finite values are
///    unknown. The magnitude of its scale is ignored: Middlebury files store 1/255 there although
///    their values are pixels.
///  - PNG of 8 or 16 bits, grey or with three equal channels, and binary PGM: 0 is unknown.
///  - NumPy .npy with two dimensions in C order, either byte order: floats of 4 or 8 bytes
///    (non-finite is unknown) or integers of 1 to 8 bytes (0 is unknown). .npz is not supported.
///
/// Throws Error for any other file, truncated files, trailing bytes, and a size of 0.
DisparityMap read_disparity(const std::filesystem::path& file,
                            const DisparityFileOptions& options = {});

/// Writes a map in the format of the file's extension: .pfm and .npy (both float32, so reading them
/// back gives the same bits; unknown is infinity in .pfm and NaN in .npy), or 16-bit .png with
/// KITTI's 256 per pixel (unknown is 0; known disparities below 1/512 px become 1/256 px). Throws
/// Error for other extensions and, for PNG, for disparities below 0 or above 255.99 px.
void write_disparity(const std::filesystem::path& file, const DisparityMap& map);

/// The content of the .pfm file that write_disparity makes. Throws Error for a map without values.
std::string disparity_pfm(const DisparityMap& map);

}  // namespace vernier::stereo
