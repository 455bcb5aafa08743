// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/kitti_calib.h"

#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

void run_kitti_calib(std::string_view bytes) {
  const std::string text(bytes);
  looks_like_kitti_calib(text);
  ImportOptions options;
  options.size_px = Eigen::Vector2i(1241, 376);
  const auto read = accepted([&] { return parse_kitti_calib(text, "calib.txt", options); });
  const auto unsized_ = accepted([&] { return parse_kitti_calib(text, "calib.txt"); });
  require(!unsized_ || read, "a size is never a fault");
  if (!read) return;
  require(!read->rig.cameras.empty(), "what is accepted holds a camera");
  for (const Camera& camera : read->rig.cameras) {
    require(camera.parameters.allFinite() && camera.size_px.minCoeff() > 0, "cameras are cameras");
  }
  for (const Pose& T : read->rig.T_camera_first) {
    require(T.R == Eigen::Matrix3d::Identity() && T.t.allFinite(), "cameras are parallel");
  }
}

std::vector<std::string> kitti_calib_seeds() {
  const std::string a =
      "7.07e+02 0.0e+00 6.01e+02 0.0e+00 0.0e+00 7.07e+02 1.83e+02 0.0e+00 0.0e+00 0.0e+00 1.0e+00 "
      "0.0e+00";
  const std::string b =
      "7.07e+02 0.0e+00 6.01e+02 -3.8e+02 0.0e+00 7.07e+02 1.83e+02 0.0e+00 0.0e+00 0.0e+00 "
      "1.0e+00 0.0e+00";
  return {"P0: " + a + "\nP1: " + b + "\nTr: " + a + "\n", a + "\n" + b + "\n", a + b,
          "calib_time: 09-Jan-2012\nS_rect_00: 1.2e+03 3.7e+02\nP_rect_00: " + a + "\n",
          "495 0 270\n0 495 169\n0 0 1\n"};
}

const Registered registered_kitti_calib{
    {"kitti_calib", 1500, "columns", run_kitti_calib, kitti_calib_seeds}};

}  // namespace
}  // namespace vernier::fuzz
