// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/corner_json.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "calib/base/all_within.h"
#include "calib/base/json_node.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "localise/views/view_json.h"

namespace vernier::localise::internal {

using vernier::internal::all_within;
using vernier::internal::JsonNode;

namespace {

Eigen::Vector2d parse_pixel(const JsonNode& node, const Camera& camera) {
  const Eigen::VectorXd pixel = node.vector();
  if (pixel.size() != 2) throw Error(node.place(), "is not a list of 2 numbers", "give u, v");
  if (!all_within(pixel, 2.0 * camera.size_px.maxCoeff())) {
    throw Error(node.place(), "lies far off the image", "give pixels of the image");
  }
  return pixel;
}

Eigen::Matrix4d parse_covariance(const JsonNode& node) {
  const Eigen::MatrixXd C = node.matrix();
  if (C.rows() != 4) {
    throw Error(node.place(), "is not a 4 x 4 matrix", "give that of left u, v, right u, v");
  }
  if (C != C.transpose() || C.llt().info() != Eigen::Success) {
    throw Error(node.place(), "is not symmetric and positive definite", "give px²");
  }
  return C;
}

Eigen::VectorXf parse_descriptor(const JsonNode& node, Eigen::Index size) {
  constexpr std::size_t longest = 1024;
  const std::size_t length = node.array().size();
  if (length == 0 || length > longest) {
    throw Error(node.place(), fmt::format("has {} entries", length),
                fmt::format("give 1 to {} numbers", longest));
  }
  Eigen::VectorXf descriptor = node.vector().cast<float>();
  if (!descriptor.allFinite()) {
    throw Error(node.place(), "has an entry beyond all limits", "scale it to unit length");
  }
  if (size > 0 && descriptor.size() != size) {
    throw Error(node.place(),
                fmt::format("has {} entries, that of the first corner {}", length, size),
                "describe all corners in the same way");
  }
  return descriptor;
}

template <class Vector>
Json numbers_json(const Vector& x) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < x.size(); ++i) json.push_back(x[i]);
  return json;
}

Json corner_json(const StereoCorner& corner) {
  Json json{{"left_px", numbers_json(corner.left_px)}, {"right_px", numbers_json(corner.right_px)}};
  Json& rows = json["covariance_px2"] = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back(numbers_json(corner.covariance_px2.row(i)));
  if (corner.descriptor.size() > 0) json["descriptor"] = numbers_json(corner.descriptor);
  return json;
}

}  // namespace

std::vector<StereoCorner> parse_corners(const JsonNode& node, const Rig* rig) {
  if (!rig) {
    throw Error(node.place(), "corners need the cameras that saw them",
                "give a rig, or \"cameras\" with each view");
  }
  std::vector<StereoCorner> corners;
  for (std::size_t i = 0; i < node.size(); ++i) {
    const JsonNode pair = node.at(i);
    check_spelling(pair, {"left_px", "right_px", "covariance_px2", "descriptor"});
    StereoCorner corner;
    corner.left_px = parse_pixel(pair.at("left_px"), rig->cameras[0]);
    corner.right_px = parse_pixel(pair.at("right_px"), rig->cameras[1]);
    if (pair.has("covariance_px2")) {
      corner.covariance_px2 = parse_covariance(pair.at("covariance_px2"));
    }
    const Eigen::Index size = i == 0 ? 0 : corners[0].descriptor.size();
    if (i > 0 && pair.has("descriptor") != (size > 0)) {
      throw Error(pair.place(), "only some corners have a descriptor", "give it with all or none");
    }
    if (pair.has("descriptor")) corner.descriptor = parse_descriptor(pair.at("descriptor"), size);
    corners.push_back(std::move(corner));
  }
  return corners;
}

Json corners_json(std::span<const StereoCorner> corners) {
  Json json = Json::array();
  for (const StereoCorner& corner : corners) json.push_back(corner_json(corner));
  return json;
}

}  // namespace vernier::localise::internal
