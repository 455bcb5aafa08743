// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "stereo/matcher.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Matcher options from the command line.
struct MatcherOptions {
  std::string names;  ///< "edge,bm,sgbm"; may include names of commands
  std::vector<std::string>
      commands;             ///< programs (stereo/matching/external_matcher.h), "NAME=command" …
                            ///< or the command alone, named after its program
  double time_limit_s = 0;  ///< of a program per pair; 0: none
};

/// The matchers of the list in order, then the commands that are not in the list. Throws Error for
/// unknown or repeated names and for an empty list.
std::vector<Matcher> matchers_named(const MatcherOptions& options);

/// The only command or, without commands, the only matcher of the list. Throws Error for several.
Matcher single_matcher(const MatcherOptions& options);

/// Adds --command and --time-limit-s.
CLI::Option* add_command_options(CLI::App& verb, MatcherOptions& options);

}  // namespace vernier::cli
