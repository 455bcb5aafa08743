#include <cstdio>

#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "calib/triangulation_uncertainty.h"

int main(int argc, char** argv) {
  using namespace vernier;
  // A rig and how well it is known, as `vernier calibrate` writes it.
  const RigEstimate rig = read_rig(argc > 1 ? argv[1] : "rig.json").estimate;

  // Draw rigs with correlated errors: SVD of the scaled covariance.
  const RigSampler sampler(rig);
  std::puts(sampler.decomposition().directions()[0].description.c_str());
  const Rig wrong = sampler.sample(/*psi_c=*/1, /*seed=*/1, /*trial=*/0);
  std::printf("focal length %.2f px instead of %.2f px\n", wrong.cameras[0].f_px(),
              rig.rig.cameras[0].f_px());

  // What that does to depth, linear and sampled side by side.
  for (const DepthUncertainty& u : depth_uncertainty(rig, {1, 5, 10})) {
    std::printf("at %4.0f m: %.4f m linear, %.4f m sampled\n", u.range_m, u.sigma_linear_m,
                u.sigma_sampled_m);
  }
}
