// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/calibration_faults.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "calib/board/board_warp.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::bench {

using namespace vernier::internal;

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

double normal(Random& random) { return std::normal_distribution<double>()(random); }

std::size_t place_of(const BoardState& state, int frame) {
  return static_cast<std::size_t>(
      std::lower_bound(state.frames.begin(), state.frames.end(), frame) - state.frames.begin());
}

bool in_second_half(const CalibrationCase& c, const BoardView& view) {
  return 2 * place_of(c.truth, view.frame) >= c.truth.frames.size();
}

/// Drops corners that left the image, and views without enough of the others.
void keep_inside(BoardObservations& o) {
  for (BoardView& view : o.views) {
    const Eigen::Vector2d last = o.size_px[view.camera].cast<double>().array() - 1;
    BoardView kept{view.frame, view.camera, view.image, {}, {}};
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Eigen::Vector2d& p = view.pixels_px[i];
      if (!((p.array() >= 0).all() && (p.array() <= last.array()).all())) continue;
      kept.ids.push_back(view.ids[i]);
      kept.pixels_px.push_back(p);
    }
    view = std::move(kept);
  }
  std::erase_if(o.views, [&](const BoardView& v) {
    return v.ids.size() < 8 || !determines_pose(o.target_m, v.ids);
  });
}

/// What a camera sees of a board's point.
struct Seen {
  Camera camera;
  Pose T_camera_board;
  std::vector<Eigen::Vector3d> target_m;
};

/// Moves the corners of the views that `changed` changes.
void displace(CalibrationCase& c, const std::function<bool(const BoardView&, Seen&)>& changed) {
  for (BoardView& view : c.observations.views) {
    const std::size_t f = place_of(c.truth, view.frame);
    if (f >= c.truth.frames.size() || c.truth.frames[f] != view.frame) continue;
    const Seen before{c.truth.rig.cameras[view.camera],
                      c.truth.rig.T_camera_first[view.camera] * c.truth.T_first_board[f],
                      warped_target(c.observations.target_m, c.truth.warp_m)};
    Seen after = before;
    if (!changed(view, after)) continue;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      view.pixels_px[i] +=
          project(after.camera, after.T_camera_board * after.target_m[view.ids[i]]) -
          project(before.camera, before.T_camera_board * before.target_m[view.ids[i]]);
    }
  }
  keep_inside(c.observations);
}

Eigen::Vector3d random_vector(Random& random) {
  return {normal(random), normal(random), normal(random)};
}

int columns_of(const BoardObservations& o) {
  std::set<long> columns;
  for (const auto& X : o.target_m) columns.insert(std::lround(1e6 * X.x()));
  return static_cast<int>(columns.size());
}

double width_of(const BoardObservations& o) {
  double most = 0;
  for (const auto& X : o.target_m) most = std::max(most, (X - o.target_m.front()).norm());
  return most;
}

/// A mirrored image, its corners numbered as a detector does: from the left as seen.
void mirror_image(const BoardObservations& o, BoardView& view) {
  const int columns = columns_of(o);
  for (int& id : view.ids) id = id / columns * columns + columns - 1 - id % columns;
  for (auto& p : view.pixels_px) p.x() = o.size_px[view.camera].x() - 1 - p.x();
}

void exchange_sides(CalibrationCase& c, const std::function<bool(int)>& chosen) {
  for (BoardView& view : c.observations.views) {
    if (chosen(view.frame)) view.camera = 1 - view.camera;
  }
  std::sort(c.observations.views.begin(), c.observations.views.end(), [](auto& a, auto& b) {
    return std::pair(a.frame, a.camera) < std::pair(b.frame, b.camera);
  });
}

/// Frames with both images.
std::vector<int> paired_frames(const BoardObservations& o) {
  std::vector<int> frames;
  for (std::size_t i = 1; i < o.views.size(); ++i) {
    if (o.views[i].frame == o.views[i - 1].frame) frames.push_back(o.views[i].frame);
  }
  return frames;
}

int some_frame(const CalibrationCase& c, Random& random) {
  const std::vector<int> frames = paired_frames(c.observations);
  return frames[std::uniform_int_distribution<std::size_t>(0, frames.size() - 1)(random)];
}

const std::vector<std::string> prior_words{"prior"};
const std::vector<std::string> time_words{"not simultaneous",      "same pose",
                                          "did not see the board", "paired wrongly",
                                          "moved relative",        "triggered"};
const std::vector<std::string> change_words{"changed", "moved", "lens of camera", "zoom"};
const std::vector<std::string> board_words{"not flat", "bent"};
const std::vector<std::string> side_words{"swapped", "exchanged"};
const std::vector<std::string> mirror_words{"mirrored"};
const std::vector<std::string> number_words{"numbered", "half a turn", "do not fit a flat board"};

void wrong_square(CalibrationCase& c, double percent, bool with_prior) {
  for (auto& X : c.observations.target_m) X *= 1 + percent / 100;
  const double x = c.truth.rig.T_camera_first[1].t.x();
  if (with_prior) c.options.known = {{"right.tx_m", x, std::abs(x) / 200}};
}

std::vector<CalibrationFault> scale_faults() {
  return {
      {"square, no prior",
       "%",
       {5},
       prior_words,
       [](auto& c, double s, auto&) { wrong_square(c, s, false); }},
      {"square, baseline known to 0.5 %",
       "%",
       {1, 2, 5, 20},
       prior_words,
       [](auto& c, double s, auto&) { wrong_square(c, s, true); }},
      {"right images halved, size not said",
       "",
       {1},
       {"image size", "halved", "resized"},
       [](auto& c, double, auto&) {
         for (auto& view : c.observations.views) {
           if (view.camera != 1) continue;
           for (auto& p : view.pixels_px)
             p = 0.5 * (p.array() + 0.5).matrix() - Eigen::Vector2d(.5, .5);
         }
         keep_inside(c.observations);
       }},
      {"right images cropped by a border, size not said",
       "% of width",
       {5, 15, 25},
       {"image size", "cropped", "principal point"},
       [](auto& c, double s, auto&) {
         const Eigen::Vector2d border = s / 100 * c.observations.size_px[1].template cast<double>();
         for (auto& view : c.observations.views) {
           if (view.camera != 1) continue;
           const Eigen::Vector2d far = c.observations.size_px[1].template cast<double>() - border;
           for (auto& p : view.pixels_px) {
             p = (p.array() < border.array() || p.array() > far.array()).any()
                     ? Eigen::Vector2d(-1, -1)
                     : Eigen::Vector2d(p - border);
           }
         }
         keep_inside(c.observations);
       }},
      {"right images cropped from half on",
       "px",
       {1, 4, 16, 64},
       change_words,
       [](auto& c, double s, auto&) {
         displace(c, [&](const BoardView& v, Seen& seen) {
           seen.camera.parameters[2] -= s;
           return v.camera == 1 && in_second_half(c, v);
         });
       }},
  };
}

std::vector<CalibrationFault> change_faults() {
  return {
      {"two rigs mixed",
       "% of f and baseline",
       {0.5, 2, 10},
       change_words,
       [](auto& c, double s, auto&) {
         displace(c, [&](const BoardView& v, Seen& seen) {
           if (!in_second_half(c, v)) return false;
           const std::size_t f = place_of(c.truth, v.frame);
           seen.camera.parameters[0] *= 1 + (v.camera == 1 ? s : -s) / 100;
           Pose T = c.truth.rig.T_camera_first[v.camera];
           T.t *= 1 + s / 100;
           T.R = rotation_from_vector(Eigen::Vector3d(0.2, -0.3, 0.1) * (s / 100 * v.camera)) * T.R;
           seen.T_camera_board = T * c.truth.T_first_board[f];
           return true;
         });
       }},
      {"right lens zoomed from half on",
       "%",
       {0.2, 0.5, 2, 5},
       change_words,
       [](auto& c, double s, auto&) {
         displace(c, [&](const BoardView& v, Seen& seen) {
           seen.camera.parameters[0] *= 1 + s / 100;
           return v.camera == 1 && in_second_half(c, v);
         });
       }},
      {"left lens turned from half on",
       "px of its centre",
       {1, 3, 10},
       change_words,
       [](auto& c, double s, auto&) {
         displace(c, [&](const BoardView& v, Seen& seen) {
           seen.camera.parameters[2] += 0.6 * s;
           seen.camera.parameters[3] += 0.8 * s;
           return v.camera == 0 && in_second_half(c, v);
         });
       }},
      {"one image zoomed",
       "%",
       {2, 5},
       {"frame", "view"},
       [](auto& c, double s, auto& random) {
         const int frame = some_frame(c, random);
         displace(c, [&](const BoardView& v, Seen& seen) {
           seen.camera.parameters[0] *= 1 + s / 100;
           return v.camera == 1 && v.frame == frame;
         });
       }},
      {"board bent",
       "% of its diagonal",
       {0.1, 0.3, 1, 3},
       board_words,
       [](auto& c, double s, auto&) {
         const double by = s / 100 * width_of(c.observations);
         displace(c, [&](const BoardView&, Seen& seen) {
           seen.target_m = warped_target(c.observations.target_m,
                                         c.truth.warp_m + Eigen::Vector2d(by, 0.3 * by));
           return true;
         });
       }},
  };
}

std::vector<CalibrationFault> time_faults() {
  return {
      {"right images jittered",
       "+- px",
       {0.5, 1, 2, 4},
       time_words,
       [](auto& c, double s, auto& random) {
         for (auto& view : c.observations.views) {
           if (view.camera != 1) continue;
           const double y = uniform(random, -s, s), x = uniform(random, -s, s);
           const Eigen::Vector2d by(x, y);
           for (auto& p : view.pixels_px) p += by;
         }
         keep_inside(c.observations);
       }},
      {"board moves between left and right",
       "% of its distance",
       {0.05, 0.2, 1},
       time_words,
       [](auto& c, double s, auto& random) {
         displace(c, [&](const BoardView& v, Seen& seen) {
           const std::size_t f = place_of(c.truth, v.frame);
           Pose T = c.truth.T_first_board[f];
           T.t += s / 100 * T.t.norm() * random_vector(random);
           T.R = rotation_from_vector(Eigen::Vector3d(s / 100 * random_vector(random))) * T.R;
           seen.T_camera_board = c.truth.rig.T_camera_first[v.camera] * T;
           return v.camera == 1;
         });
       }},
  };
}

std::vector<CalibrationFault> order_faults() {
  return {
      {"left and right swapped",
       "",
       {1},
       side_words,
       [](auto& c, double, auto&) { exchange_sides(c, [](int) { return true; }); }},
      {"swapped in some frames",
       "frames",
       {1, 3},
       side_words,
       [](auto& c, double s, auto&) {
         std::set<int> chosen;
         const std::vector<int> frames = paired_frames(c.observations);
         for (std::size_t i = 0; i < static_cast<std::size_t>(s); ++i) {
           chosen.insert(frames[(i + 1) * frames.size() / 4]);
         }
         exchange_sides(c, [&](int frame) { return chosen.count(frame) > 0; });
       }},
      {"every image mirrored",
       "",
       {1},
       {"mirrored", "exchanged"},
       [](auto& c, double, auto&) {
         for (auto& view : c.observations.views) mirror_image(c.observations, view);
       }},
      {"right images mirrored",
       "",
       {1},
       mirror_words,
       [](auto& c, double, auto&) {
         for (auto& view : c.observations.views) {
           if (view.camera == 1) mirror_image(c.observations, view);
         }
       }},
      {"one image mirrored",
       "",
       {1},
       {"mirrored", "frame", "leave"},
       [](auto& c, double, auto& random) {
         const int frame = some_frame(c, random);
         for (auto& view : c.observations.views) {
           if (view.camera == 1 && view.frame == frame) mirror_image(c.observations, view);
         }
       }},
      {"one image numbered from the other end",
       "",
       {1},
       number_words,
       [](auto& c, double, auto& random) {
         const int frame = some_frame(c, random);
         const auto last = static_cast<int>(c.observations.target_m.size()) - 1;
         for (auto& view : c.observations.views) {
           if (view.camera != 1 || view.frame != frame) continue;
           for (int& id : view.ids) id = last - id;
         }
       }},
      {"one image numbered one column off",
       "",
       {1},
       {"numbered", "frame", "leave"},
       [](auto& c, double, auto& random) {
         const int frame = some_frame(c, random), columns = columns_of(c.observations);
         for (auto& view : c.observations.views) {
           if (view.camera != 1 || view.frame != frame) continue;
           BoardView moved{view.frame, view.camera, view.image, {}, {}};
           for (std::size_t i = 0; i < view.ids.size(); ++i) {
             if (view.ids[i] % columns == columns - 1) continue;
             moved.ids.push_back(view.ids[i] + 1);
             moved.pixels_px.push_back(view.pixels_px[i]);
           }
           view = std::move(moved);
         }
       }},
  };
}

}  // namespace

std::vector<CalibrationFault> calibration_faults() {
  std::vector<CalibrationFault> all;
  for (auto&& some : {scale_faults(), change_faults(), time_faults(), order_faults()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace vernier::bench
