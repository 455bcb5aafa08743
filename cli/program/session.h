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

/// The command line as one line, quoted for a shell where needed; the program without its path.
std::string command_line(int argc, const char* const* argv);

/// A number, or null if it is not finite (JSON has no NaN or infinity).
Json json_number(double value);

/// Exit codes of the program (docs/conventions.md).
enum class Exit { done = 0, internal_error = 1, bad_input = 2, untrusted = 3 };

/// State of one program call, shared by the verbs.
class Session {
 public:
  bool quiet = false;
  bool json = false;
  std::string command;  ///< the command line, quoted for a shell; stored in pages and results

  /// Prints a line to standard error, unless quiet.
  void info(const std::string& line) const;
  /// Prints a warning to standard error, unless quiet, and keeps it for the JSON object.
  void warn(const std::string& line);
  /// Records a reason why the result is not trustworthy: exit code 3. It is printed to standard
  /// error with the result, so that a call that fails prints nothing but its error.
  void add_trust_warning(const std::string& reason);
  /// Prints the reasons that are not yet printed.
  void tell_trust_warnings();
  /// Prints the result to standard output: the JSON object with --json, otherwise the text. The
  /// object gets the key `warnings` if there were any (beside those it holds under that key), and
  /// `doubts` with the reasons of exit code 3. Throws Error if it cannot be written.
  void result(const Json& object, const std::string& text);

  Exit exit_code() const { return trust_warnings_.empty() ? Exit::done : Exit::untrusted; }
  const std::vector<std::string>& trust_warnings() const { return trust_warnings_; }

  /// The action to run after the command line has been parsed.
  std::function<void()> action;

 private:
  std::vector<std::string> warnings_;
  std::vector<std::string> trust_warnings_;
  std::size_t told_ = 0;  ///< of trust_warnings_
};

/// Progress of a long job on standard error: a bar with the remaining time on a terminal, plain
/// lines at every tenth otherwise, nothing if quiet.
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

/// Adds a verb with the common options -q and --json, and an example below its help text.
CLI::App* add_verb(CLI::App& app,
                   Session& session,
                   const std::string& name,
                   const std::string& about,
                   const std::string& example);

/// Parses "9x6" as two positive integers. Throws Error naming the option.
std::pair<int, int> parse_size(const std::string& text, const std::string& option);

/// "640x480,1280x960": one or several of them.
std::vector<std::pair<int, int>> parse_sizes(const std::string& text, const std::string& option);

/// The same for a grid or a board: neither side above 1000.
std::pair<int, int> parse_grid(const std::string& text, const std::string& option);

/// Parses "1,5,inf" as positive distances without duplicates. Throws Error naming the option.
std::vector<double> parse_distances(const std::string& text, const std::string& option);

/// Parses "10,7.5,0" as n numbers. Throws Error naming the option.
std::vector<double> parse_numbers(const std::string& text,
                                  std::size_t n,
                                  const std::string& option);

}  // namespace vernier::cli
