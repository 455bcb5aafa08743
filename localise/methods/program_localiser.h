// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "calib/base/answering_program.h"
#include "calib/base/json_node.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// A program that reads the map and queries as lines of JSON and answers in lines of JSON
/// (docs/own-localiser.md). It is started with the first query, and again after a failure: a
/// query that it does not answer, not in time or with nonsense, has the status `failed`. After
/// three failures one after the other it is left alone.
class ProgramLocaliser : public Localiser {
 public:
  ProgramLocaliser(const TopologicalMap& map, const LocaliserOptions& options);

  LocalisationAnswer localise(const PlaceView& query) const override;
  LocalisationAnswer localise_looks(std::span<const Look> looks) const override;

 private:
  const TopologicalMap& map_;
  // The program is all the state there is; what it answers should depend on the query alone.
  mutable vernier::internal::AnsweringProgram program_;
  mutable std::optional<double> counted_cpu_s_;  ///< CPU time up to the last answer
};

/// Reads an answer. Throws Error for what is not one.
LocalisationAnswer parse_answer(const vernier::internal::JsonNode& node, const TopologicalMap& map);

}  // namespace vernier::localise::internal
