// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_placement.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

struct Target {
  const std::vector<Eigen::Vector3d>& points_m;
  Eigen::Vector3d middle_m, extent_m;

  explicit Target(const std::vector<Eigen::Vector3d>& target_m) : points_m(target_m) {
    if (target_m.size() < 4) throw Error("board", "it has fewer than four corners", "");
    Eigen::Vector3d low = target_m.front(), high = low;
    for (const Eigen::Vector3d& X : target_m) {
      low = low.cwiseMin(X);
      high = high.cwiseMax(X);
    }
    middle_m = 0.5 * (low + high);
    extent_m = high - low;
    if (!(extent_m[0] > 0 && extent_m[1] > 0)) {
      throw Error("board", "its corners are collinear", "give a board of two rows and columns");
    }
  }
};

/// i-th of n values from `low` to `high`; the middle if n is 1.
double step_between(double low, double high, int i, int n) {
  return n > 1 ? low + (high - low) * i / (n - 1) : 0.5 * (low + high);
}

/// The board as seen by a camera; std::nullopt if fewer than `least` corners are visible or the
/// slant is too large.
std::optional<BoardView> seen_by(const Rig& rig,
                                 int camera,
                                 const Pose& T_first_board,
                                 const Target& target,
                                 const PlacementOptions& options) {
  const Pose T_camera_board = rig.T_camera_first[camera] * T_first_board;
  const Eigen::Vector3d sight = (T_camera_board * target.middle_m).normalized();
  if (T_camera_board.R.col(2).dot(sight) < std::cos(options.greatest_slant_rad))
    return std::nullopt;
  const Camera& c = rig.cameras[camera];
  const Eigen::Array2d last = c.size_px.cast<double>().array() - 1 - options.border_px;
  BoardView view;
  view.camera = camera;
  for (std::size_t i = 0; i < target.points_m.size(); ++i) {
    const Eigen::Vector3d x = T_camera_board * target.points_m[i];
    if (!(x.z() > 0)) return std::nullopt;
    const Eigen::Vector2d pixel = project(c, x);
    if ((pixel.array() < options.border_px).any() || (pixel.array() > last).any()) continue;
    // beyond a fold of the distortion, a point far outside may project into the image
    const auto ray = try_unproject(c, pixel);
    if (!ray || (*ray - x / x.z()).norm() > 1e-6) return std::nullopt;
    view.ids.push_back(static_cast<int>(i));
    view.pixels_px.push_back(pixel);
  }
  return view;
}

/// Number of cameras that must see the board.
std::size_t number_that_must(const Rig& rig, const PlacementOptions& options) {
  return options.cameras.empty() ? rig.cameras.size() : options.cameras.size();
}

bool must_see(int camera, const PlacementOptions& options) {
  const std::vector<int>& all = options.cameras;
  return all.empty() || std::find(all.begin(), all.end(), camera) != all.end();
}

std::vector<BoardView> seen_by_all(const Rig& rig,
                                   const Pose& T_first_board,
                                   const Target& target,
                                   const PlacementOptions& options) {
  const std::size_t all = target.points_m.size();
  std::vector<BoardView> views;
  int partial = 0;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    auto view = seen_by(rig, static_cast<int>(c), T_first_board, target, options);
    if (!must_see(static_cast<int>(c), options)) {
      if (view && view->ids.size() == all) views.push_back(std::move(*view));
      continue;
    }
    if (!view) return {};
    if (view->ids.size() < all) {
      const std::size_t least = std::max<std::size_t>(6, all / 4);
      if (!options.partly || number_that_must(rig, options) < 2 || ++partial > 1 ||
          view->ids.size() < least)
        return {};
    }
    views.push_back(std::move(*view));
  }
  return views;
}

int whole_degrees(double angle_rad) {
  return static_cast<int>(std::lround(std::abs(angle_rad) * 180 / std::numbers::pi));
}

std::string nearer_edge(double angle_rad, const char* positive, const char* negative) {
  if (whole_degrees(angle_rad) == 0) return "";
  return fmt::format(" ({} edge nearer)", angle_rad > 0 ? positive : negative);
}

std::string region(const Eigen::Vector2d& pixel, const Eigen::Vector2i& size) {
  const auto third = [&](int axis) {
    return static_cast<int>(3 * (pixel[axis] + 0.5) / size[axis]);
  };
  const int column = third(0), row = third(1);
  const std::string across = column < 1 ? "left" : column > 1 ? "right" : "";
  const std::string down = row < 1 ? "upper" : row > 1 ? "lower" : "";
  if (across.empty() && down.empty()) return "middle";
  if (across.empty()) return down + " middle";
  return down.empty() ? across + " middle" : down + " " + across;
}

}  // namespace

std::vector<PlacedBoard> placed_boards(const Rig& rig,
                                       const std::vector<Eigen::Vector3d>& target_m,
                                       const PlacementOptions& options) {
  const Target target(target_m);
  const auto r = static_cast<std::size_t>(options.cameras.empty() ? 0 : options.cameras[0]);
  const Camera& reference = rig.cameras[r];
  const Pose T_first_reference = rig.T_camera_first[r].inverse();
  const Eigen::Vector2d size = reference.size_px.cast<double>();
  const int n = options.places;
  std::vector<PlacedBoard> boards;
  for (int place = 0; place < n * n; ++place) {
    // the centres of the outermost cells of a grid
    const int column = place % n, row = place / n;
    const Eigen::Vector2d centre((column + 0.5) / n * size[0] - 0.5,
                                 (row + 0.5) / n * size[1] - 0.5);
    const auto ray = try_unproject(reference, centre);
    if (!ray) continue;
    for (int k = 0; k < options.fills * options.angles * options.angles; ++k) {
      const int fill = k / (options.angles * options.angles);
      const int turn = k / options.angles % options.angles, tilt = k % options.angles;
      const double log_share = step_between(std::log(options.min_fill),
                                            std::log(options.greatest_fill), fill, options.fills);
      const double z = std::max(reference.f_px() * reference.ax() * target.extent_m[0] / size[0],
                                reference.f_px() * target.extent_m[1] / size[1]) /
                       std::exp(log_share);
      const double most = options.greatest_angle_rad;
      BoardPlacement p{centre,
                       z * ray->norm(),
                       step_between(-most, most, turn, options.angles),
                       step_between(-most, most, tilt, options.angles),
                       {},
                       {place % n, place / n, fill, turn, tilt}};
      p.T_first_board.R =
          rotation_from_vector({0, p.turn_rad, 0}) * rotation_from_vector({p.tilt_rad, 0, 0});
      p.T_first_board.t = z * *ray - p.T_first_board.R * target.middle_m;
      p.T_first_board = T_first_reference * p.T_first_board;
      std::vector<BoardView> views = seen_by_all(rig, p.T_first_board, target, options);
      if (!views.empty()) boards.push_back({p, std::move(views)});
    }
  }
  if (boards.empty()) {
    throw Error(
        "board",
        options.cameras.empty() ? "no placement shows it whole in all cameras"
                                : "no placement shows it whole in the cameras that are named",
        rig.cameras.size() > 2 && options.cameras.empty()
            ? "name the cameras that must see it (--cameras), or use a larger board farther "
              "away"
            : "use a larger board farther away, or let one camera see a part of it "
              "(--partly)");
  }
  return boards;
}

std::string describe_placement(const BoardPlacement& p, const Camera& reference) {
  return fmt::format(
      "hold the board {:.2f} m away, its centre in the {} of the {} image ({:.0f}, {:.0f}), turned "
      "{}° about the vertical axis{}, tilted {}°{}",
      p.distance_m, region(p.centre_px, reference.size_px), reference.name, p.centre_px[0],
      p.centre_px[1], whole_degrees(p.turn_rad), nearer_edge(p.turn_rad, "right", "left"),
      whole_degrees(p.tilt_rad), nearer_edge(p.tilt_rad, "upper", "lower"));
}

}  // namespace vernier::internal
