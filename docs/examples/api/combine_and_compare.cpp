// Asks whether two calibrations of one rig agree, and makes one of them.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "calib/calibrate.h"
#include "calib/combine.h"
#include "calib/rig_difference.h"
#include "calib/rig_file.h"
#include "calib/simulated_board.h"

int main(int, char** argv) {
  using namespace vernier;
  const Rig truth = read_rig(std::string(argv[1]) + "/rigs/nominal.rig.json").estimate.rig;

  // Monday's and Friday's views are of the same rig; after a knock the right camera is turned.
  Rig knocked = truth;
  knocked.T_camera_first[1].R = rotation_from_vector({0, 0.003, 0}) * knocked.T_camera_first[1].R;
  const auto calibrated = [](const Rig& rig, std::uint64_t seed) {
    return calibrate(
        simulate_board(rig, {.columns = 9, .rows = 6, .square_m = 0.04}, {.seed = seed})
            .observations);
  };
  const RigEstimate monday = calibrated(truth, 1), friday = calibrated(truth, 2),
                    after = calibrated(knocked, 3);

  for (const RigEstimate* later : {&friday, &after}) {
    const RigDifference d =
        rig_difference(monday.rig, *monday.covariance, later->rig, *later->covariance);
    std::printf("d2 = %.1f with %d degrees of freedom, p = %.2g; most along: %s\n", d.mahalanobis2,
                d.dof, d.p_value, d.directions[0].description.c_str());
  }

  const Combination all = combine({{.name = "monday", .estimate = monday, .pairs = {}},
                                   {.name = "friday", .estimate = friday, .pairs = {}},
                                   {.name = "after", .estimate = after, .pairs = {}}});
  for (const CombinedInput& input : all.inputs) {
    std::printf("%s: %s, p = %.2g\n", input.name.c_str(), input.used ? "used" : "left out",
                input.agreement.p_value);
  }
  const auto sigma_f = [](const RigEstimate& rig) {
    return std::sqrt(rig.covariance->matrix(0, 0));
  };
  std::printf("left focal length known to %.3f px from one, %.3f px from both\n", sigma_f(monday),
              sigma_f(all.joint.estimate));
}
