// Calibrates a rig from matched corners of any scene and from what was known of it before.
#include <cstdio>
#include <random>
#include <string>

#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "calib/triangulation.h"

int main(int, char** argv) {
  using namespace vernier;
  const Rig truth = read_rig(std::string(argv[1]) + "/rigs/nominal.rig.json").estimate.rig;

  // The prior: an ideal rig, as a datasheet has it, with one standard deviation a parameter.
  Eigen::VectorXd sigma(parameter_count(truth));
  sigma << 5, 1e-3, 5, 5, 0.02, 5, 1e-3, 5, 5, 0.02, 0.01, 0.01, 0.01, 0.002, 0.002, 0.002;
  const Rig ideal = retract(truth, 0.5 * sigma);
  const GaussianRigPrior prior{ideal,
                               {CovarianceKind::prior, parameter_names(ideal),
                                Eigen::MatrixXd(sigma.array().square().matrix().asDiagonal())}};

  // Matches in four image pairs, with noise of 0.3 px (uniform, for brevity).
  std::mt19937_64 random(1);
  const auto between = [&](double a, double b) { return a + (b - a) * 0x1p-64 * random(); };
  PairObservations pairs;
  for (int image_pair = 0; image_pair < 4; ++image_pair) {
    for (int corner = 0; corner < 200; ++corner) {
      const Eigen::Vector3d x(between(-1.5, 1.5), between(-1, 1), between(3, 8));
      const auto seen = pixel_pair(truth, x);
      if (!seen || !in_image(truth.cameras[1], seen->other_px)) continue;
      Eigen::Vector4d pixels;
      pixels << seen->first_px, seen->other_px;
      for (double& pixel : pixels) pixel += between(-0.52, 0.52);
      add_pair(pairs, image_pair, pixels, /*sigma_px=*/0.3);
    }
  }

  const JointCalibration found = calibrate_from_pairs(pairs, prior);
  const Observability& seen = *found.observability;
  std::printf("%zu matches determine %.1f of %zu parameters\n", pairs.size(), seen.from_data,
              seen.directions.size());
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("  known %4.0f times as well: %s\n", 1 / seen.directions[i].sd_ratio,
                seen.directions[i].description.c_str());
  }
  std::printf("baseline known to %.2f mm before and %.2f mm after\n",
              1e3 * seen.baseline_sd_before_m, 1e3 * seen.baseline_sd_after_m);
}
