// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/evaluate_scene.h"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "calib/error.h"
#include "cli/program/camera_images.h"
#include "cli/program/session.h"
#include "cli/stereo/swapped_pair.h"
#include "cli/stereo/vertical_field_json.h"
#include "stereo/canny_edges.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/matcher_input.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/stereo_truth.h"

namespace vernier::cli {
namespace {

constexpr int timed_runs = 3;

/// CPU time of this thread and of finished child processes.
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

/// Throws Error if corners match only with the images swapped. A truth outside the range explains
/// why they do not match.
void check_corners_not_swapped(const Scene& scene, const VerticalField& field) {
  if (field.known || !field.unrectified || scene.out_of_range) return;
  const VerticalField other = vertical_field(exchanged(scene.pair), scene.file.range);
  if (!other.known || other.unrectified) return;
  throw Error(
      scene.file.left.string(),
      fmt::format(
          "left and right appear to be swapped: {} corners match as given, {} after swapping",
          field.matched, other.matched),
      "swap --left and --right; or, if the right principal point is further to the right than the "
      "left one, give a smaller --min-disparity");
}

void repair(Scene& scene, bool wanted, Session& session) {
  const VerticalField field = vertical_field(scene.pair, scene.file.range);
  check_corners_not_swapped(scene, field);
  if (!field.significant && !field.unrectified && !wanted) return;
  session.info(scene.file.name + ": " + describe(field));
  if (field.unrectified) {
    session.add_trust_warning(
        scene.file.name + ": the rows are not aligned; rectify the pair first (vernier rectify)");
  } else if (field.significant && wanted) {
    correct_right(field, scene.pair);
  } else if (field.misaligned) {
    session.add_trust_warning(scene.file.name + ": " + misalignment(field) +
                              "--repair corrects this");
  } else if (field.significant) {
    session.warn(scene.file.name + ": the rows are slightly misaligned; --repair corrects this");
  }
}

/// Doubts a truth of floating point that often is exactly 0 or -1, which many files mean as unknown
/// and formats do not.
void check_unknown(const Scene& scene, Session& session) {
  if (scene.file.truth_unknown) return;
  constexpr double often = 0.01, hardly = 0.1;  // of the known pixels; of those
  constexpr float near_px = 1;
  for (const double value : {0.0, -1.0}) {
    const auto suspect = static_cast<float>(value / scene.file.truth_scale);
    std::size_t known = 0, exact = 0, near = 0;
    for (const float disparity : scene.map.disparity.values) {
      known += disparity == disparity;
      exact += disparity == suspect;
      near += disparity != suspect && std::abs(disparity - suspect) <= near_px;
    }
    const auto of = static_cast<double>(exact);
    if (of < often * static_cast<double>(known) || static_cast<double>(near) > hardly * of)
      continue;
    session.add_trust_warning(fmt::format(
        "{}: {:.0f} % of the ground truth is exactly {:g} and is taken as disparity: if it means "
        "unknown, give --truth-unknown {:g} (truth_unknown in a list), otherwise none",
        scene.file.name, 100 * of / static_cast<double>(known), value, value));
  }
}

/// Doubts the search range, or the truth's scale, if the true disparities of many edges are outside
/// it, and warns if those of some are.
void check_range(Scene& scene, Session& session) {
  constexpr double some = 0.02, much = 0.2;
  const DisparityRange& range = scene.file.range;
  constexpr float none = std::numeric_limits<float>::infinity();
  float least = none, most = -none;
  int known = 0, outside = 0;
  for (const TruthAtEdge& at : scene.truth) {
    if (!at.known) continue;
    ++known;
    least = std::min(least, at.own_px);
    most = std::max(most, at.own_px);
    outside += at.own_px < static_cast<float>(range.min_px) - 1 ||
               at.own_px > static_cast<float>(range.max_px) + 1;
  }
  const double share = static_cast<double>(outside) / std::max(1, known);
  if (share < some) return;
  std::string words = fmt::format(
      "{}: the true disparities of {:.0f} % of the edges are outside the search range of {} to {} "
      "px; they range from {:.0f} to {:.0f} px",
      scene.file.name, 100 * share, range.min_px, range.max_px, least, most);
  constexpr float of_kitti = 256;
  if (scene.file.truth_scale == 1 && most >= of_kitti &&
      most / of_kitti <= static_cast<float>(range.max_px) + 1) {
    words += "; if the file has 256 values per pixel, as KITTI's, give --truth-scale 256";
  }
  scene.out_of_range = share > much;
  if (scene.out_of_range) {
    session.add_trust_warning(words);
  } else {
    session.warn(words);
  }
}

}  // namespace

Scene read_scene(const StereoSceneFile& file, bool wants_repair, Session& session) {
  Scene scene;
  scene.file = file;
  scene.pair.left = read_image(file.left.string(), session);
  scene.pair.right = read_image(file.right.string(), session);
  const GreyLevels &left = scene.pair.left, &right = scene.pair.right;
  if (left.width_px != right.width_px || left.height_px != right.height_px) {
    throw Error(file.right.string(),
                fmt::format("image size {}x{} differs from the left image, {}x{}", right.width_px,
                            right.height_px, left.width_px, left.height_px),
                "give a rectified pair of equal size");
  }
  check_matcher_input(scene.pair, file.range, file.left.string());
  check_two_images(scene.pair, file.left.string(), file.right.string());
  scene.map = read_stereo_truth(file, left.width_px, left.height_px);
  check_unknown(scene, session);
  const double start = cpu_ms();
  scene.edges = canny_edges(left);
  scene.edges_ms = cpu_ms() - start;
  if (scene.edges.empty()) {
    throw Error(file.left.string(), "no edges found",
                "give a textured image; a 16-bit image must use the full range");
  }
  scene.truth = truth_at(scene.map, scene.edges);
  check_range(scene, session);
  repair(scene, wants_repair, session);
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

void check_not_swapped(const Matcher& matcher, const Scene& scene, const Run& run) {
  if (scene.out_of_range) return;
  check_not_swapped(
      matcher, run.found, scene.file.range, [&] { return exchanged(scene.pair); },
      scene.file.left.string());
}

}  // namespace vernier::cli
