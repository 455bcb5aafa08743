// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "stereo/matcher.h"
#include "stereo/matching/external_matcher.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Matcher options from the command line.
struct MatcherOptions {
  std::string names;  ///< "edge,bm,sgbm"; may include names of commands
  std::vector<std::string>
      commands;             ///< programs (stereo/matching/external_matcher.h), "NAME=command" …
                            ///< or the command alone, named after its program
  double time_limit_s = 0;  ///< of a program per pair; 0: none
  std::function<void(const MapRange&)> told = {};  ///< called with the range of programs' maps
};

/// The matchers of the list in order, then the commands that are not in the list. Throws Error for
/// unknown or repeated names, for a program named like a built-in matcher, and for an empty list.
std::vector<Matcher> matchers_named(const MatcherOptions& options);

/// The only command or, without commands, the only matcher of the list. Throws Error for several.
Matcher single_matcher(const MatcherOptions& options);

/// Why a program's map is not to be trusted; empty unless much of it is above the range.
std::string doubt_about(const MapRange& map, int most_px);

/// Adds --command and --time-limit-s.
CLI::Option* add_command_options(CLI::App& verb, MatcherOptions& options);

}  // namespace vernier::cli
