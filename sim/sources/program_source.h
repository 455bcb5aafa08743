// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <string_view>

#include "calib/base/answering_program.h"
#include "calib/base/json_node.h"
#include "calib/rig.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

/// A program that reads views as lines of JSON and answers which edges it keeps, moves and adds, in
/// lines of JSON (docs/own-source.md). It is started again after a failure: a view that it does not
/// answer, not in time or with nonsense, has a failure. After three failures one after the other it
/// is left alone.
class ProgramSource : public UncertaintySource {
 public:
  /// Throws Error if the program cannot be started.
  ProgramSource(const SourceSettings& settings, const Rig& rig);

  std::string_view name() const override { return "command"; }
  void apply(const SensingContext& context, SensedView& view) const override;

 private:
  mutable std::mutex mutex_;
  // The program is all the state there is; what it answers should depend on the view alone.
  mutable vernier::internal::AnsweringProgram program_;
};

/// Makes of a view what an answer of the program says. Throws Error for what is none to it.
void apply_answer(const vernier::internal::JsonNode& answer, const Rig& rig, SensedView& view);

}  // namespace vernier::sim::internal
