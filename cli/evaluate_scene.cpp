// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/evaluate_scene.h"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>

#include "calib/error.h"
#include "cli/exchanged_pair.h"
#include "stereo/canny_edges.h"
#include "stereo/vertical_field.h"

namespace vernier::cli {
namespace {

constexpr int timed_runs = 3;

/// CPU time of this thread, and of programs that were run and have ended.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  rusage ended{};
  getrusage(RUSAGE_CHILDREN, &ended);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec) +
         ms(ended.ru_utime) + ms(ended.ru_stime);
}

/// Corners that match only the other way round.
void check_corners_not_exchanged(const Scene& scene, const VerticalField& field) {
  if (field.known || !field.unrectified) return;
  const VerticalField other = vertical_field({scene.pair.right, scene.pair.left}, scene.file.range);
  if (!other.known || other.unrectified) return;
  throw Error(scene.file.left.string(),
              fmt::format("left and right seem exchanged: {} corners match as given, {} the other "
                          "way round",
                          field.matched, other.matched),
              "exchange --left and --right");
}

void repair(Scene& scene, bool wanted, Session& session) {
  const VerticalField field = vertical_field(scene.pair, scene.file.range);
  check_corners_not_exchanged(scene, field);
  if (!field.significant && !field.unrectified && !wanted) return;
  session.say(scene.file.name + ": " + describe(field));
  if (field.unrectified) {
    session.warn(scene.file.name + ": rectify the pair first (vernier rectify)");
  } else if (field.significant && wanted) {
    scene.pair.right = repaired_right(scene.pair.right, field);
  } else if (field.significant) {
    session.warn(scene.file.name + ": its rows are not quite the same; --repair takes that away");
  }
}

}  // namespace

Scene read_scene(const StereoSceneFile& file, bool wants_repair, Session& session) {
  Scene scene{file, {}, {}, {}, {}, 0};
  for (const bool left : {true, false}) {
    std::string remark;
    (left ? scene.pair.left : scene.pair.right) =
        read_grey_levels(left ? file.left : file.right, &remark);
    if (!remark.empty()) session.say((left ? file.left : file.right).string() + ": " + remark);
  }
  const GreyLevels &left = scene.pair.left, &right = scene.pair.right;
  if (left.width_px != right.width_px || left.height_px != right.height_px) {
    throw Error(file.right.string(),
                fmt::format("it is {}x{}, the left image {}x{}", right.width_px, right.height_px,
                            left.width_px, left.height_px),
                "give a rectified pair of one size");
  }
  scene.map = read_stereo_truth(file, left.width_px, left.height_px);
  repair(scene, wants_repair, session);
  const double start = cpu_ms();
  scene.edges = canny_edges(left);
  scene.edges_ms = cpu_ms() - start;
  if (scene.edges.empty()) {
    throw Error(file.left.string(), "it has no edges", "give an image of something");
  }
  scene.truth = truth_at(scene.map, scene.edges);
  return scene;
}

Run run_matcher(const Matcher& matcher, const Scene& scene, const EvaluationOptions& how) {
  Run run;
  std::vector<double> times;
  for (int i = 0; i < timed_runs; ++i) {
    const double start = cpu_ms();
    run.found = matcher.match(scene.pair, scene.edges, scene.file.range);
    times.push_back(cpu_ms() - start);
  }
  std::sort(times.begin(), times.end());
  run.time_ms = times[timed_runs / 2] + (matcher.of_edges ? scene.edges_ms : 0);
  run.score = evaluate(scene.edges, run.found, scene.truth, scene.pair.left.width_px, how);
  return run;
}

void check_not_exchanged(const Matcher& matcher, const Scene& scene, const Run& run) {
  check_not_exchanged(
      matcher, run.found, scene.file.range,
      [&] {
        return RectifiedPair{scene.pair.right, scene.pair.left};
      },
      scene.file.left.string());
}

}  // namespace vernier::cli
