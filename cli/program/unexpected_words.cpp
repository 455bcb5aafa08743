// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/unexpected_words.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "calib/base/nearest_word.h"
#include "calib/base/shown_text.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {
namespace {

/// The innermost verb that the command line named, or the program.
const CLI::App& named_verb(const CLI::App& app) {
  const std::vector<CLI::App*> named = app.get_subcommands();
  return named.empty() ? app : named_verb(*named.back());
}

/// What may stand in the place of a word: the verb's options, without dashes, or verbs.
std::vector<std::string> expected_words(const CLI::App& verb, bool options) {
  std::vector<std::string> words;
  if (options) {
    for (const CLI::Option* option : verb.get_options()) {
      for (const std::string& name : option->get_lnames()) words.push_back(name);
    }
  } else {
    for (const CLI::App* other : verb.get_subcommands({})) words.push_back(other->get_name());
  }
  return words;
}

/// The word that was probably meant: one with one slip, the only one that begins so, or one that is
/// near.
std::optional<std::string> meant_by(std::string_view word,
                                    const std::vector<std::string>& expected) {
  if (word.empty()) return std::nullopt;
  const std::vector<std::string_view> known(expected.begin(), expected.end());
  if (auto slip = misspelt_word(word, known)) return slip;
  const auto begins = [&](const std::string& other) { return other.starts_with(word); };
  const auto first = std::ranges::find_if(expected, begins);
  if (std::ranges::count_if(expected, begins) == 1) return *first;
  constexpr std::size_t least = 3;  // of fewer letters half are too few
  if (word.size() < least) return std::nullopt;
  return near_word(word, known);
}

/// An unquoted pattern is expanded by the shell.
bool are_files(const std::vector<std::string>& words) {
  return words.size() > 1 && std::ranges::all_of(words, [](const std::string& word) {
           return !word.starts_with('-') && std::filesystem::path(word).has_extension();
         });
}

/// " (see vernier VERB --help)" for the verb that the command line named, if it named one.
std::string where_help_is(const CLI::App& app) {
  const CLI::App& verb = named_verb(app);
  std::string names;
  for (const CLI::App* part = &verb; part != &app; part = part->get_parent()) {
    names = part->get_name() + " " + names;
  }
  return fmt::format(" (see vernier {}--help)", names);
}

std::string unexpected_words(const CLI::App& app, const std::vector<std::string>& words) {
  std::string text = "unexpected argument " + in_quotes(words.front());
  if (words.size() > 1) text += fmt::format(" and {} more", words.size() - 1);
  const bool option = words.front().starts_with('-');
  const std::size_t dashes = option ? words.front().find_first_not_of('-') : 0;
  std::string_view word = words.front();
  word = word.substr(std::min(dashes, word.size()));
  word = word.substr(0, word.find('='));
  if (are_files(words)) {
    text += "; quote the pattern, for example 'left*.png'";
  } else if (const auto meant = meant_by(word, expected_words(named_verb(app), option))) {
    text += std::string("; did you mean '") + (option ? "--" : "") + *meant + "'?";
  }
  return text;
}

}  // namespace

std::string usage_fault(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> left_over = app.remaining(true);
  const bool is_cause = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                        dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const std::string fault =
      is_cause && !left_over.empty() ? unexpected_words(app, left_over) : error.what();
  return fault + where_help_is(app);
}

}  // namespace vernier::cli
