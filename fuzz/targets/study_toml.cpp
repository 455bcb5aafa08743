// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "sim/sources.h"
#include "sim/sources/measured_sources.h"
#include "sim/sources/sources_file.h"
#include "sim/study/study_file.h"
#include "sim/systems/systems.h"
#include "sim/tuning/tune_settings.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::sim::internal;

void require_whole_study(const StudyFile& study) {
  std::size_t cells = 1;
  for (const auto& values : study.sweep_values) cells *= values.size();
  require(study.cells.size() == cells && cells > 0, "a study has a cell for every combination");
  require(study.trials >= 1 && study.trials_per_block >= 1, "a study has trials");
}

/// Its [tune]: what confirms a candidate must be a study with its cells.
void require_confirmations(const std::string& text, const StudyFile& study) {
  const auto settings = accepted([&] { return parse_tune(text, "study.toml", study); });
  if (!settings) return;
  const auto candidates = accepted([&] { return candidates_of(study, *settings, "study.toml"); });
  if (!candidates) return;
  for (const Candidate* candidate : {&candidates->front(), &candidates->back()}) {
    const std::string confirming = confirmation_text(text, "study.toml", *candidate, *settings);
    // refused where trials times worlds are too many, or a world of its own is asked for
    const auto read = accepted([&] { return parse_study(confirming, "confirming.toml"); });
    if (!read) continue;
    require_whole_study(*read);
    require(read->trials == settings->confirm_trials, "a confirmation has its trials");
    require(worlds_of(*read) == settings->confirm_worlds, "a confirmation has its worlds");
  }
}

/// What studies can try besides localisers.
void know_systems() {
  static const bool known = (register_systems(), true);
  static_cast<void>(known);
}

void run_study_toml(std::string_view bytes) {
  know_systems();
  const auto study = accepted([&] { return parse_study(std::string(bytes), "study.toml"); });
  if (!study) return;
  require_whole_study(*study);
  require_confirmations(std::string(bytes), *study);
}

/// A file of sources that a study refers to.
void run_sources_toml(std::string_view bytes) {
  const std::string study = "[study]\n[sources]\nfile = \"sources.toml\"\n";
  const auto file = input_file(bytes, "sources.toml");
  const auto read = accepted([&] { return parse_study(study, "study.toml", file); });
  if (read) require_whole_study(*read);
}

/// Nothing writes studies: as docs/file-formats.md has them.
std::vector<std::string> study_toml_seeds() {
  return {
      "[study]\ntrials = 900\nseed = 1\nprotocol = \"path\"\n[world]\nfile = \"workshop\"\n"
      "[rig]\nfile = \"nominal\"\n[sources]\ncalibration = 1.0\n[camera]\nheight_m = 1.2\n"
      "pitch_deg = 0\n[map]\npath = \"default\"\nspacing_m = 0.5\nheadings = \"path\"\n"
      "rig = \"recalibrated\"\n[localiser]\nmethod = \"pgh\"\nlooks = 1\n"
      "[sweep]\n\"sources.calibration\" = [0.1, 1, 10]\n\"map.headings\" = [\"path\", 8]\n",
      "[study]\ntrials = 12\n[sources]\nlateral_shift_mode = \"independent\"\n"
      "[localiser]\nknows_endpoint_sigma = true\n",
      "[study]\n[rig]\ntruth = \"true.json\"\nerror = \"given\"\n[sweep]\n\"rig.file\" = [\"a\", "
      "\"b\"]\n"
      "\"world.file\" = [\"c\", \"d\"]\n",
      "[study]\n[calibration]\nmodel = \"opencv4\"\nboard = \"9x6\"\nsquare_m = 0.025\n"
      "pixel_sigma_px = 0.2\ndistance_m = 1\ntilt_deg = 30\n[sweep]\n\"calibration.views\" = [3, "
      "20]\n",
      "[study]\n[calibration]\nviews = 5\nobservations = \"corners.vnl\"\n",
      "[study]\ntrials = 60\n[sweep]\n\"map.spacing_m\" = [0.5, 1]\n\"localiser.method\" = "
      "[\"lines\", \"pgh\"]\n\"sources.calibration\" = [1, 3]\n[tune]\nobjective = \"error\"\n"
      "indifference = 0.02\nerror_rate = 0.1\nconditions = [\"sources.calibration\"]\n"
      "confirm_worlds = [\"a\", \"b\"]\nconfirm_seed = 3\nconfirm_trials = 12\n",
      "[study]\n[system]\nname = \"calibration\"\nsuccess_error = 0.1\nrange_m = 4\n"
      "[calibration]\nviews = 5\n[sweep]\n\"system.range_m\" = [2, 4]\n",
      "[study]\n[system]\nname = \"program\"\ncommand = \"./a 'b c'\"\nsuccess_error = 1\n"
      "measured = [\"drift_m\"]\n[parameters]\ngain = 1.5\nmode = \"fast\"\non = true\n"
      "[sweep]\n\"parameters.gain\" = [1, 2]\n",
      "[study]\n[system]\nname = \"servoing\"\ngoal = \"model\"\n[one_at_a_time]\n"};
}

std::vector<std::string> sources_toml_seeds() {
  return {sources_toml(MeasuredSources{}),
          sources_toml(MeasuredSources{}, sim::ShiftMode::independent),
          "[sources]\nedge_loss = 0.2\nlateral_shift_px = 1\ncalibration = 2\n"};
}

const Registered registered_sources_toml{
    {"sources_toml", 2000, "study", run_sources_toml, sources_toml_seeds}};
const Registered registered_study_toml{
    {"study_toml", 2000, "study", run_study_toml, study_toml_seeds}};

}  // namespace
}  // namespace vernier::fuzz
