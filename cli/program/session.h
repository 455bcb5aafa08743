// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/program/cli11_fwd.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {

using Json = nlohmann::ordered_json;

/// The words of a call in one line, quoted where a shell would read them otherwise; the program by
/// its name alone.
std::string command_line(int argc, const char* const* argv);

/// A number, or null where it is not finite, which JSON cannot say.
Json json_number(double value);

/// Exit codes of the program (docs/conventions.md).
enum class Exit { done = 0, internal_error = 1, bad_input = 2, untrusted = 3 };

/// One call of the program: what the verbs share.
class Session {
 public:
  bool quiet = false;
  bool json = false;
  std::string command;  ///< the call as a shell takes it; pages and results say it

  /// A line to standard error, unless quiet.
  void say(const std::string& line) const;
  /// A warning to standard error, unless quiet.
  void warn(const std::string& line) const { say("warning: " + line); }
  /// The result is there but not to be trusted, for this reason: exit code 3.
  void add_trust_warning(const std::string& reason);
  /// The result: the JSON object with --json, else the text, to standard output.
  void result(const Json& object, const std::string& text) const;

  Exit exit_code() const { return trust_warnings_.empty() ? Exit::done : Exit::untrusted; }
  const std::vector<std::string>& trust_warnings() const { return trust_warnings_; }

  /// The verb to run once the command line has been read.
  std::function<void()> action;

 private:
  std::vector<std::string> trust_warnings_;
};

/// How far a long job is, on standard error: a bar with the time left on a terminal, a plain line
/// now and then in a pipe, nothing where quiet.
class Progress {
 public:
  Progress(const Session& session, std::string what);
  ~Progress();
  void update(int done, int total);

 private:
  void draw(int done, int total, double elapsed_s);

  std::string what_;
  bool quiet_, terminal_, drawn_ = false;
  int tenths_reported_ = -1;
  std::chrono::steady_clock::time_point start_;
};

/// Adds a verb with the options that all have: -q, --json, and its worked example below its help.
CLI::App* add_verb(CLI::App& app,
                   Session& session,
                   const std::string& name,
                   const std::string& about,
                   const std::string& example);

/// "9x6" as two whole numbers. Throws Error naming the option.
std::pair<int, int> parse_size(const std::string& text, const std::string& option);

/// The same of a grid or a board: neither side above 1000.
std::pair<int, int> parse_grid(const std::string& text, const std::string& option);

/// "1,5,inf" as distances above 0, each once. Throws Error naming the option.
std::vector<double> parse_distances(const std::string& text, const std::string& option);

/// "10,7.5,0" as n numbers. Throws Error naming the option.
std::vector<double> parse_numbers(const std::string& text,
                                  std::size_t n,
                                  const std::string& option);

}  // namespace vernier::cli
