// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/stereo/characterise_report.h"
#include "cli/stereo/characterise_sequence.h"
#include "cli/stereo/evaluate_scene.h"
#include "cli/stereo/matcher_names.h"
#include "cli/stereo/scene_options.h"
#include "sim/sources.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"
#include "stereo/evaluation/pair_samples.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "stereo/matcher.h"
#include "stereo/matching/external_matcher.h"

namespace vernier::cli {
namespace {

struct CharacteriseArguments {
  SceneOptions scenes;
  MatcherOptions matcher{"edge", {}, 0};
  std::string output, lateral_shift = "common";
  std::uint64_t seed = 1;
  bool repair = false;
  PairSamplesOptions sampling;
  SequenceArguments sequence;
};

/// The settings that affect the results, apart from the pairs.
std::string how_measured(const CharacteriseArguments& options, const Matcher& matcher) {
  return fmt::format("matcher {}, {} corners per image, segments of at least {:g} px{}",
                     matcher.name, options.sampling.corners, options.sampling.warp.min_length_px,
                     options.repair ? ", rows repaired" : "");
}

PairSamples samples_of(const StereoSceneFile& file,
                       const Matcher& matcher,
                       const CharacteriseArguments& options,
                       Session& session) {
  const Scene scene = read_scene(file, options.repair, session);
  PairSamples samples = pair_samples(scene.pair, scene.map, file.range, matcher, options.sampling);
  samples.name = file.name;
  if (samples.losses.empty()) {
    session.warn(
        file.name +
        ": no usable straight edge: none has ground truth and is visible in the right image");
  }
  return samples;
}

/// Reports limitations of the results. Returns whether they can be written.
bool report_limitations(const MeasuredSources& sources, Session& session) {
  constexpr double max_edge_loss = 0.6, max_wrong = 0.5, max_chance = 0.35, max_shift_px = 0.5;
  if (!sources.by_pair) {
    session.warn(
        fmt::format("{} pair{}: the intervals are over image parts and do not generalise to other "
                    "scenes; give at least six pairs",
                    sources.pairs.size(), sources.pairs.size() == 1 ? "" : "s"));
  }
  if (sources.edge_loss.chance > max_chance) {
    session.warn(
        fmt::format("{:.0f} % of any length is covered by other edges by chance: edge loss is "
                    "unreliable in such dense texture",
                    100 * sources.edge_loss.chance));
  }
  if (sources.lateral_shift.independent_px.interval.low > max_shift_px) {
    session.warn(
        "the views differ by more than half a pixel across the edges, which a common shift cannot "
        "explain: consider --lateral-shift independent");
  }
  bool any = false;
  for (const SourceEntry& entry : source_entries(sources)) any = any || entry.written;
  if (!any) {
    session.add_trust_warning("nothing could be measured: fewer than 30 samples for every source");
  } else if (sources.edge_loss.share.value > max_edge_loss) {
    any = false;
    session.add_trust_warning(
        fmt::format("{:.0f} % of the left image's edges are not at the position predicted by the "
                    "ground truth: check for swapped left and right images, and check truth_scale",
                    100 * sources.edge_loss.share.value));
  } else if (sources.corners.mismatch.value > max_wrong) {
    any = false;
    session.add_trust_warning(fmt::format(
        "{:.0f} % of the matched corners are not where the ground truth has them: check "
        "that it belongs to these images, its scale and its offset",
        100 * sources.corners.mismatch.value));
  } else if (sources.stereo_mismatch.share.value > max_wrong) {
    session.add_trust_warning(
        fmt::format("{:.0f} % of the matched lines are not where the ground truth has them: check "
                    "the truth, and the matcher and its range",
                    100 * sources.stereo_mismatch.share.value));
  }
  return any;
}

void run(const CharacteriseArguments& options, Session& session) {
  const std::vector<StereoSceneFile> files = scene_files(options.scenes);
  if (!options.output.empty())
    check_output_is_not_input(inputs_of(options.scenes, files), options.output);
  MapRange map;
  MatcherOptions told = options.matcher;
  told.told = [&map](const MapRange& range) {
    map.within += range.within;
    map.above += range.above;
  };
  const Matcher matcher = single_matcher(told);
  const ShiftMode mode =
      options.lateral_shift == "common" ? ShiftMode::common : ShiftMode::independent;
  std::vector<PairSamples> samples;
  {
    Progress progress(session, "characterising");
    for (const StereoSceneFile& file : files) {
      samples.push_back(samples_of(file, matcher, options, session));
      progress.update(static_cast<int>(samples.size()), static_cast<int>(files.size()));
    }
  }
  MeasuringOptions measuring;
  measuring.bootstrap.seed = options.seed;
  const MeasuredSources sources = measure_sources(samples, measuring);
  const bool trusted = report_limitations(sources, session);
  int most_px = 0;
  for (const StereoSceneFile& file : files) most_px = std::max(most_px, file.range.max_px);
  if (const std::string doubt = doubt_about(map, most_px); !doubt.empty()) {
    session.add_trust_warning(doubt);
  }
  if (!options.output.empty()) {
    if (trusted)
      write_atomically(options.output, sources_toml(sources, mode, how_measured(options, matcher)));
    else
      session.warn(options.output + " was not written");
  }
  measuring.bootstrap.resamples = 0;
  std::vector<MeasuredSources> each;
  each.reserve(samples.size());
  for (const PairSamples& pair : samples) each.push_back(measure_sources({pair}, measuring));
  const CharacteriseReport report{sources, each, mode, matcher.name};
  session.result(report_json(report), report_text(report));
}

}  // namespace

void add_characterise(CLI::App& app, Session& session) {
  auto o = std::make_shared<CharacteriseArguments>();
  CLI::App* verb =
      add_verb(app, session, "characterise",
               "measure the simulator's error sources on pairs with ground truth, or on a "
               "sequence of known motion",
               "vernier characterise --scenes pairs.toml -o sources.toml\n"
               "  vernier characterise --sequence segments.jsonl --poses poses.csv "
               "--rig K.txt --depth 'depth/*.png' -o sources.toml\n"
               "  then in a study file:  [sources]  file = \"sources.toml\"");
  add_scene_options(*verb, o->scenes);
  auto* matcher =
      verb->add_option("--matcher", o->matcher.names,
                       "matcher whose mismatches are measured: edge, stretch, bm or sgbm")
          ->capture_default_str();
  add_command_options(*verb, o->matcher)->excludes(matcher);
  verb->add_option("-o,--output", o->output, "output TOML file with a [sources] table");
  verb->add_option("--lateral-shift", o->lateral_shift,
                   "common: keep the default, which a pair cannot measure; independent: measured "
                   "difference between the cameras")
      ->check(CLI::IsMember({"common", "independent"}))
      ->capture_default_str();
  verb->add_option("--least-length", o->sampling.warp.min_length_px,
                   "minimum segment length, pixels (the simulator uses 10)")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--corners", o->sampling.corners,
                   "maximum number of corners in the left image, strongest first")
      ->check(CLI::Range(30, 100000))
      ->capture_default_str();
  verb->add_flag("--repair", o->repair, "correct the vertical misalignment estimated from corners");
  verb->add_option("--seed", o->seed, "random seed of the bootstrap")->capture_default_str();
  add_sequence_options(*verb, o->sequence);
  check_files_written(*verb, {"--output"});
  verb->callback([o, verb, &session] {
    if (o->sequence.segments.empty()) require_scenes(*verb, o->scenes);
    session.action = [=, &session] {
      check_sequence_options(*verb, o->sequence);
      if (o->sequence.segments.empty()) {
        run(*o, session);
        return;
      }
      o->sequence.how.min_length_px = o->sampling.warp.min_length_px;
      characterise_sequence(o->sequence, o->output, o->seed, session);
    };
  });
}

}  // namespace vernier::cli
