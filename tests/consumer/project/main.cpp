// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <memory>

#include "calib/calibrate.h"
#include "calib/rig_file.h"
#include "calib/simulated_board.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/world_file.h"
#include "stereo/rectification.h"

namespace {

vernier::Camera camera(const char* name) {
  vernier::Camera result;
  result.name = name;
  result.parameters.resize(5);
  result.parameters << 525, 1, 319.5, 239.5, -0.05;
  return result;
}

vernier::Rig pair_of_cameras() {
  vernier::Rig rig;
  rig.cameras = {camera("left"), camera("right")};
  rig.T_camera_first = {vernier::Pose{}, {Eigen::Matrix3d::Identity(), {-0.2, 0, 0}}};
  return rig;
}

/// The whole chain once, so that every library and all that they link is needed.
int run(const char* world_file) {
  const vernier::Rig rig = pair_of_cameras();
  const auto board = vernier::simulate_board(rig, {.columns = 9, .rows = 6}, {.seed = 1});
  const vernier::RigEstimate calibrated = vernier::calibrate(board.observations);
  const auto read_back = vernier::parse_rig(vernier::format_rig(calibrated), "memory");
  std::printf("calibrated from %d views, residual %.3f px\n", calibrated.calibration->views,
              calibrated.calibration->rms_px);

  const vernier::stereo::Rectification turned =
      vernier::stereo::rectification(read_back.estimate.rig);
  std::printf("rectified: first row %.4f %.4f %.4f\n", turned.R_rectified_left(0, 0),
              turned.R_rectified_left(0, 1), turned.R_rectified_left(0, 2));

  const vernier::sim::World world = vernier::sim::build_world(vernier::sim::read_world(world_file));
  const vernier::sim::Visibility visibility(world);
  const vernier::sim::ExperimentSettings settings{
      .protocol = vernier::sim::QueryProtocol::near_path, .map_spacing_m = 2};
  const auto looks = std::make_shared<const vernier::sim::MapViews>(
      vernier::sim::map_views(visibility, calibrated.rig, settings));
  const vernier::sim::LocalisationExperiment experiment(visibility, calibrated, looks, settings);
  const auto results = experiment.run_block({.count = 2});
  for (const vernier::sim::TrialResult& trial : results) {
    std::printf("trial %u: %s, %d lines\n", trial.trial,
                std::string(vernier::localise::name(trial.status)).c_str(), trial.lines);
  }
  return results.size() == 2 && results[0].lines > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: consumer WORLD\n");
    return 2;
  }
  try {
    return run(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
