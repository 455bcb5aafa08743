// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_observations.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"

namespace vernier {
namespace {

std::string view_label(const BoardView& view) {
  return "frame " + std::to_string(view.frame) + ", camera " + std::to_string(view.camera) +
         (view.image.empty() ? "" : " (" + view.image + ")");
}

void check_view(const BoardView& view, const BoardObservations& observations) {
  const std::string place = view_label(view);
  if (view.camera < 0 || view.camera >= static_cast<int>(observations.size_px.size())) {
    throw Error(place, "the image size of this camera is unknown", "give one size per camera");
  }
  if (view.ids.size() != view.pixels_px.size()) {
    throw Error(place,
                std::to_string(view.pixels_px.size()) + " pixels for " +
                    std::to_string(view.ids.size()) + " corners",
                "give one pixel per corner");
  }
  if (view.ids.size() < 4) {
    throw Error(place, "fewer than four corners", "leave the view out");
  }
  const Eigen::Vector2d size = observations.size_px[view.camera].cast<double>();
  std::vector<bool> seen(observations.target_m.size());
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const std::string corner = place + ", corner " + std::to_string(view.ids[i]);
    if (view.ids[i] < 0 || view.ids[i] >= static_cast<int>(observations.target_m.size())) {
      throw Error(corner, "the target has no such corner", "check the board's size");
    }
    if (seen[view.ids[i]]) throw Error(corner, "it appears twice in the view", "give it once");
    seen[view.ids[i]] = true;
    const Eigen::Vector2d& pixel = view.pixels_px[i];
    if (!pixel.allFinite()) {
      throw Error(corner, "its pixel is not a finite number", "remove or correct it");
    }
    if ((pixel.array() < -0.5).any() || (pixel.array() > size.array() - 0.5).any()) {
      throw Error(corner,
                  "its pixel lies outside the image of " + std::to_string(int(size[0])) + "x" +
                      std::to_string(int(size[1])),
                  "check the image size, or that the corners belong to these images");
    }
  }
  if (!determines_pose(observations.target_m, view.ids)) {
    throw Error(
        place,
        "all its corners, or all but one, are collinear, which does not determine the board's pose",
        "leave the view out");
  }
}

}  // namespace

std::vector<int> frames_of(const BoardObservations& observations) {
  std::vector<int> frames;
  for (const BoardView& view : observations.views) frames.push_back(view.frame);
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

bool determines_pose(const std::vector<Eigen::Vector3d>& target_m, const std::vector<int>& ids) {
  if (ids.size() < 4) return false;
  // If all but one corner are on a line, it contains two of the first three.
  for (int without = 0; without < 3; ++without) {
    const Eigen::Vector3d& a = target_m[ids[(without + 1) % 3]];
    const Eigen::Vector3d along = target_m[ids[(without + 2) % 3]] - a;
    const auto beside = [&](int id) {
      const Eigen::Vector3d d = target_m[id] - a;
      return d.cross(along).norm() > 1e-6 * d.norm() * along.norm();
    };
    if (std::count_if(ids.begin(), ids.end(), beside) < 2) return false;
  }
  return true;
}

std::vector<int> evenly_spaced(const std::vector<int>& frames, int most) {
  const std::size_t n = frames.size(), count = static_cast<std::size_t>(std::max(0, most));
  if (n <= count) return frames;
  std::vector<int> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(frames[k * n / count]);
  return some;
}

BoardObservations at_frames(const BoardObservations& observations, const std::vector<int>& frames) {
  BoardObservations part = observations;
  std::erase_if(part.views, [&](const BoardView& view) {
    return !std::binary_search(frames.begin(), frames.end(), view.frame);
  });
  return part;
}

BoardObservations with_corners(
    BoardObservations observations,
    const std::function<bool(const BoardView& view, std::size_t corner)>& kept) {
  for (BoardView& view : observations.views) {
    BoardView fewer{view.frame, view.camera, view.image, {}, {}};
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      if (!kept(view, i)) continue;
      fewer.ids.push_back(view.ids[i]);
      fewer.pixels_px.push_back(view.pixels_px[i]);
    }
    view = std::move(fewer);
  }
  std::erase_if(observations.views, [&](const BoardView& view) {
    return !determines_pose(observations.target_m, view.ids);
  });
  return observations;
}

void check_and_sort(BoardObservations& observations) {
  for (std::size_t i = 0; i < observations.target_m.size(); ++i) {
    if (observations.target_m[i].allFinite()) continue;
    throw Error("target, corner " + std::to_string(i), "its position is not a finite number",
                "give it in metres");
  }
  auto& views = observations.views;
  std::stable_sort(views.begin(), views.end(), [](const BoardView& a, const BoardView& b) {
    return std::pair(a.frame, a.camera) < std::pair(b.frame, b.camera);
  });
  for (const BoardView& view : views) check_view(view, observations);
  for (std::size_t i = 1; i < views.size(); ++i) {
    if (views[i].frame == views[i - 1].frame && views[i].camera == views[i - 1].camera) {
      throw Error(view_label(views[i]), "this camera appears twice in the frame", "remove one");
    }
  }
}

}  // namespace vernier
