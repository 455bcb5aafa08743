// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/initial_rig.h"

#include <algorithm>
#include <map>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "calib/error.h"

namespace vernier {
namespace {

struct ViewPoints {
  std::vector<cv::Point3f> target;
  std::vector<cv::Point2f> pixels;
};

ViewPoints points_of(const BoardObservations& observations, const BoardView& view) {
  ViewPoints points;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const Eigen::Vector3d& X = observations.target_m[view.ids[i]];
    points.target.emplace_back(float(X.x()), float(X.y()), float(X.z()));
    points.pixels.emplace_back(float(view.pixels_px[i].x()), float(view.pixels_px[i].y()));
  }
  return points;
}

/// Focal length and centre without distortion.
Camera initial_camera(const BoardObservations& observations, int index, const CameraModel& model) {
  std::vector<std::vector<cv::Point3f>> targets;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardView& view : observations.views) {
    if (view.camera != index) continue;
    ViewPoints points = points_of(observations, view);
    targets.push_back(std::move(points.target));
    pixels.push_back(std::move(points.pixels));
  }
  const std::string place = "camera " + std::to_string(index);
  if (targets.size() < 3) {
    throw Error(place, std::to_string(targets.size()) + " views of the board",
                "at least three, at different tilts, are needed");
  }
  const Eigen::Vector2i size = observations.size_px[index];
  const cv::Mat K = cv::initCameraMatrix2D(targets, pixels, {size[0], size[1]}, 1.0);
  const double f = K.at<double>(1, 1);
  const double longest = size.maxCoeff();
  if (!(f > 0.05 * longest && f < 100 * longest)) {
    throw Error(place, "no focal length can be found from its views",
                "tilt the board by 20 to 45 degrees about both axes in several views");
  }
  Camera camera;
  camera.name = index == 0 ? "left" : index == 1 ? "right" : "camera" + std::to_string(index);
  camera.size_px = size;
  camera.model = model;
  camera.parameters = Eigen::VectorXd::Zero(parameter_count(model));
  camera.parameters.head<4>() << f, 1, 0.5 * (size[0] - 1), 0.5 * (size[1] - 1);
  return camera;
}

Pose board_pose(const BoardObservations& observations,
                const BoardView& view,
                const Camera& camera) {
  const ViewPoints points = points_of(observations, view);
  const cv::Matx33d K(camera.f_px(), 0, camera.ox_px(), 0, camera.f_px(), camera.oy_px(), 0, 0, 1);
  cv::Vec3d r, t;
  cv::solvePnP(points.target, points.pixels, K, cv::noArray(), r, t, false, cv::SOLVEPNP_ITERATIVE);
  Pose pose{rotation_from_vector({r[0], r[1], r[2]}), {t[0], t[1], t[2]}};
  if (!pose.t.allFinite() || !pose.R.allFinite()) {
    throw Error("frame " + std::to_string(view.frame) + ", camera " + std::to_string(view.camera),
                "no pose fits its corners", "leave the view out");
  }
  return pose;
}

/// The candidate that the others agree with best (least median distance): one bad frame among
/// several does no harm.
Pose central_pose(const std::vector<Pose>& candidates) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::vector<double> distances;
    for (const Pose& other : candidates) {
      const Pose d = candidates[i].inverse() * other;
      distances.push_back(vector_from_rotation(d.R).norm() +
                          d.t.norm() / (candidates[i].t.norm() + 1e-9));
    }
    std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
    const double median = distances[distances.size() / 2];
    if (median < least) {
      least = median;
      best = i;
    }
  }
  return candidates[best];
}

}  // namespace

BoardState at_frames(const BoardState& state, const std::vector<int>& frames) {
  BoardState part = state;
  part.frames.clear();
  part.T_first_board.clear();
  for (std::size_t f = 0; f < state.frames.size(); ++f) {
    if (!std::binary_search(frames.begin(), frames.end(), state.frames[f])) continue;
    part.frames.push_back(state.frames[f]);
    part.T_first_board.push_back(state.T_first_board[f]);
  }
  return part;
}

BoardState initial_state(const BoardObservations& observations,
                         const std::vector<CameraModel>& models) {
  BoardState state;
  state.frames = frames_of(observations);
  const int cameras = static_cast<int>(observations.size_px.size());
  for (int c = 0; c < cameras; ++c) {
    state.rig.cameras.push_back(initial_camera(observations, c, models[c]));
  }
  std::map<std::pair<int, int>, Pose> T_camera_board;  // by (camera, frame)
  for (const BoardView& view : observations.views) {
    T_camera_board[{view.camera, view.frame}] =
        board_pose(observations, view, state.rig.cameras[view.camera]);
  }

  state.T_first_board.resize(state.frames.size());
  std::vector<std::optional<Pose>> placed(state.frames.size());  // T_first_board
  for (int c = 0; c < cameras; ++c) {
    std::vector<Pose> candidates;
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      const auto seen = T_camera_board.find({c, state.frames[f]});
      if (seen != T_camera_board.end() && placed[f]) {
        candidates.push_back(seen->second * placed[f]->inverse());
      }
    }
    if (c > 0 && candidates.empty()) {
      throw Error("camera " + std::to_string(c), "it shares no frame with the cameras before it",
                  "let both see the board at once, or order the cameras so that neighbours do");
    }
    state.rig.T_camera_first.push_back(c == 0 ? Pose{} : central_pose(candidates));
    const Pose T_first_camera = state.rig.T_camera_first.back().inverse();
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      const auto seen = T_camera_board.find({c, state.frames[f]});
      if (seen != T_camera_board.end() && !placed[f]) placed[f] = T_first_camera * seen->second;
    }
  }
  for (std::size_t f = 0; f < placed.size(); ++f) state.T_first_board[f] = *placed[f];
  return state;
}

}  // namespace vernier
