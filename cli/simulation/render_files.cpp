// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/render_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <string_view>
#include <utility>

#include "calib/base/output_files.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/picture.h"
#include "cli/program/session.h"
#include "sim/images/image_truth.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/true_edges.h"
#include "sim/images/wire_paint.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"
#include "stereo/segment.h"
#include "stereo/stereo_truth.h"

namespace vernier::cli {
namespace {

std::string grey_png(const GreyLevels& image) { return png_of(bytes_of(image)); }

/// 255 where the right eye does not see what the left one does, or nothing is known.
std::string occluded_png(const PairTruth& truth) {
  const StereoTruth both = stereo_truth(truth.left, &truth.right);
  GreyLevels mask{truth.left.width_px, truth.left.height_px, {}};
  mask.values.reserve(both.occluded.size());
  for (std::size_t i = 0; i < both.occluded.size(); ++i) {
    const bool known = !std::isnan(truth.left.values[i]);
    mask.values.push_back(known && both.occluded[i] == 0 ? 0.0F : 255.0F);
  }
  return grey_png(mask);
}

DisparityMap depth_map(const PairTruth& truth) {
  DisparityMap map{truth.left.width_px, truth.left.height_px, {}};
  for (const double z : truth.left_depth_m) map.values.push_back(static_cast<float>(z));
  return map;
}

Json ends_json(const ImageSegment& s) { return {s.a_px.x(), s.a_px.y(), s.b_px.x(), s.b_px.y()}; }

std::string edges_json(const TrueEdges& edges) {
  Json json;
  json["format"] = "vernier/edges";
  json["version"] = 1;
  json["edges"] = Json::array();
  for (const TrueEdge& e : edges.both) {
    json["edges"].push_back({{"segment", e.segment},
                             {"shown_as", name(e.appearance)},
                             {"left_px", ends_json(e.left_px)},
                             {"disparity_px", {e.disparity_px[0], e.disparity_px[1]}},
                             {"ends", {name(e.ends[0]), name(e.ends[1])}},
                             {"depth_m", e.depth_m}});
  }
  for (const auto& [key, eye] : {std::pair{"left_eye_px", 0}, std::pair{"right_eye_px", 1}}) {
    json[key] = Json::array();
    for (const ImageSegment& s : edges.of_eye[static_cast<std::size_t>(eye)]) {
      json[key].push_back(ends_json(s));
    }
  }
  return json.dump() + "\n";
}

}  // namespace

const std::vector<std::filesystem::path>& view_file_names() {
  static const std::vector<std::filesystem::path> names{"left.png",
                                                        "right.png",
                                                        "edges.json",
                                                        "rectified/left.png",
                                                        "rectified/right.png",
                                                        "rectified/rig.json",
                                                        "rectified/disparity.pfm",
                                                        "rectified/right_disparity.pfm",
                                                        "rectified/depth.pfm",
                                                        "rectified/occluded.png"};
  return names;
}

void add_view_files(OutputFiles& outputs,
                    const std::filesystem::path& folder,
                    const RectifiedView& view,
                    const RenderedView& rendered) {
  const std::filesystem::path rectified = folder / "rectified";
  outputs.add_folder(folder);
  outputs.add_folder(rectified);
  RigEstimate rig;
  rig.rig = view.rig;
  outputs.add(folder / "left.png", grey_png(rendered.pair.left));
  outputs.add(folder / "right.png", grey_png(rendered.pair.right));
  outputs.add(folder / "edges.json", edges_json(rendered.edges));
  outputs.add(rectified / "left.png", grey_png(rendered.pair.rectified.pair.left));
  outputs.add(rectified / "right.png", grey_png(rendered.pair.rectified.pair.right));
  outputs.add(rectified / "rig.json", format_rig(rig));
  outputs.add(rectified / "disparity.pfm", disparity_pfm(rendered.truth.left));
  outputs.add(rectified / "right_disparity.pfm", disparity_pfm(rendered.truth.right));
  outputs.add(rectified / "depth.pfm", disparity_pfm(depth_map(rendered.truth)));
  outputs.add(rectified / "occluded.png", occluded_png(rendered.truth));
}

std::string pair_toml(const std::string& name, const std::string& folder, const PairTruth& truth) {
  const std::string rectified = folder + "rectified/";
  return fmt::format(
      "[[pair]]\nname = \"{}\"\nleft = \"{}left.png\"\nright = \"{}right.png\"\n"
      "truth = \"{}disparity.pfm\"\nright_truth = \"{}right_disparity.pfm\"\n"
      "truth_kind = \"exact\"\nmin_disparity = 0\nmax_disparity = {}\nrig = \"{}rig.json\"\n\n",
      name, rectified, rectified, rectified, rectified, search_range(truth.left).max_px, rectified);
}

}  // namespace vernier::cli
