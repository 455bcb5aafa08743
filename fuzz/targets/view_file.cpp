// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/view_file.h"

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "datasets/shipped.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/program_answer.h"
#include "localise/localiser.h"
#include "localise/methods/program_localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::fuzz {
namespace {

using namespace localise;

const std::shared_ptr<const Rig>& fuzz_rig() {
  static const auto rig = std::make_shared<const Rig>(datasets::nominal().rig);
  return rig;
}

void require_same_views(const std::vector<RecordedLooks>& a, const std::vector<RecordedLooks>& b) {
  require(a.size() == b.size(), "the positions are kept");
  for (std::size_t i = 0; i < a.size(); ++i) {
    require(
        a[i].pose.has_value() == b[i].pose.has_value() && a[i].looks.size() == b[i].looks.size(),
        "poses and looks are kept");
    for (std::size_t k = 0; k < a[i].looks.size(); ++k) {
      const PlaceView &p = a[i].looks[k].view, &q = b[i].looks[k].view;
      require(p.lines.size() == q.lines.size() && p.image_lines.size() == q.image_lines.size() &&
                  p.monocular_lines.size() == q.monocular_lines.size(),
              "lines are kept");
      require(p.corners.size() == q.corners.size(), "corners are kept");
      for (std::size_t n = 0; n < p.corners.size(); ++n) {
        require(p.corners[n].left_px == q.corners[n].left_px &&
                    p.corners[n].covariance_px2 == q.corners[n].covariance_px2 &&
                    p.corners[n].descriptor == q.corners[n].descriptor,
                "corners are kept as they are");
      }
      for (std::size_t n = 0; n < p.lines.size(); ++n) {
        require(p.lines[n].kind == q.lines[n].kind && p.lines[n].sigma_m == q.lines[n].sigma_m,
                "lines are kept as they are");
        require(p.lines[n].a_m.allFinite() && p.lines[n].length_m() > 0, "lines are lines");
      }
    }
  }
}

void run_view_file(std::string_view bytes) {
  const auto views = accepted([&] { return read_views(input_file(bytes, "v.jsonl"), fuzz_rig()); });
  if (!views) return;
  // Segments become lines, which may lie further away, or less surely, than lines of a file may.
  for (const RecordedLooks& recorded : *views) {
    for (const Look& look : recorded.looks) {
      for (const PlaceLine& line : look.view.lines) {
        if (line.a_m.cwiseAbs().maxCoeff() > 900 || line.b_m.cwiseAbs().maxCoeff() > 900 ||
            line.sigma_m > 1e5) {
          return;
        }
      }
      for (const auto& line : look.view.image_lines) {
        if (line.a_px.cwiseAbs().maxCoeff() < 5) return;  // a part of them would be refused
      }
    }
  }
  const std::filesystem::path written = input_folder() / "w.jsonl";
  write_views(written, *views);
  require_same_views(*views, read_views(written, fuzz_rig()));
}

std::vector<std::string> view_file_seeds() {
  PlaceView view;
  view.lines = {{{2, 0.5, 0.25}, {2, 0.5, 1.5}, LineKind::vertical, 0.02},
                {{3, -1, 0.5}, {3, 1, 0.5}, LineKind::level, 0.05}};
  view.image_lines = {{{10, 20}, {10.5, 200}}};
  view.monocular_lines = {{{10, 20}, {300.25, 21}}};
  std::vector<RecordedLooks> views{{{{view, 0}}, Pose2D{1, -2, 0.5}}};
  std::vector<std::string> seeds;
  const std::filesystem::path file = input_folder() / "seed.jsonl";
  write_views(file, views);
  seeds.push_back(file_bytes(file));
  view.rig = fuzz_rig();
  view.corners = {{{100, 50},
                   {90, 50.5},
                   0.1 * Eigen::Matrix4d::Identity(),
                   Eigen::VectorXf::LinSpaced(5, -1, 1)}};
  views.push_back({{{view, 0}, {view, 1.5}}, {}});
  write_views(file, views);
  seeds.push_back(file_bytes(file));
  seeds.emplace_back(
      R"({"segments":[{"left_px":[320,100,321,300],"right_px":[300,100,301,300]}]})");
  return seeds;
}

void run_localiser_answer(std::string_view bytes) {
  TopologicalMap map;
  map.nodes.resize(3);
  const auto answer = accepted_answer(
      bytes, [&](const auto& said) { return localise::internal::parse_answer(said, map); });
  if (!answer) return;
  require(std::isfinite(answer->pose.x_m) && std::isfinite(answer->pose.heading_rad),
          "poses are finite");
  require(answer->node >= -1 && answer->node < 3, "the node is one of the map");
  require(answer->probability >= 0 && answer->probability <= 1, "a probability is one");
}

std::vector<std::string> localiser_answer_seeds() {
  return {R"({"status":"answered","pose":[1,2,0.5],"node":1,"score":-3,"probability":0.75})",
          R"({"status":"unsure","pose":[1,2,0.5],"next_turn_rad":1.5,"runner_up":2})",
          R"({"status":"no_match","node":null})"};
}

const Registered registered_view_file{{"view_file", 6000, "views", run_view_file, view_file_seeds}};
const Registered registered_localiser_answer{
    {"localiser_answer", 1000, "views", run_localiser_answer, localiser_answer_seeds}};

}  // namespace
}  // namespace vernier::fuzz
