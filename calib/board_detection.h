// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"

namespace vernier {

/// Why a corner of a board that was found is not used.
enum class CornerRejection {
  at_border,      ///< too near the image's border for a window around it
  not_crossing,   ///< its surroundings do not look like a crossing of squares: something covers it
  moved_too_far,  ///< refinement left its window, or found nothing to hold on to
  off_neighbours  ///< does not lie where its neighbours put it
};

/// In words, such as "at the image's border".
std::string text_of(CornerRejection refusal);

struct RejectedCorner {
  int id = 0;
  CornerRejection why = CornerRejection::at_border;
};

/// What became of one image.
struct BoardDetection {
  std::filesystem::path image;
  Eigen::Vector2i size_px{0, 0};  ///< 0, 0 where the image cannot be read
  std::vector<int> ids;           ///< index of each corner into target_points; empty: no board
  std::vector<Eigen::Vector2d> corners_px;
  std::vector<RejectedCorner> rejected_corners;  ///< seen, not used
  std::string reason;                            ///< why there is no board, where there is none
  bool goes_on = false;                          ///< the board has more corners than asked for
  int camera = 0;                                ///< index of the pattern it came by
  int frame = 0;                                 ///< by the number in its name
};

/// Its corners that were seen and not used, as "3 corners at the image's border, 1 corner …".
std::string rejected_corners_text(const BoardDetection& image);

/// Finds the corners of a target in an image, then refines each by the gradient's orthogonality
/// (Förstner and Gülch 1987, as OpenCV's cornerSubPix does it) in a window that holds no other edge
/// of the pattern, and refuses corners one by one that this fails for.
///
/// Chessboards: OpenCV's two finders in turn; a board found only in part is refused, and so is one
/// that goes on beyond the corners asked for. Where columns + rows is odd the order of corners is
/// the same in every image: x along rows, y down, the square between the first four corners dark.
/// ChArUco boards and AprilTag grids: OpenCV's marker detector; markers that are not where the
/// board has them are dropped; six corners that span the plane are enough.
///
/// Throws Error for a file that cannot be read, is cut off or is no image, and for a target that
/// cannot be.
BoardDetection detect_board(const std::filesystem::path& image, const BoardTarget& target);

/// Files that match a pattern (shell globbing of the last component), in the order of their
/// names. Throws Error where there are none.
std::vector<std::filesystem::path> matching_files(const std::string& pattern);

/// What became of the images of a rig.
struct ImageDetections {
  BoardObservations observations;
  std::vector<BoardDetection> used;     ///< one a view of the observations, camera after camera
  std::vector<BoardDetection> refused;  ///< images without a board, or that cannot be read
};

/// Observations from the images of one or more cameras, one pattern a camera: images of the same
/// number are one frame (calib/board/frame_numbering.h). Frames whose board was found by some
/// cameras only count for those. An image that cannot be read is refused as one without a board is.
/// Throws Error where a camera has no frame number in common with those before it or one twice,
/// none of its images can be read, sizes disagree, no board is found, or more images show a board
/// of more corners than of those asked for.
ImageDetections detect_images(const std::vector<std::string>& patterns, const BoardTarget& target);

/// A corners file of all the images, with a line of dashes for each that was refused.
void write_corners(const ImageDetections& found,
                   const BoardTarget& target,
                   const std::filesystem::path& file);

}  // namespace vernier
