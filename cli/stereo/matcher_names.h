// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "stereo/matcher.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Matchers on the command line.
struct MatcherOptions {
  std::string names;  ///< "edge,bm,sgbm"; names of commands among them if need be
  std::vector<std::string>
      commands;             ///< programs (stereo/matching/external_matcher.h), "NAME=command" …
                            ///< or the command alone, named by its program
  double time_limit_s = 0;  ///< of a program for each pair; 0: none
};

/// Those of the list in its order, then the commands that it does not name. Throws Error for a name
/// that is none, one given twice, and where nothing is named.
std::vector<Matcher> matchers_named(const MatcherOptions& options);

/// The only command or, where there is none, the only one of the list. Throws Error for several.
Matcher single_matcher(const MatcherOptions& options);

/// --command and --time-limit-s.
CLI::Option* add_command_options(CLI::App& verb, MatcherOptions& options);

}  // namespace vernier::cli
