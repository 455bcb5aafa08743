// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/observation_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/board/board_homography.h"
#include "calib/board/corner_difference.h"
#include "calib/board/nearest_corners.h"
#include "calib/board_observations.h"
#include "calib/error.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

constexpr double same_image_px = 1e-3;    // of one camera: a copy
constexpr double same_cameras_px = 0.05;  // of two cameras: a copy, perhaps compressed again
constexpr double repeated_view_px = 0.3;  // rms: the board has not moved
constexpr double grid_misfit_spacings = 0.5, grid_misfit_px = 5;
constexpr double most_misfits = 0.2;  // of a camera's views: more are the rule, not the exception
// A lens bends three by three corners by at most 0.12 of their spacing up to 85 degrees from its
// axis; one row in nine reversed, or numbered from the next corner on, leaves a sixth of the
// corners and more above twice that.
constexpr double local_misfit_spacings = 0.25, local_misfit_share = 0.15;

/// Distance between neighbouring corners in the image: that on the target, times the square root of
/// the area magnification at the centre of the view's corners.
double corner_spacing_px(const BoardHomography& view,
                         const std::vector<Eigen::Vector3d>& target_m) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < target_m.size(); ++i) {
    const double d = (target_m[i] - target_m[0]).head<2>().norm();
    if (d > 0) least = std::min(least, d);
  }
  return least * std::sqrt(std::abs(view.H.determinant()));  // d(u, v)/d(X, Y) at the centre
}

/// Distance (px) of each corner from the nearest other one, whatever their numbers are.
std::vector<double> nearest_px(const BoardView& view) {
  std::vector<double> least(view.ids.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    for (std::size_t k = 0; k < view.ids.size(); ++k) {
      if (k == i) continue;
      least[i] = std::min(least[i], (view.pixels_px[k] - view.pixels_px[i]).norm());
    }
  }
  return least;
}

/// The share of the corners that do not fit a homography with their eight neighbours on the board:
/// few where a wide lens bends the board as a whole, many where corners are numbered wrongly.
double share_unlike_neighbours(const std::vector<Eigen::Vector3d>& target_m,
                               const BoardView& view) {
  const std::vector<double> spacings_px = nearest_px(view);
  int unlike = 0, judged = 0;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    std::vector<std::size_t> places = nearest_corners(target_m, view, i, 8);
    places.push_back(i);
    BoardView near{view.frame, view.camera, view.image, {}, {}};
    std::vector<double> spacing_px;
    for (const std::size_t k : places) {
      near.ids.push_back(view.ids[k]);
      near.pixels_px.push_back(view.pixels_px[k]);
      spacing_px.push_back(spacings_px[k]);
    }
    if (near.ids.size() < 6 || !determines_pose(target_m, near.ids)) continue;  // 5 fit almost any
    ++judged;
    const double limit_px = local_misfit_spacings * median_or_zero(std::move(spacing_px));
    unlike += !(board_homography(target_m, near).rms_px <= limit_px);
  }
  return judged == 0 ? 1 : static_cast<double>(unlike) / judged;
}

/// Doubts views whose corners are not on a plane. Throws Error if they are not few. Flags them.
std::vector<bool> check_grids(const BoardObservations& observations,
                              const std::vector<BoardHomography>& homographies,
                              bool may_leave_out,
                              ObservationDiagnosis& diagnosis) {
  std::vector<Error> errors;
  std::map<int, std::pair<int, int>> of_camera;  // misfits, all
  std::vector<bool> misfit(homographies.size());
  for (std::size_t i = 0; i < homographies.size(); ++i) {
    auto& [misfits, all] = of_camera[observations.views[i].camera];
    ++all;
    const double spacing = corner_spacing_px(homographies[i], observations.target_m);
    if (homographies[i].rms_px <= std::max(grid_misfit_px, grid_misfit_spacings * spacing) ||
        share_unlike_neighbours(observations.target_m, observations.views[i]) <=
            local_misfit_share) {
      continue;
    }
    misfit[i] = true;
    ++misfits;
    errors.emplace_back(
        view_label(observations.views[i]),
        fmt::format("its corners do not fit a flat board (residual {:.0f} px at a corner spacing "
                    "of {:.0f} px)",
                    homographies[i].rms_px, spacing),
        "check that rows and columns of the board are not exchanged and how corners are numbered");
    diagnosis.frame_doubts.push_back({observations.views[i].frame, errors.back().what()});
  }
  for (const auto& [camera, count] : of_camera) {
    if (count.first > (may_leave_out ? most_misfits * count.second : 0)) throw errors.front();
  }
  return misfit;
}

/// Whether the corners form evenly spaced columns, as on a chessboard. Corners of tags do not; they
/// are identified individually, so their views cannot be mirrored, and their y may point up.
bool evenly_spaced(const std::vector<Eigen::Vector3d>& target_m) {
  std::vector<double> columns;
  columns.reserve(target_m.size());
  for (const Eigen::Vector3d& X : target_m) columns.push_back(X.x());
  std::sort(columns.begin(), columns.end());
  const double near = 1e-3 * (columns.back() - columns.front());
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t i = 1; i < columns.size(); ++i) {
    const double step = columns[i] - columns[i - 1];
    if (step <= near) continue;
    least = std::min(least, step);
    most = std::max(most, step);
  }
  return most < 1.1 * least;
}

/// Throws Error for views mirrored relative to the others; a trust warning if all are.
void check_mirrored(const BoardObservations& observations,
                    const std::vector<BoardHomography>& homographies,
                    const std::vector<bool>& misfit,
                    ObservationDiagnosis& diagnosis) {
  std::vector<std::string> mirrored, others;
  std::map<int, std::pair<int, int>> of_camera;  // mirrored, all
  for (std::size_t i = 0; i < homographies.size(); ++i) {
    if (misfit[i]) continue;
    auto& [wrong, all] = of_camera[observations.views[i].camera];
    const bool front = homographies[i].is_front_facing;
    (front ? others : mirrored).push_back(view_label(observations.views[i]));
    ++all;
    wrong += !front;
  }
  if (mirrored.empty()) return;
  const std::string cure =
      "corners must run row by row, x right and y down as seen: flip the mirrored images or "
      "reverse their numbering";
  if (others.empty()) {
    if (!evenly_spaced(observations.target_m)) return;
    diagnosis.trust_warnings.push_back(
        "every view shows the board mirrored (its corners run right to left or bottom to top): if "
        "the images are mirrored, so is the rig; " +
        cure);
    return;
  }
  for (const auto& [camera, count] : of_camera) {
    if (count.first != count.second) continue;
    throw Error(fmt::format("camera {}", camera),
                fmt::format("the board is mirrored in {}, but not in those of every camera",
                            count.second == 1 ? "its only view"
                                              : fmt::format("all its {} views", count.second)),
                cure);
  }
  if (mirrored.size() > others.size()) std::swap(mirrored, others);
  throw Error(list_of(mirrored),
              "the board is mirrored against the other " +
                  counted(static_cast<std::int64_t>(others.size()), "view"),
              cure);
}

void check_repeats(const BoardObservations& observations, ObservationDiagnosis& diagnosis) {
  const auto& views = observations.views;
  std::vector<std::string> repeated;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = i + 1; j < views.size(); ++j) {
      const bool one_camera = views[i].camera == views[j].camera;
      if (!one_camera && views[i].frame != views[j].frame) continue;
      const CornerDifference d = corner_difference(views[i], views[j], repeated_view_px);
      if (!one_camera && d.rms_px < same_cameras_px) {
        throw Error(view_label(views[i]) + " and camera " + std::to_string(views[j].camera),
                    fmt::format("the images are the same (their corners differ by {:.2g} px)",
                                d.largest_px),
                    "give the other camera's own image");
      }
      if (one_camera && d.largest_px < same_image_px) {
        throw Error(view_label(views[j]),
                    fmt::format("it is the same view as frame {} (their corners differ by {:.2g} "
                                "px), and counting it twice would understate the uncertainty",
                                views[i].frame, d.largest_px),
                    "remove one of the two");
      }
      if (one_camera && d.rms_px < repeated_view_px) {
        repeated.push_back(
            fmt::format("{} and {} (camera {})", views[i].frame, views[j].frame, views[i].camera));
      }
    }
  }
  if (!repeated.empty()) {
    diagnosis.warnings.push_back(
        "the board did not move between frames " + list_of(repeated) +
        ": they count as independent views but add hardly more information than one");
  }
}

/// Distance between the first point and the nearest other one.
double min_side_m(const std::vector<Eigen::Vector3d>& target_m) {
  double least = INFINITY;
  for (std::size_t i = 1; i < target_m.size(); ++i) {
    least = std::min(least, (target_m[i] - target_m[0]).norm());
  }
  return least;
}

void check_sizes(const BoardObservations& observations, ObservationDiagnosis& diagnosis) {
  for (int c = 0; c < static_cast<int>(observations.size_px.size()); ++c) {
    Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
    for (const BoardView& view : observations.views) {
      if (view.camera != c) continue;
      for (const auto& pixel : view.pixels_px) farthest = farthest.cwiseMax(pixel);
    }
    const Eigen::Vector2d size = observations.size_px[c].cast<double>();
    if ((farthest.array() < 0.52 * size.array()).all()) {
      diagnosis.trust_warnings.push_back(
          fmt::format("camera {}: no corner lies beyond ({:.0f}, {:.0f}) of an image of {:.0f}x"
                      "{:.0f}: check the image size, or cover the whole image with the board",
                      c, farthest.x(), farthest.y(), size.x(), size.y()));
    }
  }
  Eigen::Vector3d low = observations.target_m.front(), high = low;
  for (const Eigen::Vector3d& X : observations.target_m) {
    low = low.cwiseMin(X);
    high = high.cwiseMax(X);
  }
  const double extent = (high - low).maxCoeff();
  if (extent > 20 || extent < 0.005) {
    const double side = min_side_m(observations.target_m);
    diagnosis.trust_warnings.push_back(fmt::format(
        "the board measures {:.3g} m, its points are {:.3g} m apart: did you mean {:.3g}? Lengths "
        "are in metres, and a wrong scale cannot be detected from the views",
        extent, side, extent > 20 ? 1e-3 * side : 1e3 * side));
  }
}

/// Counts frames that some cameras did not see, and warns of them.
void count_unpaired(const BoardObservations& observations, ObservationDiagnosis& diagnosis) {
  const auto cameras = static_cast<int>(observations.size_px.size());
  if (cameras < 2) return;
  std::map<int, std::vector<int>> cameras_of_frame;
  for (const BoardView& view : observations.views) {
    cameras_of_frame[view.frame].push_back(view.camera);
  }
  std::map<int, std::vector<std::string>> alone;
  for (const auto& [frame, seen] : cameras_of_frame) {
    if (seen.size() == 1) alone[seen.front()].push_back(std::to_string(frame));
  }
  for (const auto& [camera, frames] : alone) {
    diagnosis.warnings.push_back(
        fmt::format("{} of {} frames show the board in camera {} alone ({}): they determine its "
                    "intrinsics only, not the cameras' poses",
                    frames.size(), cameras_of_frame.size(), camera, list_of(frames)));
  }
}

}  // namespace

void ObservationDiagnosis::add(const ObservationDiagnosis& more) {
  warnings.insert(warnings.end(), more.warnings.begin(), more.warnings.end());
  trust_warnings.insert(trust_warnings.end(), more.trust_warnings.begin(),
                        more.trust_warnings.end());
  frame_doubts.insert(frame_doubts.end(), more.frame_doubts.begin(), more.frame_doubts.end());
}

std::string view_label(const BoardView& view) {
  return fmt::format("frame {}, camera {}", view.frame, view.camera) +
         (view.image.empty() ? "" : " (" + view.image + ")");
}

std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 6;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < most; ++i) {
    const bool last = i + 1 == names.size();
    text += (i == 0 ? "" : last ? " and " : ", ") + names[i];
  }
  if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
  return text;
}

ObservationDiagnosis check_observations(const BoardObservations& observations, bool may_leave_out) {
  ObservationDiagnosis diagnosis;
  if (observations.views.empty()) {
    throw Error("observations", "there is no view of the board", "give at least one");
  }
  check_flat(observations.target_m);
  std::vector<BoardHomography> homographies;
  for (const BoardView& view : observations.views) {
    homographies.push_back(board_homography(observations.target_m, view));
  }
  const std::vector<bool> misfit =
      check_grids(observations, homographies, may_leave_out, diagnosis);
  check_mirrored(observations, homographies, misfit, diagnosis);
  check_repeats(observations, diagnosis);
  check_sizes(observations, diagnosis);
  count_unpaired(observations, diagnosis);
  return diagnosis;
}

}  // namespace vernier::internal
