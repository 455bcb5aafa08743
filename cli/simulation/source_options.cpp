// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/source_options.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "cli/program/session.h"
#include "sim/sources.h"
#include "sim/study/settings_reader.h"

namespace vernier::cli {
namespace {

const SourceParameter& source_named(const std::string& word) {
  const std::size_t equals = word.find('=');
  const SourceParameter* found =
      equals == std::string::npos ? nullptr : source_parameter(word.substr(0, equals));
  if (found) return *found;
  std::string names = "none";
  for (const SourceParameter& parameter : source_parameters()) {
    names += ", " + std::string(parameter.name) + "=…";
  }
  throw Error("--source " + word, "unknown error source",
              "supported: " + names + ", command=…, time_limit_s=…");
}

/// Refuses settings without effect: the magnitude of a source that is off.
void check_effect(const SourceSettings& settings, const std::set<std::string_view>& given) {
  for (const SourceParameter& parameter : source_parameters()) {
    const std::string of(parameter.only_with);
    if (of.empty() || given.count(parameter.name) == 0) continue;
    if (settings.*source_parameter(of)->value > 0) continue;
    throw Error("--source " + std::string(parameter.name), "has no effect while " + of + " is 0",
                "also give --source " + of + "=…, or leave it out");
  }
}

/// Those of --source.
SourceSettings with_words(const std::vector<std::string>& words, SourceSettings settings) {
  std::set<std::string_view> given;
  for (const std::string& word : words) {
    if (word == "none") {
      if (&word != &words.front()) {
        throw Error("--source none", "would override the sources given before it", "give it first");
      }
      settings = no_sources();
      continue;
    }
    constexpr std::string_view program = "command=";
    if (word.starts_with(program)) {
      settings.command = word.substr(program.size());
      if (settings.command.empty()) {
        throw Error("--source command=", "names no program", "name one, or leave it out");
      }
      continue;
    }
    constexpr std::string_view limit = "time_limit_s=";
    if (word.starts_with(limit)) {
      settings.time_limit_s = parse_numbers(word.substr(limit.size()), 1, "--source " + word)[0];
      continue;
    }
    const SourceParameter& chosen = source_named(word);
    if (!given.insert(chosen.name).second) {
      throw Error("--source " + word, "this source is given twice", "give one value");
    }
    settings.*chosen.value =
        parse_numbers(word.substr(word.find('=') + 1), 1, "--source " + word)[0];
  }
  check(settings, "--source");
  check_effect(settings, given);
  return settings;
}

}  // namespace

void add_source_options(CLI::App& verb, SourceOptions& options) {
  verb.add_option("--sources", options.file,
                  "file with a table [sources], as characterise writes it; --source comes after");
  verb.add_option("--source", options.words,
                  "setting of an error source, such as edge_loss=0.2, or none (repeatable)");
}

SourceSettings sources_of(const SourceOptions& options, SourceSettings settings) {
  if (!options.file.empty()) {
    if (!options.words.empty() && options.words.front() == "none") {
      throw Error("--source none", "would override --sources", "leave one out");
    }
    read_sources_file(options.file, settings);
  }
  return with_words(options.words, std::move(settings));
}

}  // namespace vernier::cli
