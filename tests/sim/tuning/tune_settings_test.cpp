// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/tune_settings.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "calib/error.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/study_file.h"
#include "sim/tuning/objective.h"

namespace vernier {

using namespace sim;
using namespace vernier::sim::internal;

namespace {

const std::string study_text =
    "[study]\ntrials = 120\nseed = 4\n[world]\nfile = \"a\"\n"
    "[sources]\nedge_loss = 0.2\n[sweep]\n\"map.spacing_m\" = [0.5, 1.25]\n"
    "\"localiser.method\" = [\"lines\", \"pgh\"]\n\"sources.calibration\" = [0.1, 3]\n"
    "\"world.file\" = [\"a\", \"b\"]\n";

TuneSettings settings_of_text(const std::string& tune) {
  const std::string text = study_text + tune;
  return parse_tune(text, "t.toml", parse_study(text, "t.toml"));
}

/// What the error says of a [tune].
std::string refusal(const std::string& tune, const std::string& study = study_text) {
  try {
    const StudyFile file = parse_study(study + tune, "t.toml");
    const TuneSettings settings = parse_tune(study + tune, "t.toml", file);
    candidates_of(file, settings, "t.toml");
  } catch (const Error& error) {
    return std::string(error.what());
  }
  return "";
}

TEST(TuneSettings, HaveTheirDefaults) {
  const TuneSettings settings = settings_of_text("[tune]\nconfirm_worlds = [\"c\"]\n");
  EXPECT_EQ(settings.objective, Objective::success);
  EXPECT_EQ(settings.race.indifference, 0.01);
  EXPECT_EQ(settings.confirm_seed, 5u);
  EXPECT_EQ(settings.confirm_trials, 120);
}

// A world without a name is none; a study has named files too.
TEST(TuneSettings, NamesOfFilesAreNotEmpty) {
  EXPECT_NE(refusal("[tune]\nconfirm_worlds = [\"c\", \"\"]\n")
                .find("a name in tune.confirm_worlds is empty; name a file"),
            std::string::npos);
  for (const std::string key : {"world.file", "rig.file", "rig.truth", "sources.file"}) {
    const std::string section = key.substr(0, key.find('.')), name = key.substr(key.find('.') + 1);
    EXPECT_NE(refusal("", "[study]\n[" + section + "]\n" + name + " = \"\"\n")
                  .find("t.toml:3: " + key + " is empty; name a file"),
              std::string::npos)
        << key;
  }
}

TEST(TuneSettings, ConditionsMakeNoCandidates) {
  const StudyFile file = parse_study(study_text, "t.toml");
  TuneSettings settings;
  EXPECT_EQ(candidates_of(file, settings, "t.toml").size(), 8u);
  settings.conditions = {"sources.calibration"};
  const std::vector<Candidate> candidates = candidates_of(file, settings, "t.toml");
  ASSERT_EQ(candidates.size(), 4u);
  EXPECT_EQ(candidates[1].label, "map.spacing_m = 0.5, localiser.method = pgh");
  for (const Candidate& candidate : candidates) EXPECT_EQ(candidate.cells.size(), 4u);
}

// Confirmed is what was raced: the same settings, other worlds, seed and trials.
TEST(TuneSettings, AConfirmationDiffersInWorldsSeedAndTrialsOnly) {
  const std::string tune =
      "[tune]\nconditions = [\"sources.calibration\"]\nconfirm_worlds = [\"c\", \"d\"]\n"
      "confirm_trials = 77\n";
  const std::string text = study_text + tune;
  const StudyFile file = parse_study(text, "t.toml");
  const TuneSettings settings = parse_tune(text, "t.toml", file);
  for (const Candidate& candidate : candidates_of(file, settings, "t.toml")) {
    const StudyFile confirming =
        parse_study(confirmation_text(text, "t.toml", candidate, settings), "c.toml");
    EXPECT_EQ(confirming.trials, 77);
    EXPECT_EQ(worlds_of(confirming), (std::vector<std::string>{"c", "d"}));
    ASSERT_EQ(confirming.cells.size(), candidate.cells.size());
    for (std::size_t i = 0; i < confirming.cells.size(); ++i) {
      auto confirmed = confirming.cells[i].settings;
      EXPECT_EQ(confirming.cells[i].experiment.seed, 5u);
      bool found = false;
      for (const int cell : candidate.cells) {
        auto raced = file.cells[static_cast<std::size_t>(cell)].settings;
        for (const char* key : {"world.file", "study.seed"}) {
          raced.erase(key);
          confirmed.erase(key);
        }
        found = found || raced == confirmed;
      }
      EXPECT_TRUE(found) << candidate.label;
    }
  }
}

TEST(TuneSettings, RefusesWhatCannotBeRacedOrConfirmed) {
  const std::string ok = "confirm_worlds = [\"c\"]\n";
  EXPECT_EQ(refusal("[tune]\n" + ok), "");
  EXPECT_NE(refusal("").find("has no [tune]"), std::string::npos);
  EXPECT_NE(refusal("[tune]\n").find("confirm_worlds"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nconfirm_worlds = []\n").find("empty"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nconfirm_worlds = [\"b\"]\n").find("is searched"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nconfirm_worlds = [\"c\", \"c\"]\n").find("twice"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nconfirm_seed = 4\n" + ok).find("is searched"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nobjective = \"speed\"\n" + ok).find("speed"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nindifference = 2\n" + ok).find("out of range"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nerror_rate = 0\n" + ok).find("out of range"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nconfirm_trials = 0\n" + ok).find("out of range"), std::string::npos);
  EXPECT_NE(refusal("[tune]\nconditions = [\"map.rig\"]\n" + ok).find("not swept"),
            std::string::npos);
  EXPECT_NE(refusal("[tune]\nobjectiv = \"success\"\n" + ok).find("t.toml:"), std::string::npos);
  EXPECT_NE(refusal("[tune]\n" + ok, "[study]\n[sweep]\n\"world.file\" = [\"a\", \"b\"]\n")
                .find("nothing to race"),
            std::string::npos);
  const std::string limits =
      "[study]\n[system]\nname = \"localiser\"\n[sweep]\n\"system.success_error\" = [0.1, 1]\n"
      "\"map.spacing_m\" = [1, 2]\n";
  EXPECT_NE(refusal("[tune]\n" + ok, limits).find("t.toml:5: a race over system.success_error is"),
            std::string::npos);
  EXPECT_EQ(refusal("[tune]\nconditions = [\"system.success_error\"]\n" + ok, limits), "");
  EXPECT_NE(refusal("[tune]\n" + ok, "[study]\n").find("nothing to race"), std::string::npos);
  EXPECT_NE(refusal("[tune]\n" + ok, "[study]\ninterval_width = 0.05\n").find("interval_width"),
            std::string::npos);
  EXPECT_NE(
      refusal("[tune]\n" + ok, "[study]\n[one_at_a_time]\ndesigns = [\"only\"]\n").find("[sweep]"),
      std::string::npos);
}

TEST(Objective, ScoresAreInTheUnitInterval) {
  TrialResult right, wrong, none, unsure;
  right.status = wrong.status = localise::LocalisationStatus::answered;
  right.error = 0.25;
  wrong.error = 1.5;
  unsure.error = 0.5;
  none.error = std::numeric_limits<double>::quiet_NaN();
  const auto all = [&](Objective o) {
    return std::vector<double>{score(o, right), score(o, wrong), score(o, none), score(o, unsure)};
  };
  EXPECT_EQ(all(Objective::success), (std::vector<double>{1, 0, 0, 0}));
  EXPECT_EQ(all(Objective::best_guess), (std::vector<double>{1, 0, 0, 1}));
  EXPECT_EQ(all(Objective::answered_right), (std::vector<double>{1, 0, 0.5, 0.5}));
  EXPECT_EQ(all(Objective::error), (std::vector<double>{0.75, 0, 0, 0}));
  for (const Objective o :
       {Objective::success, Objective::best_guess, Objective::answered_right, Objective::error}) {
    EXPECT_EQ(objective_named(name(o)), o);
  }
  EXPECT_THROW(objective_named("speed"), Error);
}

}  // namespace
}  // namespace vernier
