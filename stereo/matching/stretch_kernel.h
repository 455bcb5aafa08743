// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stereo/matching/stretch_filter.h"

namespace vernier::stereo::internal {

/// Sample positions of a block in the right image for one stretch and one shear, in integer
/// sixteenths of a pixel, so that all sums are integers. Tables are by column of the block, then by
/// row, with `row_stride` entries per column.
struct StretchWarp {
  /// `row_pairs` is the length of a row of the right image in pairs (PairedRows).
  StretchWarp(double stretch, double shear, int width, int rows, int row_pairs);

  static constexpr int steps = 16;  // per pixel
  static int row_stride(int rows) { return (rows + 15) / 16 * 16; }

  double stretch, shear;
  int width, rows;
  std::vector<int> place;               ///< pixel left of a sample, relative to the right centre
  std::vector<std::int16_t> near, far;  ///< weights of that pixel and the next

  /// The transposed form: left pixels are distributed over right pixels instead of sampling the
  /// right image. It gives the same sum with fewer products where right blocks are narrow. In pairs
  /// of right pixels:
  bool spread = false;
  int pairs = 0;
  int first_offset = 0;   ///< of the first pair's first pixel from the right centre
  std::vector<int> jump;  ///< from the right centre in the block's top row to a pair, in pairs
};

/// Rows in which every pixel is followed by its right neighbour: (v_0, v_1), (v_1, v_2), …
class PairedRows {
 public:
  explicit PairedRows(const FilteredImage& image);
  std::size_t row_pairs() const { return stride_ / 2; }
  std::size_t plane_pairs() const { return row_pairs() * static_cast<std::size_t>(rows_); }
  const std::int16_t* row(int plane, int y) const {
    return values_.data() + static_cast<std::size_t>(plane * rows_ + y + margin_y_) * stride_ +
           2 * static_cast<std::size_t>(margin_x_);
  }

 private:
  int rows_, margin_x_, margin_y_;
  std::size_t stride_;
  std::vector<std::int16_t> values_;
};

/// Adds a row's sums and sums of squares of the samples around each right centre from 0 to n − 1,
/// in sixteenths, to `sums` and `squares`. Writes up to 15 entries more. `row` is relative to the
/// block.
void add_row_sums(const std::int16_t* pairs,
                  const StretchWarp& warp,
                  int row,
                  int n,
                  float* sums,
                  float* squares);

/// The rows of a block window, as add_row_sums leaves them.
struct WindowRows {
  std::vector<const float*> sums, squares;
};

/// Sums over all rows around the first n right centres, and the inverse root of the centred sum of
/// squares of `count` samples. Writes up to 15 entries more.
void window_sums(const WindowRows& rows, int n, float count, float* sums, float* inverse);

/// A left block's pixels (by column and row, as the warp's tables) as weights of the pairs.
void block_weights(const StretchWarp& warp, const std::int16_t* left, std::int32_t* weights);

/// A block and a range of right centres.
struct BlockSearch {
  const StretchWarp& warp;
  const PairedRows& right;
  int planes;
  int top;                      ///< of the block
  const std::int32_t* weights;  ///< of all planes
  float mean;                   ///< of the left block
  int first, n;                 ///< right centres
  const float *sums, *inverse;  ///< of the right image, by right centre
};

/// (Σ L R − mean Σ R) · inverse for the right centres, into `scores`; writes up to 31 entries more.
/// Returns the largest of the n.
float block_scores(const BlockSearch& search, float* scores);

}  // namespace vernier::stereo::internal
