// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/quantile.h"
#include "cli/localisation/figures.h"
#include "cli/localisation/odometry_drives.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/simulation/source_options.h"
#include "localise/trajectory.h"

namespace vernier::cli {
namespace {

/// On a real drive with large gaps, all wrong steps rested on fewer (docs/results.md).
constexpr std::size_t few_corners = 10;

/// Figures of one or more drives, summed for their means.
struct DriveFigures {
  int steps = 0, found = 0;
  int ambiguous = 0;  ///< with another motion in more than half as much of the image
  int weak = 0;       ///< on few corners
  struct StepDeviation {
    double sd_m = 0;  ///< of its position, from corner noise
    std::size_t to = 0;
  };
  std::vector<StepDeviation> deviations;  ///< of the steps found
  double links = 0, inliers = 0, chi2 = 0, dof = 0, cpu_s = 0;
  std::vector<double> nees;
  std::vector<TrajectoryDrift> drifts;
  std::vector<double> noise_sd_m, calibration_sd_m;  ///< predicted, of the ends of whole paths
  int drives = 0;
};

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Standard deviation of the distance to the end: the root of its mean square.
double position_sd_m(const Eigen::Matrix<double, 6, 6>& covariance) {
  return std::sqrt(covariance.diagonal().tail<3>().sum());
}

OdometryPath follow(const OdometryDrive& drive, double segment_m, DriveFigures& figures) {
  const double start = cpu_seconds();
  StepOptions options;
  options.calibration = drive.calibration;
  OdometryPath path = odometry_path(drive.rig, drive.moments, {}, options);
  figures.cpu_s += cpu_seconds() - start;
  ++figures.drives;
  const bool whole = path.end_covariance.allFinite();
  if (whole) figures.noise_sd_m.push_back(position_sd_m(path.end_covariance));
  if (whole && drive.calibration.size() > 0) {
    figures.calibration_sd_m.push_back(
        position_sd_m(path.end_by_rig * drive.calibration * path.end_by_rig.transpose()));
  }
  const std::vector<Pose>& truth = drive.T_world_left;
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    ++figures.steps;
    const auto& step = path.steps[i];
    if (!step) continue;
    ++figures.found;
    figures.ambiguous += step->other_motion > 0.5;
    figures.weak += step->inliers.size() < few_corners;
    figures.deviations.push_back({position_sd_m(step->covariance), i + 1});
    figures.links += step->links;
    figures.inliers += static_cast<double>(step->inliers.size());
    figures.chi2 += step->chi2;
    figures.dof += step->dof;
    if (truth.empty()) continue;
    figures.nees.push_back(step_nees(*step, truth[i].inverse() * truth[i + 1], drive.calibration));
  }
  if (!truth.empty()) figures.drifts.push_back(drift_of(path.T_first_camera, truth, segment_m));
  return path;
}

/// Means over the drives; the root of the mean square for errors of the end.
struct MeanDrift {
  double length_m = 0, end_error_m = 0, end_error_rad = 0, share = 0, rad_per_m = 0;
  int segments = 0;

  explicit MeanDrift(const std::vector<TrajectoryDrift>& drifts) {
    const auto n = static_cast<double>(drifts.size());
    for (const TrajectoryDrift& d : drifts) {
      length_m += d.length_m / n;
      end_error_m += d.end_error_m * d.end_error_m / n;
      end_error_rad += d.end_error_rad * d.end_error_rad / n;
      share += d.translation_share * d.segments;
      rad_per_m += d.rotation_rad_per_m * d.segments;
      segments += d.segments;
    }
    end_error_m = std::sqrt(end_error_m);
    end_error_rad = std::sqrt(end_error_rad);
    if (segments > 0) share /= segments;
    if (segments > 0) rad_per_m /= segments;
  }
};

/// Says where more steps than not err by more than what is stated of 19 in 20.
void tell_understated_steps(const std::vector<double>& nees,
                            double share_inside,
                            Session& session) {
  constexpr std::size_t fewest = 5;
  if (nees.size() < fewest || share_inside >= 0.5) return;
  session.warn(fmt::format(
      "{:.0f} % of the steps lie outside what is stated of 95 %: the rig, its covariance or the "
      "given truth errs by more than a step does, so the predicted deviations are not shown to "
      "hold",
      100 * (1 - share_inside)));
}

void add_truth(const DriveFigures& figures,
               double segment_m,
               Json& json,
               std::string& text,
               Session& session) {
  const MeanDrift drift(figures.drifts);
  const double median = quantile(figures.nees, 0.5, QuantileKind::linear);
  const double bound = chi_squared_quantile(0.95, 6);
  const auto inside = std::count_if(figures.nees.begin(), figures.nees.end(),
                                    [&](double nees) { return nees <= bound; });
  const double share_inside =
      static_cast<double>(inside) / static_cast<double>(figures.nees.size());
  tell_understated_steps(figures.nees, share_inside, session);
  json["truth"] = {
      {"length_m", drift.length_m},
      {"end_error_m", drift.end_error_m},
      {"end_error_deg", drift.end_error_rad * degrees},
      {"segment_m", segment_m},
      {"segments", drift.segments},
      {"drift_percent", drift.segments > 0 ? Json(100 * drift.share) : Json()},
      {"drift_deg_per_m", drift.segments > 0 ? Json(drift.rad_per_m * degrees) : Json()},
      {"nees_mean", mean(figures.nees)},
      {"nees_median", median},
      {"nees_inside_95", share_inside}};
  const std::string share =
      drift.length_m > 0 ? fmt::format(" ({:.2f} %)", 100 * drift.end_error_m / drift.length_m)
                         : "";
  text += fmt::format("error after {:.1f} m: {:.3f} m{}, {:.3f} deg\n", drift.length_m,
                      drift.end_error_m, share, drift.end_error_rad * degrees);
  if (drift.segments > 0) {
    text += fmt::format("drift over segments of {:g} m: {:.3f} %, {:.4f} deg/m ({} segments)\n",
                        segment_m, 100 * drift.share, drift.rad_per_m * degrees, drift.segments);
  } else {
    text += fmt::format("the path has no segment of {:g} m; see --segment-m\n", segment_m);
  }
  text += fmt::format(
      "squared error of a step in units of its covariance: mean {:.2f}, median {:.2f} (6 and 5.35 "
      "if it and the truth are right); {:.0f} % inside the 95 % region\n",
      mean(figures.nees), median, 100 * share_inside);
}

/// "0.012 m from corner noise, 0.034 m from calibration", or why it is not known.
std::string end_text(const DriveFigures& figures) {
  if (figures.noise_sd_m.empty()) return "not known, as steps were not found";
  const std::string calibration =
      figures.calibration_sd_m.empty()
          ? "; that from calibration is not known, the rig has no covariance"
          : fmt::format(", {:.3f} m from calibration", mean(figures.calibration_sd_m));
  const auto whole = static_cast<int>(figures.noise_sd_m.size());
  return fmt::format("{:.3f} m from corner noise{}{}", mean(figures.noise_sd_m), calibration,
                     whole == figures.drives ? ""
                                             : fmt::format(" ({} of {} drives, without a step that "
                                                           "was not found)",
                                                           whole, figures.drives));
}

/// A step that is known far worse than the others makes the path's error alone.
void tell_unlike_step(std::vector<DriveFigures::StepDeviation> steps, Session& session) {
  constexpr double unlike = 10, least_m = 0.05;
  constexpr std::size_t fewest = 5;
  if (steps.size() < fewest) return;
  const auto by_deviation = [](const auto& a, const auto& b) { return a.sd_m < b.sd_m; };
  std::stable_sort(steps.begin(), steps.end(), by_deviation);
  const double median_m = steps[steps.size() / 2].sd_m;
  const DriveFigures::StepDeviation& worst = steps.back();
  if (worst.sd_m < least_m || worst.sd_m < unlike * median_m) return;
  session.add_trust_warning(fmt::format(
      "the step to pair {} (counted from 1) is known to {:.2g} m (standard deviation), "
      "the others to {:.2g}: its images may not be of one moment, or be of something near "
      "that moves or is bare",
      worst.to + 1, worst.sd_m, median_m));
}

void report(const DriveFigures& figures, const OdometryOptions& options, Session& session) {
  Json json{{"drives", figures.drives}, {"steps", figures.steps}, {"found", figures.found}};
  if (figures.found < figures.steps) {
    session.add_trust_warning(
        fmt::format("{} of {} steps were not found, too few corners agree: the motion before them "
                    "was repeated",
                    figures.steps - figures.found, figures.steps));
  }
  const bool of_images = options.world.empty();
  if (of_images && figures.weak > 0) {
    session.add_trust_warning(fmt::format(
        "{} of {} steps rest on fewer than {} corners, which may agree by chance: give images "
        "that are less far apart, or of more texture",
        figures.weak, figures.steps, few_corners));
  }
  if (of_images) tell_unlike_step(figures.deviations, session);
  json["weak_steps"] = figures.weak;
  json["ambiguous_steps"] = figures.ambiguous;
  if (of_images && figures.ambiguous > 0) {
    session.add_trust_warning(fmt::format(
        "in {} of {} steps corners in a large part of the image agree on another motion, and "
        "which of the two is the rig's is not known: something large may move, be mirrored or "
        "be repeated; cover it, or give images that are less far apart",
        figures.ambiguous, figures.steps));
  }
  const double found = std::max(1, figures.found);
  json["links_per_step"] = figures.links / found;
  json["inliers_per_step"] = figures.inliers / found;
  json["chi2_per_dof"] = figures.dof > 0 ? Json(figures.chi2 / figures.dof) : Json();
  json["cpu_ms_per_step"] = 1e3 * figures.cpu_s / figures.steps;
  const auto mean_or_null = [](const std::vector<double>& sd_m) {
    return sd_m.empty() ? Json() : Json(mean(sd_m));
  };
  json["end_sd_m"] = {{"corners", mean_or_null(figures.noise_sd_m)},
                      {"calibration", mean_or_null(figures.calibration_sd_m)}};
  std::string text = fmt::format(
      "{} of {} steps found; {:.0f} links and {:.0f} inliers a step, chi2/dof {:.2f}; {:.1f} ms a "
      "step\npredicted standard deviation of the end: {}\n",
      figures.found, figures.steps, figures.links / found, figures.inliers / found,
      figures.dof > 0 ? figures.chi2 / figures.dof : 0, 1e3 * figures.cpu_s / figures.steps,
      end_text(figures));
  if (!figures.nees.empty()) add_truth(figures, options.segment_m, json, text, session);
  if (!options.output.empty()) {
    json["output"] = options.output;
    text += "written to " + options.output + "\n";
  }
  session.result(json, text);
}

void check_options(const OdometryOptions& options, const CLI::App& verb) {
  const bool images = !options.left.empty() || !options.right.empty();
  if (images == !options.world.empty()) {
    throw Error("odometry", images ? "images and a world are given" : "no views are given",
                "give --left and --right, or --world");
  }
  if (images && (options.left.empty() || options.right.empty())) {
    throw Error("odometry", "images of one camera only", "give --left and --right");
  }
  if (images && options.rig.empty()) {
    throw Error("odometry", "images need the rig that took them", "give --rig");
  }
  constexpr std::array of_robot{"--drives", "--leg",      "--step-m",    "--turn-deg", "--sources",
                                "--source", "--height-m", "--pitch-deg", "--seed"};
  constexpr std::array of_images{"--truth", "--rate-hz", "--corners"};
  if (images) refuse_options(verb, of_robot, "no robot is simulated");
  if (!images) refuse_options(verb, of_images, "there are no images");
  if (options.drives > 1 && !options.output.empty()) {
    throw Error("--output", "several drives have several trajectories", "use --drives 1");
  }
  if (!options.output.empty()) {
    check_output_is_not_input({options.truth, options.sources.file}, options.output);
  }
}

void run(const OdometryOptions& options, const CLI::App& verb, Session& session) {
  check_options(options, verb);
  DriveFigures figures;
  OdometryPath path;
  const auto add = [&](const OdometryDrive& drive) {
    if (drive.moments.size() < 2) {
      throw Error("odometry", "the drive has no step", "give smaller steps, or another leg");
    }
    path = follow(drive, options.segment_m, figures);
  };
  if (options.world.empty()) {
    add(drive_of_images(options, session));
  } else {
    for_each_simulated_drive(options, session, add);
  }
  if (!options.output.empty()) {
    std::vector<TimedPose> poses;
    for (const Pose& T : path.T_first_camera) {
      poses.push_back({static_cast<double>(poses.size()) / options.rate_hz, T});
    }
    write_atomically(options.output, tum_text(poses));
  }
  report(figures, options, session);
}

}  // namespace

void add_odometry(CLI::App& app, Session& session) {
  auto o = std::make_shared<OdometryOptions>();
  CLI::App* verb = add_verb(
      app, session, "odometry",
      "estimate a rig's motion from the corners of its image pairs, with its uncertainty",
      "vernier odometry --left 'left*.png' --right 'right*.png' --rig rig.json -o path.txt\n"
      "  vernier odometry --world workshop --drives 20 --source calibration=3");
  verb->add_option("--left", o->left, "left images (quoted pattern)");
  verb->add_option("--right", o->right,
                   "right images (quoted pattern); paired with left images by number");
  verb->add_option("--world", o->world, "world file or shipped name, driven through by a robot");
  verb->add_option("--rig", o->rig,
                   "rig file or shipped name (simulated robot: nominal unless given)");
  verb->add_option("--truth", o->truth,
                   "true poses of the left camera at the pairs of images: TUM's or KITTI's "
                   "trajectory, ASL's ground truth, or a COLMAP model (docs/file-formats.md)");
  verb->add_option("--rate-hz", o->rate_hz, "pairs of images a second, for the times written")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str();
  verb->add_option("--corners", o->corners, "maximum number of corners of an image")
      ->check(CLI::Range(10, 20'000))
      ->capture_default_str();
  verb->add_option("--segment-m", o->segment_m, "length over which drift is measured, metres")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  verb->add_option("--drives", o->drives, "simulated drives, each with draws of its own")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb->add_option("--leg", o->leg, "leg of the world's route, from 1; 0: the longest")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  verb->add_option("--step-m", o->step_m, "distance between views of the simulated robot")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  verb->add_option("--turn-deg", o->turn_deg, "largest turn between views, where the leg bends")
      ->check(CLI::Range(0.1, 90.0))
      ->capture_default_str();
  verb->add_option("--height-m", o->height_m, "camera height, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--pitch-deg", o->pitch_deg, "camera pitch, degrees; positive is down")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  add_source_options(*verb, o->sources);
  verb->add_option("--seed", o->seed, "random seed of the simulated robot")->capture_default_str();
  verb->add_option("-o,--output", o->output, "trajectory, TUM format, as evo reads it");
  check_files_written(*verb, {"--output"});
  verb->callback(
      [o, verb, &session] { session.action = [=, &session] { run(*o, *verb, session); }; });
}

}  // namespace vernier::cli
