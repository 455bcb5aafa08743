// What a calibration's covariance means for pixels, for a point in space, and for depth.
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "calib/projection_uncertainty.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"

int main(int, char** argv) {
  using namespace vernier;
  const RigEstimate estimate = read_rig(std::string(argv[1]) + "/rigs/nominal.rig.json").estimate;
  // honest: the cluster-robust covariance, not the bound.
  const RigAndBoards joint = rig_and_boards(estimate, CovarianceChoice::honest);

  const ProjectionUncertainty left(joint, /*camera=*/0, PointFixedTo::boards);
  for (const double range_m : {1.0, 5.0, std::numeric_limits<double>::infinity()}) {
    const auto centre = left.covariance({320, 240}, range_m),
               corner = left.covariance({5, 5}, range_m);
    std::printf("at %3.0f m: left pixel known to %.3f px in the middle, %.3f px in a corner\n",
                range_m, worst_sd(*centre), worst_sd(*corner));
  }

  const TriangulationUncertainty space(joint, TriangulationFrame::rig);
  const PixelPair pair = *pixel_pair(estimate.rig, {0.5, 0.2, 4});
  const TriangulatedPoint point = *space.at(pair, /*pair_sigma_px=*/0.2);
  std::printf("z = %.3f m: %.1f mm by the calibration, %.1f mm by 0.2 px of noise\n", point.x_m.z(),
              1e3 * std::sqrt(point.calibration(2, 2)), 1e3 * std::sqrt(point.observation(2, 2)));

  for (const double psi_c : {1.0, 10.0}) {
    const DepthUncertainty far = depth_uncertainty(estimate, {5}, {.psi_c = psi_c})[0];
    std::printf("psi_c = %2.0f at 5 m: %.3f m linear, %.3f m sampled\n", psi_c, far.sigma_linear_m,
                far.sigma_sampled_m);
  }

  // The same by hand: any function of the rig, evaluated under sampled rigs.
  const RigSampler sampler(estimate);
  double squares = 0;
  for (std::uint32_t draw = 0; draw < 1000; ++draw) {
    const Rig rig = sampler.sample(/*psi_c=*/1, /*seed=*/1, draw);
    squares += std::pow(triangulated_depth_m(rig, pair) - 4, 2);
  }
  std::printf("1000 sampled rigs: %.1f mm\n", 1e3 * std::sqrt(squares / 1000));
}
