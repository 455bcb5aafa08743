// A robot that drives on command, and one that servos to a door by the image error of its frame.
#include <algorithm>
#include <cstdio>
#include <string>

#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "localise/place.h"
#include "sim/robot.h"
#include "sim/visibility.h"
#include "sim/visual_servo.h"
#include "sim/world_file.h"

using namespace vernier;
using namespace vernier::sim;

int main(int, char** argv) {
  const std::string share = argv[1];
  const RigEstimate rig = read_rig(share + "/rigs/nominal.rig.json").estimate;
  const World world = build_world(read_world(share + "/worlds/workshop.world.toml"));
  const Visibility visibility(world);

  // Ahead, unless something upright is near: the robot knows its wheels and its views, no more.
  Robot robot(visibility, rig);
  const localise::Pose2D start{.x_m = 10, .y_m = 7.5};
  RobotObservation seen = robot.reset(/*seed=*/1, /*trial=*/0, start);
  for (int step = 0; step < 20; ++step) {
    double widest_px = 0;
    for (const stereo::StereoSegment& edge : seen.view.segments) {
      widest_px = std::max(widest_px, edge.left.a_px.x() - edge.right.a_px.x());
    }
    const bool near = widest_px > 100;  // about a metre
    seen =
        robot.step({.speed_mps = near ? 0 : 0.4, .turn_radps = near ? 0.6 : 0, .duration_s = 0.5});
    if (seen.contact) std::printf("something is in the way after %.1f s\n", seen.time_s);
  }
  const localise::Pose2D believed = localise::compose(start, seen.odometry);
  std::printf("after %.0f s odometry is off by %.0f mm\n", seen.time_s,
              1e3 * localise::distance_m(believed, robot.true_pose()));

  // To a place 1.8 m in front of a door, as computed from the model and as the robot saw it before.
  RobotOptions options;
  options.sources.calibration = 3;
  for (const ServoGoal goal : {ServoGoal::model, ServoGoal::taught}) {
    ServoOptions servo;
    servo.goal = goal;
    const ServoTrial end = ServoExperiment(visibility, rig, options, servo).run(1, 2);
    std::printf("%s: %s, %.0f mm from the goal after %.0f s\n", std::string(name(goal)).c_str(),
                std::string(name(end.status)).c_str(), 1e3 * end.position_error_m, end.time_s);
  }
}
