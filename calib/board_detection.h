// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"

namespace vernier {

/// Why a detected corner is not used.
enum class CornerRejection {
  at_border,      ///< too near the image's border for a window around it
  not_crossing,   ///< not a crossing of squares, for example occluded
  moved_too_far,  ///< refinement left its window or did not converge
  off_neighbours  ///< inconsistent with its neighbours
};

/// Description, such as "at the image's border".
std::string text_of(CornerRejection refusal);

struct RejectedCorner {
  int id = 0;
  CornerRejection why = CornerRejection::at_border;
};

/// Detection result of one image.
struct BoardDetection {
  std::filesystem::path image;
  Eigen::Vector2i size_px{0, 0};  ///< 0, 0 if the image cannot be read
  std::vector<int> ids;           ///< index of each corner into target_points; empty: no board
  std::vector<Eigen::Vector2d> corners_px;
  std::vector<RejectedCorner> rejected_corners;  ///< detected but not used
  std::string reason;                            ///< why no board was found; empty if one was
  bool goes_on = false;                          ///< the board has more corners than asked for
  std::vector<int> ids_beyond;  ///< ids of tags of an AprilTag grid in its next rows
  int camera = 0;               ///< index of its pattern
  int frame = 0;                ///< from the number in its name
};

/// Summary of the corners detected but not used, such as "3 corners at the image's border, 1 corner
/// …".
std::string rejected_corners_text(const BoardDetection& image);

/// Finds the corners of a target in an image and refines each by the gradient's orthogonality
/// (Förstner and Gülch 1987, as in OpenCV's cornerSubPix) in a window that contains no other edge
/// of the pattern. Corners for which this fails are rejected one by one.
///
/// Chessboards: OpenCV's two finders in turn. A board found only in part is rejected, and so is one
/// that continues beyond the corners asked for. If columns + rows is odd, the order of corners is
/// the same in every image: x along rows, y down, the square between the first four corners dark.
/// ChArUco boards and AprilTag grids: OpenCV's marker detector. Markers inconsistent with the board
/// are dropped; six corners that span the plane are enough.
///
/// Throws Error for a file that cannot be read, is truncated or is not an image, and for an invalid
/// target.
BoardDetection detect_board(const std::filesystem::path& image, const BoardTarget& target);

/// Files that match a pattern (shell globbing of the last component), sorted by name. Throws Error
/// if there are none.
std::vector<std::filesystem::path> matching_files(const std::string& pattern);

/// Detection results of all images of a rig.
struct ImageDetections {
  BoardObservations observations;
  std::vector<BoardDetection> used;     ///< one per view of the observations, camera by camera
  std::vector<BoardDetection> refused;  ///< images without a board, or that cannot be read
};

/// Observations from the images of one or more cameras, one pattern per camera: images with the
/// same number form one frame (calib/board/frame_numbering.h). A frame counts for the cameras that
/// found the board. An image that cannot be read is refused like one without a board. Throws Error
/// if a camera shares no frame number with those before it or has one twice, if none of its images
/// can be read, sizes differ, no board is found, more images show a board of more corners than
/// of those asked for, or one shows an AprilTag grid with rows that the target has not.
ImageDetections detect_images(const std::vector<std::string>& patterns, const BoardTarget& target);

/// Writes a corners file of all images, with a line of dashes for each refused one.
void write_corners(const ImageDetections& found,
                   const BoardTarget& target,
                   const std::filesystem::path& file);

}  // namespace vernier
