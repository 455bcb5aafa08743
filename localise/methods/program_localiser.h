// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/program_conversation.h"
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
  ~ProgramLocaliser() override;

  LocalisationAnswer localise(const PlaceView& query) const override;
  LocalisationAnswer localise_looks(std::span<const Look> looks) const override;

 private:
  using Conversation = vernier::internal::ProgramConversation;

  void start() const;

  const TopologicalMap& map_;
  std::string command_;
  std::vector<std::string> words_;
  double time_limit_s_;
  // The program is all the state there is; what it answers should depend on the query alone.
  mutable std::unique_ptr<Conversation> program_;
  mutable int failures_ = 0;     // one after the other
  mutable std::string failure_;  // the last
};

/// Parses an answer. Throws Error for what is not one.
LocalisationAnswer parse_answer(std::string_view line, const TopologicalMap& map);

}  // namespace vernier::localise::internal
