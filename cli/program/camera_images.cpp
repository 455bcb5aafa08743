// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/camera_images.h"

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/rig.h"
#include "cli/program/session.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {
namespace {

GreyLevels read_of(const Camera& camera,
                   const std::string& rig_name,
                   const std::string& file,
                   Session& session) {
  GreyLevels image = read_image(file, session);
  if (Eigen::Vector2i(image.width_px, image.height_px) != camera.size_px) {
    throw Error(
        file,
        fmt::format("image size {}x{} differs from camera \"{}\" of {}, {}x{}", image.width_px,
                    image.height_px, camera.name, rig_name, camera.size_px[0], camera.size_px[1]),
        "give unmodified images of this rig's cameras, or the rig that took these");
  }
  return image;
}

}  // namespace

GreyLevels read_image(const std::string& file, Session& session) {
  std::string remark;
  GreyLevels image = read_grey_levels(file, &remark);
  if (!remark.empty()) session.info(file + ": " + remark);
  return image;
}

void check_two_images(const RectifiedPair& pair,
                      const std::string& left,
                      const std::string& right) {
  if (pair.left.values != pair.right.values) return;
  throw Error(right, "same image as " + left,
              "give the image that the right camera took at the same time");
}

RectifiedPair read_camera_images(const Rig& rig,
                                 const std::string& rig_name,
                                 const std::string& left,
                                 const std::string& right,
                                 Session& session) {
  require_pair(rig, rig_name, rig_name);
  RectifiedPair raw;
  raw.left = read_of(rig.cameras[0], rig_name, left, session);
  raw.right = read_of(rig.cameras[1], rig_name, right, session);
  check_two_images(raw, left, right);
  return raw;
}

}  // namespace vernier::cli
