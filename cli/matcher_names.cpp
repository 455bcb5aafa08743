// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/matcher_names.h"

#include <sstream>

#include "calib/error.h"
#include "stereo/dense_matchers.h"
#include "stereo/edge_matcher.h"
#include "stereo/external_matcher.h"
#include "stereo/stretch_correlation.h"

namespace vernier::cli {
namespace {

Matcher matcher_named(const std::string& name) {
  if (name == "edge") return edge_matcher();
  if (name == "stretch") return stretch_matcher();
  if (name == "bm") return bm();
  if (name == "sgbm") return sgbm();
  throw Error(
      "--matcher", "\"" + name + "\" is no matcher",
      "name edge, stretch, bm or sgbm, with commas between, or give a program with --command");
}

}  // namespace

std::vector<Matcher> matchers_named(const std::string& names,
                                    const std::vector<std::string>& commands) {
  std::vector<Matcher> matchers;
  std::istringstream stream(names);
  for (std::string name; std::getline(stream, name, ',');) {
    if (!name.empty()) matchers.push_back(matcher_named(name));
  }
  for (const std::string& command : commands) matchers.push_back(external_matcher(command));
  for (std::size_t i = 0; i < matchers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (matchers[i].name != matchers[j].name) continue;
      throw Error("--matcher", "\"" + matchers[i].name + "\" is named twice", "name each once");
    }
  }
  if (matchers.empty()) throw Error("--matcher", "it names none", "name edge, stretch, bm or sgbm");
  return matchers;
}

Matcher one_matcher(const std::string& name, const std::string& command) {
  const std::vector<Matcher> matchers =
      command.empty() ? matchers_named(name, {}) : matchers_named("", {command});
  if (matchers.size() == 1) return matchers.front();
  throw Error("--matcher", "\"" + name + "\" names more than one", "name one");
}

}  // namespace vernier::cli
