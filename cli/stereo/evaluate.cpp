// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/output_files.h"
#include "calib/error.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/stereo/disparity_picture.h"
#include "cli/stereo/evaluate_draws.h"
#include "cli/stereo/evaluate_equal_density.h"
#include "cli/stereo/evaluate_figures.h"
#include "cli/stereo/evaluate_scene.h"
#include "cli/stereo/matcher_names.h"
#include "cli/stereo/scene_options.h"
#include "stereo/evaluation/edge_error.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/external_matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

struct EvaluateArguments {
  SceneOptions scenes;
  MatcherOptions matchers{"edge,sgbm", {}, 0};
  std::string outline = "either", picture, error_picture;
  std::string psi_c, rows_px, output;
  DrawOptions draws;
  bool repair = false, equal_density = false;
};

/// PNGs of a scene's edges by disparity and by error.
struct Pictures {
  std::string disparity, error;
};

Pictures pictures_of(const Scene& scene, const Run& run, DiscontinuityRule rule) {
  std::vector<double> errors_px;
  for (std::size_t i = 0; i < scene.edges.size(); ++i) {
    const TruthAtEdge& truth = scene.truth[i];
    const bool evaluated = truth.known && !is_occluded(truth, rule);
    errors_px.push_back(!evaluated                ? std::numeric_limits<double>::quiet_NaN()
                        : !run.found[i].matched() ? std::numeric_limits<double>::infinity()
                                                  : error_px(run.found[i], truth, rule));
  }
  return {disparity_picture(scene.pair.left, scene.edges, run.found, scene.file.range),
          error_picture(scene.pair.left, scene.edges, errors_px)};
}

/// File name stem of a scene.
std::string file_stem(std::size_t number, const std::string& name) {
  std::string stem = fmt::format("{:02}-", number + 1);
  for (const char c : name) {
    stem += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return stem;
}

/// File names of a scene's two pictures.
Pictures picture_names(std::size_t number, const StereoSceneFile& file) {
  const std::string stem = file_stem(number, file.name);
  return {stem + ".disparity.png", stem + ".error.png"};
}

/// Throws Error if an output would overwrite an input or another output.
void check_outputs(const EvaluateArguments& options, const std::vector<StereoSceneFile>& files) {
  const std::vector<fs::path> inputs = inputs_of(options.scenes, files);
  for (const std::string& output : {options.picture, options.error_picture}) {
    if (!output.empty()) check_output_is_not_input(inputs, output);
  }
  if (!options.picture.empty() && !options.error_picture.empty()) {
    check_different("--error-picture", options.error_picture, options.picture);
  }
  if (options.output.empty()) return;
  const fs::path folder = options.output;
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw Error(options.output, "is a file, not a folder", "give another folder with -o");
  }
  if (fs::exists(folder / "study.toml")) {
    throw Error(options.output, "contains a study", "give a separate folder for the evaluation");
  }
  check_output_is_not_input(inputs, folder / evaluation_file);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Pictures names = picture_names(i, files[i]);
    check_output_is_not_input(inputs, folder / names.disparity);
    check_output_is_not_input(inputs, folder / names.error);
  }
}

using Outputs = std::vector<std::pair<fs::path, std::string>>;

/// Collects the outputs of a scene; written at the end, so that nothing is written if a later scene
/// fails.
void add_outputs(const EvaluateArguments& options,
                 std::size_t number,
                 const Scene& scene,
                 const Run& run,
                 DiscontinuityRule rule,
                 Json& of_scene,
                 Outputs& outputs) {
  const bool first = number == 0;
  const bool first_alone = first && (!options.picture.empty() || !options.error_picture.empty());
  if (options.output.empty() && !first_alone) return;
  const Pictures pictures = pictures_of(scene, run, rule);
  if (first && !options.picture.empty()) outputs.emplace_back(options.picture, pictures.disparity);
  if (first && !options.error_picture.empty()) {
    outputs.emplace_back(options.error_picture, pictures.error);
  }
  if (options.output.empty()) return;
  const Pictures names = picture_names(number, scene.file);
  outputs.emplace_back(fs::path(options.output) / names.disparity, pictures.disparity);
  outputs.emplace_back(fs::path(options.output) / names.error, pictures.error);
  of_scene["pictures"] = {{"matcher", of_scene["matchers"].begin().key()},
                          {"disparity", names.disparity},
                          {"error", names.error},
                          {"least_px", scene.file.range.min_px},
                          {"most_px", scene.file.range.max_px}};
}

void write_outputs(const EvaluateArguments& options, const Json& json, const Outputs& pictures) {
  OutputFiles outputs;
  if (!options.output.empty()) outputs.add_folder(options.output);
  for (const auto& [file, content] : pictures) outputs.add(file, content);
  if (!options.output.empty()) {
    outputs.add(fs::path(options.output) / evaluation_file,
                json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  outputs.commit();
}

/// The collected results of all scenes.
struct Report {
  std::vector<std::vector<Json>> figures;  ///< [matcher][scene]
  Json scenes = Json::array();
  std::string text = figures_header();
};

std::vector<Run> run_scene(const Scene& scene,
                           const std::vector<Matcher>& matchers,
                           const EvaluationOptions& how,
                           Report& report) {
  Json json{{"name", scene.file.name},
            {"left", scene.file.left.string()},
            {"truth", scene.file.truth.string()},
            {"truth_scale", scene.file.truth_scale},
            {"truth_kind", name(scene.file.truth_kind)},
            {"least_px", scene.file.range.min_px},
            {"most_px", scene.file.range.max_px},
            {"edges", scene.edges.size()},
            {"matchers", Json::object()}};
  std::vector<Run> runs;
  for (std::size_t m = 0; m < matchers.size(); ++m) {
    runs.push_back(run_matcher(matchers[m], scene, how));
    if (m == 0) check_not_swapped(matchers[m], scene, runs[m]);
    const Json figures = figures_json(runs[m].score, runs[m].time_ms);
    report.figures[m].push_back(figures);
    report.text += figures_line(scene.file.name, matchers[m].name, figures);
    json["matchers"][matchers[m].name] = figures;
    json["matchers"][matchers[m].name]["by_angle"] = angles_json(runs[m].score);
  }
  report.scenes.push_back(std::move(json));
  return runs;
}

/// Adds the means and returns the complete JSON.
Json with_means(const EvaluateArguments& options,
                const std::vector<Matcher>& matchers,
                Report& report) {
  Json json{{"matchers", Json::object()}, {"outline", options.outline}};
  for (std::size_t m = 0; m < matchers.size(); ++m) {
    const std::string& name = matchers[m].name;
    json["matchers"][name] = mean_of(report.figures[m]);
    if (report.scenes.size() > 1) {
      report.text += figures_line(fmt::format("mean of {}", report.scenes.size()), name,
                                  json["matchers"][name]);
    }
  }
  json["scenes"] = report.scenes;
  return json;
}

constexpr double max_psi_c = 1000;  // as in a study's sources

DrawOptions draw_options(const EvaluateArguments& options) {
  DrawOptions draws = options.draws;
  const auto list = [](const std::string& text, const std::string& option) {
    const auto count = static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
    return text.empty() ? std::vector<double>() : parse_numbers(text, count, option);
  };
  draws.psi_c = list(options.psi_c, "--psi-c");
  draws.rows_px = list(options.rows_px, "--rows-moved-px");
  for (std::vector<double>* values : {&draws.psi_c, &draws.rows_px}) {
    std::sort(values->begin(), values->end());
    values->erase(std::unique(values->begin(), values->end()), values->end());
  }
  for (const double psi_c : draws.psi_c) {
    if (psi_c >= 0 && psi_c <= max_psi_c) continue;
    throw Error("--psi-c", fmt::format("{:g} is not between 0 and {:g}", psi_c, max_psi_c),
                "give scale factors for the standard deviations, such as 0.1,1,10");
  }
  return draws;
}

/// The settings that affect the results, apart from the pairs.
Json settings_json(const EvaluateArguments& options,
                   const std::vector<Matcher>& matchers,
                   const Session& session) {
  Json names = Json::array();
  for (const Matcher& matcher : matchers) names.push_back(matcher.name);
  return {{"command", session.command},
          {"list", options.scenes.scenes.empty() ? Json() : Json(options.scenes.scenes)},
          {"matchers", names},
          {"commands", options.matchers.commands},
          {"outline", options.outline},
          {"repair", options.repair}};
}

/// Adds trust warnings for a pair on which all matchers perform implausibly.
void check_plausibility(const Scene& scene, const std::vector<Run>& runs, Session& session) {
  const std::vector<std::string>& known = session.trust_warnings();
  const auto of_scene = [&](const std::string& doubt) {
    return doubt.starts_with(scene.file.name + ": ");
  };
  if (std::any_of(known.begin(), known.end(), of_scene)) return;  // it explains what follows
  constexpr double min_density = 0.05, low_density = 0.3, max_bad = 1.0 / 3;
  const auto all = [&](const auto& of) { return std::all_of(runs.begin(), runs.end(), of); };
  if (all([](const Run& run) { return run.score.all.density < min_density; })) {
    session.add_trust_warning(
        scene.file.name + ": no matcher finds matches; check both images and the disparity range");
  } else if (all([](const Run& run) {
               return run.score.all.density < low_density || run.score.all.bad_1 > max_bad;
             })) {
    session.add_trust_warning(fmt::format(
        "{}: {:.0f} % of the matches are wrong by more than a pixel: check that the ground truth "
        "belongs to this left image, and its scale ({:g} values per pixel)",
        scene.file.name, 100 * runs.front().score.all.bad_1, scene.file.truth_scale));
  }
}

void run(const EvaluateArguments& options, Session& session) {
  const std::vector<StereoSceneFile> files = scene_files(options.scenes);
  check_outputs(options, files);
  MapRange map;  // of programs
  MatcherOptions told = options.matchers;
  told.told = [&map](const MapRange& range) {
    map.within += range.within;
    map.above += range.above;
  };
  const std::vector<Matcher> matchers = matchers_named(told);
  if (options.equal_density && matchers.size() < 2) {
    throw Error("--equal-density", "needs at least two matchers", "add another one to --matcher");
  }
  EvaluationOptions how;
  if (options.outline == "foreground") how.outline = DiscontinuityRule::foreground;
  cv::setNumThreads(1);  // CPU times are for one thread
  EvaluationUnderError under_error(matchers, how, draw_options(options));
  EvaluationAtEqualDensity equal_density(matchers);
  Report report{std::vector<std::vector<Json>>(matchers.size())};
  Progress progress(session, "evaluating");
  int done = 0;
  Outputs outputs;
  for (const StereoSceneFile& file : files) {
    const Scene scene = read_scene(file, options.repair, session);
    map = {};
    const std::vector<Run> runs = run_scene(scene, matchers, how, report);
    if (const std::string doubt = doubt_about(map, file.range.max_px); !doubt.empty()) {
      session.add_trust_warning(file.name + ": " + doubt);
    }
    add_outputs(options, static_cast<std::size_t>(done), scene, runs[0], how.outline,
                report.scenes.back(), outputs);
    check_plausibility(scene, runs, session);
    if (options.equal_density) equal_density.add(scene, runs, how);
    under_error.add(scene, session);
    progress.update(++done, static_cast<int>(files.size()));
  }
  Json json = with_means(options, matchers, report);
  json["settings"] = settings_json(options, matchers, session);
  if (options.equal_density) {
    json["equal_density"] = equal_density.json();
    json["curves"] = equal_density.curves();
    report.text += EvaluationAtEqualDensity::text(json["equal_density"]);
  }
  if (under_error.wanted()) json["calibration_error"] = under_error.json();
  json["doubts"] = session.trust_warnings();
  write_outputs(options, json, outputs);
  session.result(json, report.text + under_error.text());
}

void add_error_options(CLI::App* verb, EvaluateArguments& o) {
  verb->add_flag("--equal-density", o.equal_density,
                 "compare the first matcher with the others at equal density");
  CLI::Option* psi_c = verb->add_option("--psi-c", o.psi_c,
                                        "also evaluate under calibration errors: scale factors for "
                                        "the rig's standard deviations, such as 0.1,1,3,10");
  verb->add_option("--rig", o.scenes.one.rig,
                   "rig file used to rectify the pair, for --psi-c (default: the nominal rig, "
                   "resized to the image)")
      ->excludes("--scenes")
      ->needs(psi_c);
  verb->add_option("--rows-moved-px", o.rows_px,
                   "also evaluate with the right image shifted down by this many rows, such as 2");
  verb->add_option("--draws", o.draws.draws, "sampled rigs per pair and psi_c")
      ->needs(psi_c)
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  verb->add_option("--seed", o.draws.seed, "random seed of the samples")
      ->needs(psi_c)
      ->capture_default_str();
  verb->add_option("--threads", o.draws.threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

}  // namespace

void add_evaluate(CLI::App& app, Session& session) {
  auto o = std::make_shared<EvaluateArguments>();
  CLI::App* verb =
      add_verb(app, session, "evaluate",
               "evaluate stereo matchers against ground truth at the edges of the left image",
               "vernier evaluate --left im2.png --right im6.png --truth disp2.png --truth-scale 4 "
               "--max-disparity 64 --matcher edge,bm,sgbm");
  add_scene_options(*verb, o->scenes);
  add_error_options(verb, *o);
  verb->add_option("--matcher", o->matchers.names,
                   "edge, stretch, bm, sgbm and names given by --command, separated by commas; "
                   "pictures show the first; none: only the programs of --command")
      ->capture_default_str();
  add_command_options(*verb, o->matchers);
  verb->add_option("--outline", o->outline,
                   "which disparity is correct at a depth discontinuity: either surface, or the "
                   "foreground only")
      ->check(CLI::IsMember({"either", "foreground"}))
      ->capture_default_str();
  verb->add_flag("--repair", o->repair, "correct the vertical misalignment estimated from corners");
  verb->add_option(
      "-o,--output", o->output,
      "output folder for the scores and pictures of all pairs, readable by vernier report");
  verb->add_option("--picture", o->picture,
                   "PNG of the first pair's edges with the first matcher's disparities, blue (far) "
                   "to red (near)")
      ->check(png_name);
  verb->add_option("--error-picture", o->error_picture,
                   "the same coloured by error: green up to 0.5 px, yellow up to 1 px, orange up "
                   "to 3 px, red above; blue: no match, black: not evaluated")
      ->check(png_name);
  check_files_written(*verb, {"--picture"});
  check_folder_written(*verb, "--output");
  verb->callback([o, verb, &session] {
    require_scenes(*verb, o->scenes);
    session.action = [=, &session] { run(*o, session); };
  });
}

}  // namespace vernier::cli
