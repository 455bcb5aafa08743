// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "cli/program/namespaces.h"
#include "sim/sources.h"

namespace vernier::cli {

/// What a verb is told of the error sources.
struct SourceOptions {
  std::string file;                ///< of --sources; empty: none
  std::vector<std::string> words;  ///< of --source, such as "edge_loss=0.2"
};

/// Adds --sources and --source.
void add_source_options(CLI::App& verb, SourceOptions& options);

/// Applies the file and then the words to `settings`; the word "none", given first, turns all
/// sources off. Throws Error for what is unknown, out of range, given twice or without effect.
SourceSettings sources_of(const SourceOptions& options, SourceSettings settings = {});

}  // namespace vernier::cli
