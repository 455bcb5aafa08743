// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/mrcal_uncertainty.h"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/program_run.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/mrcal/board_grid.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/pose.h"
#include "calib/triangulation.h"

namespace vernier::internal {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int no_mrcal = 4;  // the script's exit code if Python has no mrcal

template <typename Vector>
Json list(const Vector& values) {
  return std::vector<double>(values.begin(), values.end());
}

Json pose_json(const Pose& T) {
  const Eigen::Vector3d r = vector_from_rotation(T.R);
  return {r[0], r[1], r[2], T.t[0], T.t[1], T.t[2]};
}

void add_views(const BoardObservations& observations,
               const std::vector<int>& frames,
               const BoardGrid& grid,
               Json& json) {
  Json views = Json::array(), corners = Json::array();
  for (const BoardView& view : observations.views) {
    views.push_back({frame_index(frames, view.frame), view.camera});
    std::vector<double> cells(3 * grid.points(), 0);
    for (int i = 0; i < grid.points(); ++i) cells[3 * i + 2] = -1;  // not seen
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      double* cell = cells.data() + 3 * grid.cell[view.ids[i]];
      cell[0] = view.pixels_px[i].x();
      cell[1] = view.pixels_px[i].y();
      cell[2] = 1;
    }
    corners.push_back(std::move(cells));
  }
  json["views"] = std::move(views);
  json["corners"] = std::move(corners);
}

void add_state(const BoardState& state, const BoardGrid& grid, Json& json) {
  const MrcalLens lens = mrcal_lens(state.rig);
  json["lens"] = lens.name;
  json["intrinsics"] = json["sizes_px"] = json["camera_poses"] = json["board_poses"] =
      Json::array();
  for (std::size_t c = 0; c < state.rig.cameras.size(); ++c) {
    const Camera& camera = state.rig.cameras[c];
    Eigen::VectorXd a = Eigen::VectorXd::Zero(lens.parameters);
    a.head(camera.parameters.size()) = camera.parameters;
    a[0] = camera.f_px() * camera.ax();
    a[1] = camera.f_px();
    json["intrinsics"].push_back(list(a));
    json["sizes_px"].push_back({camera.size_px.x(), camera.size_px.y()});
    if (c > 0) json["camera_poses"].push_back(pose_json(state.rig.T_camera_first[c]));
  }
  for (const Pose& T : state.T_first_board) {
    json["board_poses"].push_back(pose_json({T.R, T * grid.origin_m}));
  }
  json["warp_m"] = list(state.warp_m);
}

Json basis_json(const std::optional<Eigen::MatrixXd>& basis) {
  if (!basis) return nullptr;
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < basis->rows(); ++i) {
    rows.push_back(list(Eigen::VectorXd(basis->row(i))));
  }
  return rows;
}

Json problem_json(const MrcalUncertaintyProblem& problem) {
  const BoardGrid grid = board_grid(problem.observations.target_m);
  Json json{{"columns", grid.columns},
            {"rows", grid.rows},
            {"spacing_m", grid.spacing_m},
            {"pixel_sigma_px", problem.pixel_sigma_px},
            {"basis", basis_json(problem.basis)},
            {"projection", Json::array()},
            {"triangulation", Json::array()}};
  add_state(problem.state, grid, json);
  add_views(problem.observations, problem.state.frames, grid, json);
  for (const MrcalProjectionQuery& query : problem.projection) {
    Json points = Json::array();
    for (const Eigen::Vector3d& point : query.points) points.push_back(list(point));
    json["projection"].push_back(
        {{"camera", query.camera}, {"at_infinity", query.at_infinity}, {"points", points}});
  }
  for (const MrcalTriangulationQuery& query : problem.triangulation) {
    Json pixels = Json::array();
    for (const PixelPair& pair : query.pairs) {
      pixels.push_back(
          {pair.first_px.x(), pair.first_px.y(), pair.other_px.x(), pair.other_px.y()});
    }
    json["triangulation"].push_back(
        {{"other", query.other}, {"stabilised", query.stabilised}, {"pixels", pixels}});
  }
  return json;
}

/// Runs the script with the first Python that has mrcal. If none has, returns the output of the
/// first one that could be run, with exit code no_mrcal; -1 if none can be run.
ProgramRun run_script(const fs::path& script, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"", script.string()});
  ProgramRun answer;
  for (const char* python : {"/usr/bin/python3", "python3"}) {
    arguments[0] = python;
    ProgramRun run = run_program(arguments);
    if (run.exit_code != -1 && run.exit_code != no_mrcal) return run;
    if (answer.exit_code == -1) answer = std::move(run);
  }
  return answer;
}

}  // namespace

MrcalUncertaintyAnswer run_mrcal_uncertainty(const fs::path& script,
                                             const MrcalUncertaintyProblem& problem) {
  MrcalUncertaintyAnswer none;
  if (!script.is_absolute() || !fs::is_regular_file(script)) {
    none.absent = "the script " + script.string() + " is missing: install Vernier again";
    return none;
  }
  const TemporaryFolder folder;
  const fs::path question = folder.write("problem.json", problem_json(problem).dump());
  const fs::path reply = folder.path() / "answer.json";
  const ProgramRun run = run_script(script, {question.string(), reply.string()});
  if (run.exit_code == -1) none.absent = "no Python can be run";
  if (run.exit_code == no_mrcal) none.absent = "no Python has mrcal: " + run.last_output_line();
  if (!none.absent.empty()) return none;
  if (run.exit_code != 0) {
    throw Error("mrcal", "its Python failed: " + run.last_output_line(), "leave mrcal out");
  }
  return parse_mrcal_answer(fs::exists(reply) ? read_whole(reply) : "", problem);
}

std::string mrcal_python_version(const fs::path& script) {
  const ProgramRun run = run_script(script, {"--version"});
  if (run.exit_code != 0) return "";
  return run.output.substr(0, run.output.find('\n'));
}

}  // namespace vernier::internal
