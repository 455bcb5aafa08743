// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/session.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "cli/program/streams.h"

namespace vernier::cli {

namespace {

// Warnings quote the names of files, and may give several reasons.
constexpr std::size_t most_line_bytes = 2000;

}  // namespace

void Session::info(const std::string& line) const {
  if (!quiet) say(printable(line, most_line_bytes) + "\n");
}

void Session::warn(const std::string& line) {
  info("warning: " + line);
  warnings_.push_back(line);
}

namespace {

/// Adds the warnings that are not there yet.
void add_warnings(const std::vector<std::string>& warnings, Json& object) {
  if (warnings.empty()) return;
  Json& all = object["warnings"];
  for (const std::string& warning : warnings) {
    if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
  }
}

/// Text whose control characters do nothing to a terminal: names come from files.
std::string printable_lines(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool acts = (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
    result += acts ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return result;
}

}  // namespace

void Session::add_trust_warning(const std::string& reason) { trust_warnings_.push_back(reason); }

void Session::tell_trust_warnings() {
  for (; told_ < trust_warnings_.size(); ++told_) {
    say(printable("vernier: not trustworthy: " + trust_warnings_[told_], most_line_bytes) + "\n");
  }
}

void Session::result(const Json& object, const std::string& text) {
  tell_trust_warnings();
  if (json) {
    Json out = object;
    add_warnings(warnings_, out);
    if (!trust_warnings_.empty()) out["doubts"] = trust_warnings_;
    // a file name may contain invalid UTF-8
    print_result(out.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
  } else {
    print_result(printable_lines(text));
  }
}

Progress::Progress(const Session& session, std::string what)
    : what_(std::move(what)),
      quiet_(session.quiet),
      terminal_(::isatty(STDERR_FILENO)),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  if (drawn_) say("\n");
}

void Progress::update(int done, int total) {
  if (quiet_ || total == 0) return;
  const double elapsed =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (terminal_) {
    draw(done, total, elapsed);
    return;
  }
  const int tenths = static_cast<int>(10LL * done / total);
  if (tenths == tenths_reported_) return;
  tenths_reported_ = tenths;
  say(fmt::format("{}: {} of {}, {:.0f} s\n", what_, done, total, elapsed));
}

void Progress::draw(int done, int total, double elapsed_s) {
  constexpr int width = 30;
  const int filled = static_cast<int>(1LL * width * done / total);
  std::string left;
  if (done > 0 && done < total) {
    left = fmt::format("{:.0f} s left", elapsed_s * (total - done) / done);
  }
  say(fmt::format("\r{} [{}{}] {}/{} {:<14}", what_, std::string(filled, '#'),
                  std::string(width - filled, ' '), done, total, left));
  drawn_ = true;
}

CLI::App* add_verb(CLI::App& app,
                   Session& session,
                   const std::string& name,
                   const std::string& about,
                   const std::string& example) {
  CLI::App* verb = app.add_subcommand(name, about);
  verb->add_flag("-q,--quiet", session.quiet, "no progress or notes on standard error");
  verb->add_flag("--json", session.json, "print one JSON object on standard output");
  verb->footer("Example:\n  " + example);
  return verb;
}

std::string command_line(int argc, const char* const* argv) {
  std::string line = "vernier";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
      return std::isalnum(c) || c >= 0x80 || std::strchr("_-./,:=@%+", c);
    });
    line += plain ? " " + word : " '";
    if (plain) continue;
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += "'";
  }
  return line;
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

std::pair<int, int> parse_size(const std::string& text, const std::string& option) {
  int a = 0, b = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, a);
  bool good = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  if (good) {
    const auto second = std::from_chars(first.ptr + 1, end, b);
    good = second.ec == std::errc() && second.ptr == end && a > 0 && b > 0;
  }
  if (!good) {
    throw Error(option, in_quotes(text) + " is not two whole numbers",
                option == "--size" ? "use the form 640x480" : "use the form 9x6");
  }
  return {a, b};
}

std::vector<std::pair<int, int>> parse_sizes(const std::string& text, const std::string& option) {
  std::vector<std::pair<int, int>> sizes;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    sizes.push_back(parse_size(text.substr(at, end - at), option));
    at = end + 1;
  }
  return sizes;
}

std::pair<int, int> parse_grid(const std::string& text, const std::string& option) {
  constexpr int most = 1000;
  const std::pair<int, int> size = parse_size(text, option);
  if (size.first > most || size.second > most) {
    throw Error(option, in_quotes(text) + " has a side above 1000", "give a smaller grid");
  }
  return size;
}

std::vector<double> parse_distances(const std::string& text, const std::string& option) {
  std::vector<double> distances;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const char *word = text.data() + at, *end = text.data() + comma;
    double value = 0;
    const auto parsed = std::from_chars(word, end, value);  // accepts inf
    if (parsed.ec != std::errc() || parsed.ptr != end || !(value > 0)) {
      throw Error(option, in_quotes(text) + " is not a list of positive distances",
                  "give metres separated by commas, for example 1,5,inf");
    }
    constexpr double nearest_m = 1e-3, furthest_m = 1e9;
    if (value < nearest_m || (std::isfinite(value) && value > furthest_m)) {
      throw Error(option,
                  fmt::format("{:g} m is not from {} to {:g} m", value, nearest_m, furthest_m),
                  "give metres, or inf");
    }
    if (std::find(distances.begin(), distances.end(), value) == distances.end()) {
      distances.push_back(value);
    }
    constexpr std::size_t most_distances = 100;
    if (distances.size() > most_distances) {
      throw Error(option, fmt::format("lists more than {} distances", most_distances),
                  "give fewer, or several calls");
    }
    at = comma + 1;
  }
  return distances;
}

std::vector<double> parse_numbers(const std::string& text,
                                  std::size_t n,
                                  const std::string& option) {
  std::vector<double> values;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at <= end) {
    double value = 0;
    const auto parsed = std::from_chars(at, end, value);
    if (parsed.ec != std::errc() || !std::isfinite(value)) break;
    values.push_back(value);
    at = parsed.ptr;
    if (at == end) break;
    if (*at != ',') {
      values.clear();
      break;
    }
    ++at;
  }
  const bool open = !text.empty() && text.back() == ',';
  if (open || at != end || values.size() != n) {
    throw Error(option,
                in_quotes(text) + " is not " +
                    (n == 1 ? std::string("a number") : std::to_string(n) + " numbers"),
                "separate the numbers by commas, without blanks");
  }
  return values;
}

}  // namespace vernier::cli
