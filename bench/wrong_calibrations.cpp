// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// How often a wrong calibration is named, and a good one accused:
//
//     wrong_calibrations --seeds 1..200 [--faulty 1..40] [--real NAME,FILE,640x480,MODEL,9x6]…
//
// Seeds give simulated good sets; faults are put into the first of them (--faulty) and into each
// real set, whose FILE is written by `vernier detect`. A run counts as named if it is refused or
// ends in a doubt with a word of its fault, as told otherwise if in another doubt, as silent
// without one.
// --verbose prints every message, --only PART the faults whose name contains PART, --statistics the
// score tests (calib/calibration/frame_scatter.h) of each run.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/calibration_faults.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/calibration/frame_scatter.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/observations_file.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"

namespace vernier::bench {
namespace {

struct Arguments {
  std::pair<std::uint64_t, std::uint64_t> seeds{1, 0}, faulty{1, 0};
  std::vector<std::string> real;
  std::string only;
  bool verbose = false, statistics = false;
};

struct NamedCase {
  std::string name;
  CalibrationCase set;
};

/// What a calibration says of itself.
struct Outcome {
  bool refused = false;
  std::vector<std::string> doubts, warnings;
  std::string statistics;
};

std::string statistics_of(const RigEstimate& estimate) {
  const CalibrationEvidence& e = *estimate.evidence;
  std::string text = fmt::format("rms {:.3f}", estimate.calibration->rms_px);
  for (const auto& s : internal::frame_scatter(
           e.observations, {estimate.rig, e.frames, e.T_first_board, e.warp_m})) {
    text += fmt::format(" | {}{}{} s{:.2f} F{:.1f} d{:.2f} w{:.2f}",
                        s.kept == internal::Kept::pose ? "pose" : "lens", s.camera,
                        s.is_split ? "/" : "", s.share, s.f_ratio, s.shift_px, s.worst_share);
  }
  return text;
}

Outcome outcome_of(const CalibrationCase& c, bool statistics) {
  Outcome outcome;
  try {
    const RigEstimate estimate = calibrate(c.observations, c.options);
    outcome.doubts = estimate.calibration->trust_warnings;
    outcome.warnings = estimate.calibration->warnings;
    if (statistics) outcome.statistics = statistics_of(estimate);
  } catch (const Error& error) {
    outcome.refused = true;
    outcome.doubts = {error.what()};
  }
  return outcome;
}

bool any_names(const std::vector<std::string>& texts, const std::vector<std::string>& words) {
  return std::any_of(texts.begin(), texts.end(), [&](const std::string& doubt) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
      return doubt.find(word) != std::string::npos;
    });
  });
}

/// 95 % interval of a rate by Clopper and Pearson.
std::array<double, 2> rate_interval(int hits, int trials) {
  const double low = hits == 0 ? 0 : internal::beta_quantile(0.025, hits, trials - hits + 1);
  const double high = hits == trials ? 1 : internal::beta_quantile(0.975, hits + 1, trials - hits);
  return {low, high};
}

void report(const Arguments& how, const std::string& name, const Outcome& outcome) {
  if (how.statistics) fmt::print("   {}: {}\n", name, outcome.statistics);
  if (!how.verbose) return;
  for (const std::string& doubt : outcome.doubts) {
    fmt::print("   {}: {}{}\n", name, outcome.refused ? "refused: " : "", doubt.substr(0, 400));
  }
}

void judge_good(const Arguments& how, const char* what, const std::vector<NamedCase>& sets) {
  if (sets.empty()) return;
  int accused = 0;
  for (const NamedCase& good : sets) {
    const Outcome outcome = outcome_of(good.set, how.statistics);
    accused += !outcome.doubts.empty();
    report(how, good.name, outcome);
  }
  const auto n = static_cast<int>(sets.size());
  const auto [low, high] = rate_interval(accused, n);
  fmt::print("{}: {} of {} accused, {:.1f} % ({:.1f} to {:.1f} %)\n", what, accused, n,
             100.0 * accused / n, 100 * low, 100 * high);
  std::fflush(stdout);
}

void judge_faults(const Arguments& how, const char* what, const std::vector<NamedCase>& sets) {
  if (sets.empty()) return;
  fmt::print("\n{}\n{:<44} {:>20} {:>5} {:>8} {:>10} {:>9} {:>8}\n", what, "fault", "size", "sets",
             "named %", "other way %", "warned %", "silent %");
  for (const CalibrationFault& fault : calibration_faults()) {
    if (fault.name.find(how.only) == std::string::npos) continue;
    for (const double size : fault.sizes) {
      int named = 0, other = 0, warned = 0, silent = 0;
      for (std::size_t i = 0; i < sets.size(); ++i) {
        CalibrationCase wrong = sets[i].set;
        std::mt19937_64 random(7919 * i + static_cast<std::uint64_t>(100 * size));
        fault.apply(wrong, size, random);
        const Outcome outcome = outcome_of(wrong, how.statistics);
        ++(any_names(outcome.doubts, fault.words)     ? named
           : !outcome.doubts.empty()                  ? other
           : any_names(outcome.warnings, fault.words) ? warned
                                                      : silent);
        report(how, fmt::format("{} {} {}", fault.name, size, sets[i].name), outcome);
      }
      const double percent = 100.0 / static_cast<double>(sets.size());
      fmt::print("{:<44} {:>20} {:>5} {:>8.0f} {:>10.0f} {:>9.0f} {:>8.0f}\n", fault.name,
                 fmt::format("{} {}", size, fault.unit), sets.size(), percent * named,
                 percent * other, percent * warned, percent * silent);
      std::fflush(stdout);
    }
  }
}

/// "NAME,FILE,640x480,MODEL,9x6"; the truth is the set's own solution.
NamedCase real_case(const std::string& text) {
  std::istringstream stream(text);
  std::string name, file, size, model, board;
  std::getline(stream, name, ',');
  std::getline(stream, file, ',');
  std::getline(stream, size, ',');
  std::getline(stream, model, ',');
  std::getline(stream, board, ',');
  const Eigen::Vector2i size_px(std::stoi(size), std::stoi(size.substr(size.find('x') + 1)));
  const Chessboard target{std::stoi(board), std::stoi(board.substr(board.find('x') + 1)), 0.025};
  CalibrationCase c{read_corners(file, target, {size_px, size_px}), {}, {}};
  c.options.model = camera_model(model);
  const RigEstimate solved = calibrate(c.observations, c.options);
  const CalibrationEvidence& e = *solved.evidence;
  c.truth = {solved.rig, e.frames, e.T_first_board, e.warp_m};
  return {name, std::move(c)};
}

std::pair<std::uint64_t, std::uint64_t> range(const std::string& text) {
  return {std::stoull(text), std::stoull(text.substr(text.find("..") + 2))};
}

Arguments parsed(int argc, char** argv) {
  Arguments how;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--verbose")
      how.verbose = true;
    else if (option == "--statistics")
      how.statistics = true;
    else if (i + 1 == argc)
      throw Error(option, "it is not an option or has no value", "");
    else if (option == "--seeds")
      how.seeds = range(argv[++i]);
    else if (option == "--faulty")
      how.faulty = range(argv[++i]);
    else if (option == "--real")
      how.real.emplace_back(argv[++i]);
    else if (option == "--only")
      how.only = argv[++i];
    else
      throw Error(option, "it is not an option", "");
  }
  return how;
}

std::vector<NamedCase> simulated(std::pair<std::uint64_t, std::uint64_t> seeds) {
  std::vector<NamedCase> sets;
  for (std::uint64_t seed = seeds.first; seed <= seeds.second; ++seed) {
    sets.push_back({fmt::format("seed {}", seed), simulated_case(seed)});
  }
  return sets;
}

/// A real set, and of one with twelve frames or more its halves (also every second frame) and ten
/// random choices of two thirds of its frames.
std::vector<NamedCase> parts_of(const NamedCase& whole) {
  std::vector<NamedCase> parts{whole};
  if (whole.set.truth.frames.size() < 12) return parts;
  const auto add = [&](const std::string& name, const auto& kept) {
    parts.push_back({whole.name + " " + name, subset_of(whole.set, kept)});
  };
  add("even", [](std::size_t i, std::size_t) { return i % 2 == 0; });
  add("odd", [](std::size_t i, std::size_t) { return i % 2 == 1; });
  add("first half", [](std::size_t i, std::size_t n) { return 2 * i < n; });
  add("second half", [](std::size_t i, std::size_t n) { return 2 * i >= n; });
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    add(fmt::format("two thirds, {}", seed),
        [&](std::size_t, std::size_t) { return random() % 3 != 0; });
  }
  return parts;
}

void run(const Arguments& how) {
  judge_good(how, "good simulated sets", simulated(how.seeds));
  std::vector<NamedCase> real, parts;
  for (const std::string& text : how.real) {
    real.push_back(real_case(text));
    const auto some = parts_of(real.back());
    parts.insert(parts.end(), some.begin(), some.end());
  }
  judge_good(how, "good real sets and parts of them", parts);
  judge_faults(how, "faults in simulated sets", simulated(how.faulty));
  judge_faults(how, "faults in real sets", real);
}

}  // namespace
}  // namespace vernier::bench

int main(int argc, char** argv) {
  try {
    vernier::bench::run(vernier::bench::parsed(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "wrong_calibrations: {}\n", error.what());
    return 2;
  }
}
