// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
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

/// Whether all that a source of one's own may have changed is a number.
bool all_finite(const SensedView& view) {
  const auto finite = [](const std::array<Eigen::Vector2d, 2>& pixels) {
    return pixels[0].allFinite() && pixels[1].allFinite();
  };
  return std::all_of(view.edges.begin(), view.edges.end(),
                     [&](const SensedEdge& edge) {
                       return finite(edge.offset_px[0]) && finite(edge.offset_px[1]) &&
                              edge.truth.a_m.allFinite() && edge.truth.b_m.allFinite();
                     }) &&
         std::all_of(view.corners.begin(), view.corners.end(),
                     [&](const SensedCorner& corner) { return finite(corner.pixel_px); });
}

/// A source of one's own whose faults spoil a view and nothing else: what it throws that is no
/// Error, and numbers that are none, are told as the view's failure.
class GuardedSource : public UncertaintySource {
 public:
  GuardedSource(SourcePointer own, std::string place)
      : own_(std::move(own)), place_(std::move(place)) {}

  std::string_view name() const override { return own_->name(); }

  void apply(const SensingContext& context, SensedView& view) const override {
    try {
      own_->apply(context, view);
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      view.failure = place_ + " threw: " + printable(error.what());
    } catch (...) {
      view.failure = place_ + " threw what is no std::exception";
    }
    if (view.failure.empty() && !all_finite(view)) {
      view.failure = place_ + " left a number that is not finite in an edge or a corner";
    }
  }

 private:
  SourcePointer own_;
  std::string place_;
};

/// What the factory makes. Throws Error, also for what it throws itself.
SourcePointer made_by(const SourceFactory& factory,
                      const SourceOptions& options,
                      const std::string& place) {
  SourcePointer source;
  try {
    source = factory(options);
  } catch (const Error&) {
    throw;
  } catch (const std::out_of_range&) {  // of options.at()
    throw Error(place, "an option that it needs is missing", "give all its options");
  } catch (const std::exception& error) {
    throw Error(place, "its factory threw: " + printable(error.what()),
                "check its options, or let it throw Error");
  }
  if (!source) throw Error(place, "its factory made none", "return a source or throw Error");
  return source;
}

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
  return std::make_unique<GuardedSource>(made_by(factory, own.options, place), place);
}

}  // namespace internal
}  // namespace vernier::sim
