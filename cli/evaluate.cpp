// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "calib/error.h"
#include "cli/disparity_picture.h"
#include "cli/matcher_names.h"
#include "cli/option_checks.h"
#include "cli/session.h"
#include "cli/spare_inputs.h"
#include "stereo/canny_edges.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_scenes.h"
#include "stereo/vertical_field.h"

namespace vernier::cli {
namespace {

constexpr int timed_runs = 3;

struct Options {
  StereoSceneFile scene;
  std::string scenes, matchers = "edge,sgbm", outline = "either", picture, error_picture;
  std::vector<std::string> commands;
  bool repair = false;
};

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

/// A pair with what is known of it.
struct Scene {
  StereoSceneFile file;
  RectifiedPair pair;
  std::vector<EdgePoint> edges;
  std::vector<TruthAtEdge> truth;
  double edges_ms = 0;
};

/// What a matcher did on a scene.
struct Run {
  MatcherScore score;
  std::vector<EdgeDisparity> found;
  double time_ms = 0;  ///< CPU time on one thread, edges included where it works on them
};

std::vector<StereoSceneFile> scene_files(const Options& options) {
  if (!options.scenes.empty()) return read_stereo_scenes(options.scenes);
  StereoSceneFile scene = options.scene;
  scene.name = scene.left.stem().string();
  return {scene};
}

void repair(Scene& scene, bool wanted, Session& session) {
  const VerticalField field = vertical_field(scene.pair, scene.file.range);
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

Scene read_scene(const StereoSceneFile& file, bool wants_repair, Session& session) {
  Scene scene{file, {}, {}, {}, 0};
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
  const StereoTruth truth = read_stereo_truth(file, left.width_px, left.height_px);
  repair(scene, wants_repair, session);
  const double start = cpu_ms();
  scene.edges = canny_edges(left);
  scene.edges_ms = cpu_ms() - start;
  if (scene.edges.empty()) {
    throw Error(file.left.string(), "it has no edges", "give an image of something");
  }
  scene.truth = truth_at(truth, scene.edges);
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

/// Exchanged images are found the other way round.
void check_not_exchanged(const Matcher& matcher, const Scene& scene, const Run& run) {
  constexpr double few = 0.5, times_more = 1.5;
  const auto count = [](const std::vector<EdgeDisparity>& found) {
    return static_cast<double>(
        std::count_if(found.begin(), found.end(), [](const auto& d) { return d.matched(); }));
  };
  const double given = count(run.found) / static_cast<double>(scene.edges.size());
  if (given >= few) return;
  const RectifiedPair other{scene.pair.right, scene.pair.left};
  const std::vector<EdgePoint> edges = canny_edges(other.left);
  if (edges.empty()) return;
  const double exchanged =
      count(matcher.match(other, edges, scene.file.range)) / static_cast<double>(edges.size());
  if (exchanged < few || exchanged < times_more * given) return;
  throw Error(
      scene.file.left.string(),
      fmt::format("left and right seem exchanged: {:.0f} % of the edges are found as given, "
                  "{:.0f} % the other way round",
                  100 * given, 100 * exchanged),
      "exchange --left and --right");
}

Json figures_json(const MatcherScore& s, double time_ms) {
  const EdgeFigures& f = s.all;
  if (f.matched == 0) {  // no share of nothing
    Json none{{"density", 0.0}};
    for (const char* key : {"bad_0_5", "bad_1", "bad_2", "mismatch", "rms_inlier_px",
                            "bias_inlier_px", "bad_1_smooth", "bad_1_discontinuity"}) {
      none[key] = Json();
    }
    none["density_discontinuity"] = 0.0;
    none["occluded_matched"] = static_cast<double>(s.occluded_matched) / std::max(1, s.occluded);
    none["coverage_95"] = none["z_rms"] = Json();
    none["time_ms"] = time_ms;
    return none;
  }
  return {{"density", f.density},
          {"bad_0_5", f.bad_0_5},
          {"bad_1", f.bad_1},
          {"bad_2", f.bad_2},
          {"mismatch", s.mismatch},
          {"rms_inlier_px", s.smooth.rms_inlier_px},
          {"bias_inlier_px", s.smooth.bias_inlier_px},
          {"bad_1_smooth", s.smooth.bad_1},
          {"bad_1_discontinuity", s.discontinuity.bad_1},
          {"density_discontinuity", s.discontinuity.density},
          {"occluded_matched", static_cast<double>(s.occluded_matched) / std::max(1, s.occluded)},
          {"coverage_95", s.stated > 0 ? Json(s.coverage_95) : Json()},
          {"z_rms", s.stated > 0 ? Json(s.z_rms) : Json()},
          {"time_ms", time_ms}};
}

/// Means over scenes of the numbers in their JSON; null where one is.
Json mean_of(const std::vector<Json>& scenes) {
  Json mean = scenes.front();
  for (auto& [key, value] : mean.items()) {
    double sum = 0;
    bool all = true;
    for (const Json& scene : scenes) {
      all = all && scene.at(key).is_number();
      if (all) sum += scene.at(key).get<double>();
    }
    value = all ? Json(sum / static_cast<double>(scenes.size())) : Json();
  }
  return mean;
}

Json angles_json(const MatcherScore& score) {
  Json bins = Json::array();
  for (std::size_t i = 0; i < score.by_angle.size(); ++i) {
    const EdgeFigures& f = score.by_angle[i];
    bins.push_back({{"from_deg", 10 * i},
                    {"to_deg", 10 * (i + 1)},
                    {"edges", f.edges},
                    {"density", f.density},
                    {"bad_1", f.bad_1},
                    {"rms_inlier_px", f.rms_inlier_px}});
  }
  return bins;
}

std::string header() {
  return fmt::format("{:<18} {:<10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9} {:>9}\n",
                     "pair", "matcher", "density", "bad 0.5", "bad 1", "bad 2", "mismatch",
                     "rms px", "bias px", "bad 1 out", "CPU ms");
}

std::string line(const std::string& pair, const std::string& matcher, const Json& f) {
  const auto percent = [&](const char* key) {
    return f.at(key).is_null() ? "-" : fmt::format("{:.2f} %", 100 * f.at(key).get<double>());
  };
  const auto pixels = [&](const char* key) {
    return f.at(key).is_null() ? "-" : fmt::format("{:.3f}", f.at(key).get<double>());
  };
  return fmt::format("{:<18} {:<10} {:>8.4f} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9} {:>9.1f}\n",
                     pair, matcher, f.at("density").get<double>(), percent("bad_0_5"),
                     percent("bad_1"), percent("bad_2"), percent("mismatch"),
                     pixels("rms_inlier_px"), pixels("bias_inlier_px"),
                     percent("bad_1_discontinuity"), f.at("time_ms").get<double>());
}

void write_pictures(const Options& options, const Scene& scene, const Run& run, OutlineRule rule) {
  if (!options.picture.empty()) {
    write_disparity_picture(scene.pair.left, scene.edges, run.found, scene.file.range,
                            options.picture);
  }
  if (options.error_picture.empty()) return;
  std::vector<double> errors;
  for (std::size_t i = 0; i < scene.edges.size(); ++i) {
    const TruthAtEdge& truth = scene.truth[i];
    const bool asked = truth.known && !is_occluded(truth, rule);
    errors.push_back(!asked                    ? std::numeric_limits<double>::quiet_NaN()
                     : !run.found[i].matched() ? std::numeric_limits<double>::infinity()
                                               : error_px(run.found[i], truth, rule));
  }
  write_error_picture(scene.pair.left, scene.edges, errors, options.error_picture);
}

void check_outputs(const Options& options, const std::vector<StereoSceneFile>& files) {
  std::vector<std::filesystem::path> inputs{options.scenes};
  for (const StereoSceneFile& file : files) {
    inputs.insert(inputs.end(), {file.left, file.right, file.truth, file.right_truth});
  }
  for (const std::string& output : {options.picture, options.error_picture}) {
    if (!output.empty()) spare_inputs(inputs, output);
  }
  if (!options.picture.empty() && !options.error_picture.empty()) {
    check_different("--error-picture", options.error_picture, options.picture);
  }
}

void run(const Options& options, Session& session) {
  const std::vector<StereoSceneFile> files = scene_files(options);
  check_outputs(options, files);
  const std::vector<Matcher> matchers = matchers_named(options.matchers, options.commands);
  EvaluationOptions how;
  if (options.outline == "foreground") how.outline = OutlineRule::foreground;
  cv::setNumThreads(1);  // CPU times are of one thread
  std::vector<std::vector<Json>> figures(matchers.size());
  Json scenes = Json::array();
  std::string text = header();
  Progress progress(session, "evaluating");
  int done = 0;
  for (const StereoSceneFile& file : files) {
    const Scene scene = read_scene(file, options.repair, session);
    Json of_scene{{"name", file.name}, {"edges", scene.edges.size()}, {"matchers", Json::object()}};
    for (std::size_t m = 0; m < matchers.size(); ++m) {
      const Run result = run_matcher(matchers[m], scene, how);
      if (m == 0) check_not_exchanged(matchers[m], scene, result);
      const Json json = figures_json(result.score, result.time_ms);
      figures[m].push_back(json);
      text += line(file.name, matchers[m].name, json);
      of_scene["matchers"][matchers[m].name] = json;
      of_scene["matchers"][matchers[m].name]["by_angle"] = angles_json(result.score);
      if (m == 0 && &file == files.data()) write_pictures(options, scene, result, how.outline);
    }
    scenes.push_back(std::move(of_scene));
    progress.update(++done, static_cast<int>(files.size()));
  }
  Json json{{"matchers", Json::object()}, {"outline", options.outline}, {"scenes", scenes}};
  for (std::size_t m = 0; m < matchers.size(); ++m) {
    json["matchers"][matchers[m].name] = mean_of(figures[m]);
    if (files.size() > 1) {
      text += line(fmt::format("mean of {}", files.size()), matchers[m].name,
                   json["matchers"][matchers[m].name]);
    }
  }
  session.result(json, text);
}

void add_pair_options(CLI::App* verb, Options& o) {
  auto* scenes = verb->add_option("--scenes", o.scenes, "TOML list of pairs (docs/matchers.md)");
  for (const auto& [name, value, help] :
       {std::tuple{"--left", &o.scene.left, "left image, rectified"},
        std::tuple{"--right", &o.scene.right, "right image"},
        std::tuple{"--truth", &o.scene.truth, "true disparities of the left image: PFM, PNG, .npy"},
        std::tuple{"--right-truth", &o.scene.right_truth,
                   "those of the right image: what it does not show is told better"}}) {
    verb->add_option(name, *value, help)->excludes(scenes);
  }
  verb->add_option("--truth-scale", o.scene.truth_scale, "values a pixel of the truth")
      ->check(finite_and_positive)
      ->excludes(scenes)
      ->capture_default_str();
  verb->add_option("--max-disparity", o.scene.range.most_px, "largest disparity searched, pixels")
      ->excludes(scenes)
      ->capture_default_str();
  verb->add_option("--min-disparity", o.scene.range.least_px, "smallest one")
      ->excludes(scenes)
      ->capture_default_str();
}

}  // namespace

void add_evaluate(CLI::App& app, Session& session) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = add_verb(
      app, session, "evaluate", "stereo matchers against ground truth, at the left image's edges",
      "vernier evaluate --left im2.png --right im6.png --truth disp2.png --truth-scale 4 "
      "--max-disparity 64 --matcher edge,bm,sgbm");
  add_pair_options(verb, *o);
  verb->add_option("--matcher", o->matchers, "edge, stretch, bm, sgbm, with commas between")
      ->capture_default_str();
  verb->add_option("--command", o->commands,
                   "a program as a matcher: its command with {left} {right} {output}, {least} "
                   "{most} (repeatable)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--outline", o->outline,
                   "what is right at a step of the truth: either surface, or the foreground alone")
      ->check(CLI::IsMember({"either", "foreground"}))
      ->capture_default_str();
  verb->add_flag("--repair", o->repair, "take away what rows differ by, found from corners");
  verb->add_option("--picture", o->picture,
                   "PNG of the first pair's edges by the first matcher, blue far to red near")
      ->check(png_name);
  verb->add_option("--error-picture", o->error_picture,
                   "the same by error: green to 0.5 px, yellow to 1, orange to 3, red; blue: none")
      ->check(png_name);
  verb->callback([o, verb, &session] {
    if (o->scenes.empty()) {
      for (const char* needed : {"--left", "--right", "--truth"}) {
        if (verb->count(needed) == 0) throw CLI::RequiredError(needed);
      }
    }
    session.action = [=, &session] { run(*o, session); };
  });
}

}  // namespace vernier::cli
