// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"
#include "sim/sequence/sequence_samples.h"

namespace vernier::cli {

/// The options of `vernier characterise --sequence`.
struct SequenceArguments {
  std::string segments, poses, rig, depth;
  double depth_unit_m = 0.001, block_m = 2;
  sim::internal::SequenceOptions how;
};

void add_sequence_options(CLI::App& verb, SequenceArguments& options);

/// Refuses options of the pairs with --sequence, and of the sequence without it. Throws Error.
void check_sequence_options(const CLI::App& verb, const SequenceArguments& options);

/// Measures the sources from looks at the same lines (docs/characterise.md).
void characterise_sequence(const SequenceArguments& options,
                           const std::string& output,
                           std::uint64_t seed,
                           Session& session);

}  // namespace vernier::cli
