// Calibrates a rig from views of a chessboard and writes it with all that is known of it.
#include <cmath>
#include <cstdio>
#include <string>

#include "calib/calibrate.h"
#include "calib/rig_file.h"
#include "calib/simulated_board.h"

int main(int, char** argv) {
  using namespace vernier;
  const Rig truth = read_rig(std::string(argv[1]) + "/rigs/nominal.rig.json").estimate.rig;

  // Thirteen views with 0.2 px of noise. From images: detect_images in calib/board_detection.h.
  const SimulatedBoard board = simulate_board(truth, {.columns = 9, .rows = 6, .square_m = 0.04},
                                              {.seed = 1, .frames = 13, .pixel_sigma_px = 0.2});
  const RigEstimate found = calibrate(board.observations, {.model = Radial1{}});

  const Eigen::VectorXd values = parameters(found.rig), offset = difference(found.rig, truth);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double sigma = std::sqrt(found.covariance->matrix(i, i));
    const double bound = std::sqrt((*found.covariance_mvb)(i, i));
    std::printf("%-14s %11.5f  sigma %.5f (bound %.5f), off by %+.1f sigma\n",
                found.covariance->names[i].c_str(), values[i], sigma, bound, offset[i] / sigma);
  }
  std::printf("%d views, residual %.3f px, covariance: %s\n", found.calibration->views,
              found.calibration->rms_px, std::string(name(found.covariance->kind)).c_str());
  for (const std::string& warning : found.calibration->warnings) std::puts(warning.c_str());
  write_rig(found, "calibrated.rig.json");
}
