// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/matcher_names.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <sstream>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "cli/program/option_checks.h"
#include "stereo/matcher.h"
#include "stereo/matching/built_in_matchers.h"
#include "stereo/matching/external_matcher.h"

namespace vernier::cli {
namespace {

bool is_built_in(const std::string& name) {
  const std::vector<std::string>& known = built_in_matchers();
  return name == "none" || std::find(known.begin(), known.end(), name) != known.end();
}

Matcher matcher_named(const std::string& name) {
  const std::vector<std::string>& known = built_in_matchers();
  if (std::find(known.begin(), known.end(), name) != known.end()) return built_in_matcher(name);
  throw Error("--matcher", "unknown matcher " + in_quotes(name),
              "supported: edge, stretch, bm, sgbm, or a name defined by --command NAME=…");
}

bool is_named(const std::vector<Matcher>& matchers, const std::string& name) {
  return std::any_of(matchers.begin(), matchers.end(),
                     [&](const Matcher& matcher) { return matcher.name == name; });
}

/// Parses "NAME=command" or a command, which is then named after its program and numbered if
/// necessary.
Matcher command_matcher(const std::string& text,
                        const MatcherOptions& options,
                        const std::vector<Matcher>& others) {
  const std::size_t end =
      text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.");
  const bool named = end != std::string::npos && end > 0 && text[end] == '=';
  Matcher matcher = external_matcher(named ? text.substr(end + 1) : text,
                                     {.time_limit_s = options.time_limit_s, .told = options.told});
  if (named) matcher.name = text.substr(0, end);
  if (named && is_built_in(matcher.name)) {
    throw Error("--command",
                in_quotes(matcher.name) +
                    (matcher.name == "none" ? " stands for no matcher" : " is a built-in matcher"),
                "give the program another name");
  }
  const std::string base = matcher.name;
  for (int k = 2; !named && (is_named(others, matcher.name) || is_built_in(matcher.name)); ++k) {
    matcher.name = base + "-" + std::to_string(k);
  }
  return matcher;
}

}  // namespace

std::vector<Matcher> matchers_named(const MatcherOptions& options) {
  std::vector<Matcher> programs, matchers;
  const auto add = [](std::vector<Matcher>& to, const Matcher& matcher) {
    if (is_named(to, matcher.name)) {
      throw Error("--matcher", "\"" + matcher.name + "\" is given twice", "give each matcher once");
    }
    to.push_back(matcher);
  };
  for (const std::string& command : options.commands) {
    add(programs, command_matcher(command, options, programs));
  }
  std::istringstream stream(options.names);
  for (std::string name; std::getline(stream, name, ',');) {
    if (name.empty() || name == "none") continue;
    const auto program = std::find_if(programs.begin(), programs.end(),
                                      [&](const Matcher& m) { return m.name == name; });
    add(matchers, program != programs.end() ? *program : matcher_named(name));
  }
  for (const Matcher& program : programs) {
    if (!is_named(matchers, program.name)) matchers.push_back(program);
  }
  if (matchers.empty())
    throw Error("--matcher", "no matcher given", "give edge, stretch, bm or sgbm");
  return matchers;
}

Matcher single_matcher(const MatcherOptions& options) {
  MatcherOptions one = options;
  if (!one.commands.empty()) one.names.clear();
  const std::vector<Matcher> matchers = matchers_named(one);
  if (matchers.size() == 1) return matchers.front();
  throw Error("--matcher", "more than one matcher given", "give one of edge, stretch, bm and sgbm");
}

std::string doubt_about(const MapRange& map, int most_px) {
  constexpr double much = 0.1;
  if (map.share_above() < much) return "";
  return fmt::format(
      "{:.0f} % of the program's disparities are above the {} px asked for and are taken as "
      "unknown: the scale of its map may be wrong (pixels, or 256 per pixel in a 16-bit PNG), or "
      "--max-disparity too small",
      100 * map.share_above(), most_px);
}

CLI::Option* add_command_options(CLI::App& verb, MatcherOptions& options) {
  CLI::Option* commands =
      verb.add_option("--command", options.commands,
                      "external program as a matcher: NAME=COMMAND or COMMAND with placeholders "
                      "{left} {right} {output} {least} {most} (docs/matchers.md)")
          ->expected(1)
          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option("--time-limit-s", options.time_limit_s,
                  "time limit of an external program per pair, seconds; 0: none")
      ->check(finite_and_not_negative)
      ->needs(commands)
      ->capture_default_str();
  return commands;
}

}  // namespace vernier::cli
