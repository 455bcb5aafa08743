// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/rig_json.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/base/json_reader.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal::rig_json {
Json parse_rig_json(const std::string& text, const std::string& place) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw Error(place, "is empty", "write a rig file with vernier calibrate");
  }
  try {
    return parse_json(text, place);
  } catch (const Error&) {
    if (text.find("vernier/rig") != std::string::npos) throw;
    throw Error(place, "is not a rig file",
                "vernier convert reads files of Kalibr, OpenCV, ROS, mrcal, COLMAP, ASL and KITTI");
  }
}

Json to_json(const Eigen::VectorXd& v) {
  Json json = Json::array();
  for (const double x : v) json.push_back(x);
  return json;
}

Json to_json(const Eigen::MatrixXd& m) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) json.push_back(to_json(Eigen::VectorXd(m.row(i))));
  return json;
}

int camera_index(const Node& name, const Rig& rig) {
  const std::string text = name.text();
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (rig.cameras[c].name == text) return static_cast<int>(c);
  }
  throw Error(name.place(), "the rig has no camera " + in_quotes(text), "");
}

Json to_json(const PairOutlier& o) {
  return {{"pair", o.image_pair},
          {"row", o.row},
          {"pixels_px", to_json(Eigen::VectorXd(o.pixels_px))},
          {"residual_px", o.residual_px}};
}

PairOutlier parse_pair_outlier(const Node& node) {
  PairOutlier o;
  o.image_pair = node.at("pair").integer();
  const int row = node.at("row").integer();
  if (row < 0) throw Error(node.at("row").place(), "is below 0", "");
  o.row = static_cast<std::size_t>(row);
  const Eigen::VectorXd y = node.at("pixels_px").vector();
  if (y.size() != 4) throw Error(node.at("pixels_px").place(), "is not two pixels", "");
  check_bounded(y, most_side_px, node.at("pixels_px"));
  o.pixels_px = y;
  o.residual_px = node.at("residual_px").number();
  return o;
}

namespace {

/// The double with the same shortest decimal form as its float.
double shortest(double of_float) {
  return to_real(fmt::format("{}", static_cast<float>(of_float))).value_or(of_float);
}

/// The image pairs in order: number, pixels four by four, noise.
Json pairs_json(const PairObservations& pairs) {
  Json json = Json::array();
  for (const ImagePair& image : pairs.image_pairs) {
    Json one{{"pair", image.number}};
    Json pixels = Json::array(), sigma = Json::array();
    bool same = true;
    for (std::size_t i = image.first; i < image.first + image.count; ++i) {
      for (const double value : pairs.pixels_px[i]) pixels.push_back(value);
      sigma.push_back(shortest(pairs.sigma_of(i)));
      same = same && pairs.sigma_of(i) == pairs.sigma_of(image.first);
    }
    one["pixels_px"] = std::move(pixels);
    one["sigma_px"] = same ? sigma[0] : sigma;
    json.push_back(std::move(one));
  }
  return json;
}

PairObservations parse_pairs(const Node& node) {
  PairObservations pairs;
  for (std::size_t k = 0; k < node.array().size(); ++k) {
    const Node one = node.at(k);
    const Eigen::VectorXd y = one.at("pixels_px").vector();
    const Node noise = one.at("sigma_px");
    const auto count = y.size() / 4;
    Eigen::VectorXd sigma = noise.json().is_number()
                                ? Eigen::VectorXd::Constant(count, noise.number())
                                : noise.vector();
    if (y.size() % 4 != 0 || sigma.size() != count) {
      throw Error(one.place(), "its pixels and its noise differ in number",
                  "give four coordinates and one sigma_px per match");
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      add_pair(pairs, one.at("pair").integer(), y.segment<4>(4 * i), sigma[i]);
    }
  }
  return pairs;
}

}  // namespace

Json evidence_json(const CalibrationEvidence& evidence, const Rig& rig) {
  Json json;
  const BoardObservations& observations = evidence.observations;
  if (evidence.pairs.size() > 0) json["pairs"] = pairs_json(evidence.pairs);
  if (observations.views.empty()) return json;
  json["board"]["points_m"] = Json::array();
  for (const auto& X : observations.target_m) {
    json["board"]["points_m"].push_back(to_json(Eigen::VectorXd(X)));
  }
  if (!evidence.warp_m.isZero(0)) {
    json["board"]["warp_m"] = {evidence.warp_m.x(), evidence.warp_m.y()};
  }
  json["observations"] = Json::array();
  for (const BoardView& view : observations.views) {
    Json v;
    v["frame"] = view.frame;
    v["camera"] = rig.cameras[view.camera].name;
    if (!view.image.empty()) v["image"] = view.image;
    bool whole = view.ids.size() == observations.target_m.size();
    for (std::size_t i = 0; whole && i < view.ids.size(); ++i) {
      whole = view.ids[i] == static_cast<int>(i);
    }
    if (!whole) v["ids"] = view.ids;  // omitted if the whole target was seen in order
    v["pixels_px"] = Json::array();
    for (const auto& q : view.pixels_px) v["pixels_px"].push_back({q.x(), q.y()});
    json["observations"].push_back(std::move(v));
  }
  json["view_poses"] = Json::array();
  for (std::size_t f = 0; f < evidence.frames.size(); ++f) {
    const Pose& T = evidence.T_first_board[f];
    json["view_poses"].push_back(
        {{"frame", evidence.frames[f]},
         {"rotation_rad", to_json(Eigen::VectorXd(vector_from_rotation(T.R)))},
         {"translation_m", to_json(Eigen::VectorXd(T.t))}});
  }
  return json;
}

namespace {

BoardView parse_view(const Node& v, const Rig& rig) {
  BoardView view;
  view.frame = v.at("frame").integer();
  view.camera = camera_index(v.at("camera"), rig);
  if (v.has("image")) view.image = v.at("image").text();
  const Node pixels = v.at("pixels_px");
  if (v.has("ids") && v.at("ids").array().size() != pixels.array().size()) {
    throw Error(v.at("ids").place(),
                "holds " + std::to_string(v.at("ids").size()) + " corners for " +
                    std::to_string(pixels.size()) + " pixels",
                "give one per pixel");
  }
  for (std::size_t k = 0; k < pixels.array().size(); ++k) {
    const Eigen::VectorXd q = pixels.at(k).vector();
    if (q.size() != 2) throw Error(pixels.at(k).place(), "is not a pixel", "");
    view.pixels_px.emplace_back(q);
    view.ids.push_back(v.has("ids") ? v.at("ids").at(k).integer() : static_cast<int>(k));
  }
  return view;
}

}  // namespace

CalibrationEvidence parse_evidence(const Node& node, const Rig& rig) {
  CalibrationEvidence evidence;
  BoardObservations& observations = evidence.observations;
  for (const Camera& camera : rig.cameras) observations.size_px.push_back(camera.size_px);
  if (node.has("pairs")) {
    evidence.pairs = parse_pairs(node.at("pairs"));
    check_pairs(evidence.pairs, rig);
  }
  if (!node.has("board") && (node.has("pairs") || node.has("priors"))) return evidence;
  const Node points = node.at("board").at("points_m");
  for (std::size_t i = 0; i < points.array().size(); ++i) {
    observations.target_m.push_back(points.at(i).vector3());
  }
  if (node.at("board").has("warp_m")) {
    const Eigen::VectorXd warp = node.at("board").at("warp_m").vector();
    if (warp.size() != 2) throw Error(node.at("board").at("warp_m").place(), "is not a pair", "");
    evidence.warp_m = warp;
  }
  const Node views = node.at("observations");
  for (std::size_t i = 0; i < views.array().size(); ++i) {
    observations.views.push_back(parse_view(views.at(i), rig));
  }
  const Node poses = node.at("view_poses");
  for (std::size_t i = 0; i < poses.array().size(); ++i) {
    const Node p = poses.at(i);
    evidence.frames.push_back(p.at("frame").integer());
    evidence.T_first_board.push_back(
        {rotation_from_vector(p.at("rotation_rad").vector3()), p.at("translation_m").vector3()});
  }
  check_and_sort(observations);
  if (frames_of(observations) != evidence.frames) {
    throw Error(poses.place(), "its frames are not those of the observations", "");
  }
  return evidence;
}

}  // namespace vernier::internal::rig_json
