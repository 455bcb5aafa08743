// Stereo odometry past the corners of a simulated building: its drift, and whether the covariance
// of its steps is true.
#include <cstdio>
#include <string>
#include <vector>

#include "calib/rig_file.h"
#include "localise/place.h"
#include "localise/trajectory.h"
#include "sim/corner_drive.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"

int main(int, char** argv) {
  using namespace vernier;
  const std::string share = argv[1];
  const Rig rig = read_rig(share + "/rigs/nominal.rig.json").estimate.rig;
  const sim::World world = sim::build_world(sim::read_world(share + "/worlds/workshop.world.toml"));
  const sim::Visibility visibility(world);

  sim::SourceSettings sources = sim::no_sources();
  sources.corner_sigma_px = 0.15;  // the noise of both coordinates of both pixels
  const double step_m = 0.25, turn_rad = 0.1;
  const auto poses = sim::drive_poses(world.route.front(), step_m, turn_rad);
  const sim::CornerDrive seen = sim::drive_past_corners(visibility, rig, sources, {.height_m = 1.2},
                                                        poses, /*seed=*/1, /*trial=*/0);

  // From here as with corners of images, which corners_of_pair() in localise/pair_corners.h gives.
  const localise::OdometryPath path = localise::odometry_path(rig, seen.moments);
  int found = 0;
  double nees = 0;
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    if (!path.steps[i]) continue;
    ++found;
    nees += localise::step_nees(*path.steps[i],
                                seen.T_world_left[i].inverse() * seen.T_world_left[i + 1]);
  }
  const localise::TrajectoryDrift drift =
      localise::drift_of(path.T_first_camera, seen.T_world_left, /*segment_m=*/5);
  std::printf("%d of %zu steps, mean squared error in units of their covariance %.1f (6: true)\n",
              found, path.steps.size(), nees / found);
  std::printf("%.3f m off after %.1f m\n", drift.end_error_m, drift.length_m);
  const std::vector<localise::TimedPose> end{{0, path.T_first_camera.back()}};
  std::printf("%s", localise::tum_text(end).c_str());
}
