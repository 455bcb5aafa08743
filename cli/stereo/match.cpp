// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/ordered_parallel.h"
#include "calib/base/output_files.h"
#include "calib/calibration/pair_sides.h"
#include "calib/error.h"
#include "calib/formats/pairs_file.h"
#include "calib/pair_observations.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/statistics/quantile.h"
#include "cli/calibration/solver_input.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/stereo/match_picture.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/match_images.h"

namespace vernier::cli {
namespace {

constexpr double min_matched = 0.1;  // below this fraction of matched left corners, fail or warn
constexpr double suspicious = 0.3;   // below this fraction, the images may be swapped
constexpr int swapped_ratio = 2;     // with this many times more matches when swapped …
constexpr std::size_t min_swapped = 20;  // … and at least this many, they are swapped
constexpr double ambiguous_ratio = 0.7;  // above this ratio the order cannot be determined
constexpr std::size_t probed = 3;        // image pairs to test swapped if few corners matched

struct MatchArguments {
  std::string left, right, prior, output, picture;
  ImageMatchingOptions matching;
  int threads = 0;
};

double median_sigma(const std::vector<CornerMatch>& matches) {
  std::vector<double> sigma;
  sigma.reserve(matches.size());
  for (const CornerMatch& match : matches) sigma.push_back(match.sigma_px);
  return median_or_zero(std::move(sigma));
}

std::vector<ImageMatching> match_all(const std::vector<ImageFiles>& files,
                                     const RigEstimate& prior,
                                     const MatchArguments& options,
                                     Session& session) {
  std::vector<ImageMatching> all(files.size());
  Progress progress(session, "matching");
  std::mutex mutex;
  int done = 0;
  for_each_index(files.size(), options.threads, [&](std::size_t i) {
    all[i] = match_images(files[i], prior, options.prior, options.matching);
    const std::lock_guard lock(mutex);
    progress.update(++done, static_cast<int>(files.size()));
  });
  return all;
}

struct Totals {
  std::size_t corners = 0, matches = 0;
};

Totals totals(const std::vector<ImageMatching>& all) {
  Totals sum;
  for (const ImageMatching& m : all) {
    sum.corners += static_cast<std::size_t>(m.corners_left);
    sum.matches += m.matches.size();
  }
  return sum;
}

/// Matches some image pairs with left and right swapped. Throws Error if that gives many more
/// matches. Returns words if it gives nearly as many, else none.
std::string check_matches_not_swapped(const std::vector<ImageMatching>& all,
                                      const RigEstimate& prior,
                                      const MatchArguments& options,
                                      std::size_t tried) {
  if (prior.rig.cameras[0].size_px != prior.rig.cameras[1].size_px) return {};
  std::size_t given = 0, exchanged = 0;
  for (std::size_t i = 0; i < std::min(tried, all.size()); ++i) {
    const ImageFiles& files = all[i].files;
    given += all[i].matches.size();
    exchanged += match_images({files.number, files.right, files.left}, prior, options.prior,
                              options.matching)
                     .matches.size();
  }
  if (exchanged < min_swapped) return {};
  if (exchanged < swapped_ratio * given) {
    if (static_cast<double>(exchanged) <= ambiguous_ratio * static_cast<double>(given)) return {};
    return fmt::format("nearly as many corners match with left and right swapped ({} against {})",
                       exchanged, given);
  }
  throw Error(
      all.front().files.left.string(),
      fmt::format(
          "left and right appear to be swapped: {} corners match as given, {} after swapping",
          given, exchanged),
      "swap --left and --right, or the cameras of the prior");
}

/// Throws Error if both images of a pair are identical.
void check_two_lists(const std::vector<ImageFiles>& files) {
  for (const ImageFiles& pair : files) {
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(pair.left, unknown);
    if (bytes != std::filesystem::file_size(pair.right, unknown) || unknown) continue;
    if (read_whole(pair.left) != read_whole(pair.right)) continue;
    throw Error(pair.right.string(), "same image as " + pair.left.string(),
                "give the image that the right camera took at the same time");
  }
}

/// If the sides may be swapped (`suspicion`), judges by a calibration from the matches whether they
/// are. Throws Error if so; a doubt if nothing tells.
void check_ambiguous_sides(const std::string& suspicion,
                           const PairObservations& pairs,
                           const RigFile& prior,
                           const MatchArguments& options,
                           Session& session) {
  if (suspicion.empty()) return;
  SideVerdict verdict = SideVerdict::interchangeable;
  try {
    verdict = judge_sides(pairs, usable_prior(prior, options.prior));
  } catch (const Error& error) {
    session.warn(error.what());
  }
  if (verdict == SideVerdict::exchanged) {
    throw Error(options.left,
                suspicion +
                    ", and a calibration from the matches says that left and right are "
                    "swapped",
                "swap --left and --right, or the cameras of the prior");
  }
  if (verdict == SideVerdict::as_given) return;
  session.add_trust_warning(
      suspicion +
      (verdict == SideVerdict::behind
           ? ", and a calibration from the matches has them behind the cameras; check which camera "
             "is the left one, and the prior's baseline"
           : ", and neither they nor the prior tell the cameras apart; make sure that --left is "
             "the "
             "left camera, or use a prior that knows the rotation better"));
}

/// Throws Error if nothing matched; adds warnings for doubtful results. Returns what suggests that
/// left and right are swapped, if anything does.
std::string check_matches(const std::vector<ImageMatching>& all,
                          const RigEstimate& prior,
                          const MatchArguments& options,
                          Session& session) {
  const Totals sum = totals(all);
  for (const ImageMatching& m : all) {
    if (m.corners_left > 0 && m.corners_right > 0) continue;
    const auto& blank = m.corners_left > 0 ? m.files.right : m.files.left;
    const std::string fault = "no corner is detected above the image noise";
    if (sum.matches == 0) throw Error(blank.string(), fault, "give images of a textured scene");
    session.warn(blank.string() + ": " + fault + "; pair skipped");
  }
  const double share = static_cast<double>(sum.matches) / static_cast<double>(sum.corners);
  std::string suspicion =
      check_matches_not_swapped(all, prior, options, share < suspicious ? probed : 1);
  if (share >= min_matched) return suspicion;
  const std::string fault =
      fmt::format("{} of {} left corners were matched", sum.matches, sum.corners);
  const std::string remedy =
      "check that the prior belongs to these cameras, that its covariance is not too small, that "
      "the images are simultaneous, and that the scene is farther than --nearest-m";
  if (sum.matches == 0) throw Error("match", fault, remedy);
  session.add_trust_warning(fault + "; " + remedy);
  return suspicion;
}

std::vector<std::filesystem::path> inputs(const std::filesystem::path& prior,
                                          const std::vector<ImageFiles>& files) {
  std::vector<std::filesystem::path> all{prior};
  for (const ImageFiles& pair : files) all.insert(all.end(), {pair.left, pair.right});
  return all;
}

Json matching_json(const ImageMatching& m) {
  return {{"pair", m.files.number},           {"left", m.files.left.string()},
          {"right", m.files.right.string()},  {"corners_left", m.corners_left},
          {"corners_right", m.corners_right}, {"noise_left", m.noise_left},
          {"noise_right", m.noise_right},     {"candidates", m.candidates},
          {"matches", m.matches.size()},      {"median_sigma_px", median_sigma(m.matches)}};
}

/// Writes both files or none.
void write_both(const PairObservations& pairs,
                const ImageMatching& first,
                const MatchArguments& options) {
  OutputFiles outputs;
  if (!options.picture.empty()) outputs.add(options.picture, match_picture(first));
  outputs.add(options.output, format_pairs(pairs));
  outputs.commit();
}

void run(const MatchArguments& options, Session& session) {
  const std::filesystem::path prior_file = find_rig(options.prior);
  const RigFile prior = read_rig(prior_file);
  for (const std::string& warning : prior.warnings) session.warn(warning);
  if (prior.estimate.covariance)
    usable_prior(prior, options.prior);  // otherwise match_images reports it
  const auto files = paired_images(options.left, options.right);
  check_output_is_not_input(inputs(prior_file, files), options.output);
  if (!options.picture.empty()) {
    check_output_is_not_input(inputs(prior_file, files), options.picture);
    check_different("--picture", options.picture, options.output);
  }
  check_two_lists(files);
  const auto all = match_all(files, prior.estimate, options, session);
  const std::string suspicion = check_matches(all, prior.estimate, options, session);

  PairObservations pairs;
  Json images = Json::array();
  std::string text =
      fmt::format("{:>6} {:>7} {:>7} {:>10} {:>7} {:>7} {:>13}  {}\n", "pair", "left", "right",
                  "candidates", "matches", "of left", "median sigma", "left image");
  for (const ImageMatching& m : all) {
    add_matches(pairs, m);
    images.push_back(matching_json(m));
    const double share = static_cast<double>(m.matches.size()) / std::max(1, m.corners_left);
    text +=
        fmt::format("{:>6} {:>7} {:>7} {:>10} {:>7} {:>5.0f} % {:>10} px  {}\n", m.files.number,
                    m.corners_left, m.corners_right, m.candidates, m.matches.size(), 100 * share,
                    m.matches.empty() ? "-" : fmt::format("{:.3f}", median_sigma(m.matches)),
                    m.files.left.string());
  }
  check_ambiguous_sides(suspicion, pairs, prior, options, session);
  write_both(pairs, all.front(), options);
  text += fmt::format("{} matches of {} image pairs written to {}\n", pairs.size(),
                      pairs.image_pairs.size(), options.output);
  session.result({{"matches", pairs.size()},
                  {"image_pairs", images},
                  {"doubts", session.trust_warnings()},
                  {"output", options.output}},
                 text);
}

}  // namespace

void add_match(CLI::App& app, Session& session) {
  auto o = std::make_shared<MatchArguments>();
  CLI::App* verb =
      add_verb(app, session, "match",
               "match corners of an arbitrary scene between the images of a stereo pair",
               "vernier match --left 'left*.png' --right 'right*.png' --prior "
               "prior.rig.json --nearest-m 0.8 -o pairs.csv\n"
               "  vernier calibrate --pairs pairs.csv --prior prior.rig.json "
               "-o rig.json");
  verb->add_option("--left", o->left, "left images (quoted pattern)")->required();
  verb->add_option("--right", o->right,
                   "right images (quoted pattern); paired with left images by number")
      ->required();
  verb->add_option("--prior", o->prior,
                   "rig file or shipped name; its covariance defines the search region")
      ->required();
  verb->add_option("-n,--corners", o->matching.corners,
                   "maximum number of corners in a left image, strongest first; 1.5 times as many "
                   "in the right image")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  verb->add_option("--nearest-m", o->matching.band.nearest_m,
                   "depth of the nearest object in view, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--cells", o->matching.cells,
                   "distribute corners evenly over cells x cells parts of the image (0: off)")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  verb->add_option("--threads", o->threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("--picture", o->picture,
                   "PNG of the first image pair, left above right, one line per match: red "
                   "(shortest) to blue (longest)")
      ->check(png_name);
  verb->add_option("-o,--output", o->output, "output CSV file of matched pairs")->required();
  check_files_written(*verb, {"--output", "--picture"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
