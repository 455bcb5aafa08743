// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/sources.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim {

using namespace vernier::internal;
using namespace internal;

namespace {

/// Sources of one's own by name.
class SourceRegistry {
 public:
  static SourceRegistry& instance() {
    static SourceRegistry registry;
    return registry;
  }

  void add(const std::string& name, SourceFactory factory) {
    const std::string place = "source " + in_quotes(name);
    const auto is_plain = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    };
    if (name.empty() || !std::all_of(name.begin(), name.end(), is_plain)) {
      throw Error(place, "is no name of a source", "use small letters, digits and underscores");
    }
    if (!factory) throw Error(place, "has no factory", "give a function that makes one");
    const std::lock_guard lock(mutex_);
    if (is_taken(name) || !factories_.emplace(name, std::move(factory)).second) {
      throw Error(place, "is taken", "choose another name");
    }
  }

  std::vector<std::string> names() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const auto& [name, unused] : factories_) names.push_back(name);
    return names;
  }

  /// Null for an unknown name.
  SourceFactory find(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = factories_.find(name);
    return found == factories_.end() ? nullptr : found->second;
  }

 private:
  /// Keys of [sources] in a study.
  static bool is_taken(const std::string& name) {
    return source_parameter(name) || name == "file" || name == "lateral_shift_mode" ||
           name == "own" || name == "command" || name == "time_limit_s" || name == "none";
  }

  mutable std::mutex mutex_;
  std::map<std::string, SourceFactory> factories_;
};

}  // namespace

void register_source(const std::string& name, SourceFactory factory) {
  SourceRegistry::instance().add(name, std::move(factory));
}

std::vector<std::string> registered_sources() { return SourceRegistry::instance().names(); }

namespace internal {

SourcePointer make_own(const OwnSource& own) {
  const std::string place = "source " + in_quotes(own.name);
  const SourceFactory factory = SourceRegistry::instance().find(own.name);
  if (!factory) {
    const std::vector<std::string> known = registered_sources();
    throw Error(place, "is not registered",
                known.empty() ? "register it (docs/own-source.md)" : "use " + alternatives(known));
  }
  SourcePointer source = factory(own.options);
  if (!source) throw Error(place, "its factory made none", "return a source or throw Error");
  return source;
}

}  // namespace internal
}  // namespace vernier::sim
