// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "sim/tuning/confirmation.h"
#include "sim/tuning/race.h"
#include "sim/tuning/race_search.h"
#include "sim/tuning/tune_settings.h"

namespace vernier::cli {

/// A candidate that was confirmed: its place, and what it shows on what was not searched.
struct ConfirmedCandidate {
  int candidate = 0;
  CandidateFigures figures;
};

/// What `tune` found.
struct TuneResult {
  TuneSettings settings;
  std::vector<Candidate> candidates;
  RaceState race;
  std::vector<int> order;                  ///< candidates from best to worst
  std::vector<CandidateFigures> searched;  ///< of each candidate
  std::vector<std::string> worlds;         ///< searched
  std::vector<std::uint64_t> seeds;
  int rounds = 0;              ///< that a candidate may have
  double shortfall_limit = 0;  ///< shortfall_limit() of the winner
  RaceCost cost;
  /// The winner, and what it is compared with: the first candidate, or the second best if the
  /// winner is the first.
  ConfirmedCandidate winner, reference;
  ConfirmedDifference difference;  ///< winner minus reference
};

Json tune_json(const TuneResult& result);
std::string tune_text(const TuneResult& result);

/// Why the winner is not to be trusted; empty if nothing speaks against it.
std::string doubt_of(const TuneResult& result);

/// The folder of a confirmation within that of the search: "confirm-7" of the seventh candidate.
std::string confirmation_folder(int candidate);

}  // namespace vernier::cli
