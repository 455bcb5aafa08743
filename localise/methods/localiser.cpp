// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/localiser.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/methods/baseline_localiser.h"
#include "localise/methods/corner_localiser.h"
#include "localise/methods/line_localiser.h"
#include "localise/methods/pgh_localiser.h"
#include "localise/methods/program_localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise {

using namespace internal;

namespace {

void check(const LocaliserOptions& options) {
  constexpr int most = 10'000;
  if (options.candidates < 1 || options.candidates > most || options.min_lines < 1) {
    throw Error("localiser options", "candidates or min_lines is out of range",
                "use 1 to 10000 candidates and at least 1 line");
  }
  if (options.min_corners < 4) {
    throw Error("localiser options", "min_corners is below 4", "use 8");
  }
  if (!(options.time_limit_s > 0 && options.time_limit_s <= 1e6)) {
    throw Error("localiser options", "time_limit_s is not above 0 and at most 1e6",
                "use 10 seconds");
  }
  if (!(options.max_error_rate > 0 && options.max_error_rate <= 1)) {
    throw Error("localiser options", "max_error_rate is not above 0 and at most 1",
                "use 1 for an answer to every query");
  }
  if (options.look_error_rate &&
      !(*options.look_error_rate > 0 && *options.look_error_rate <= options.max_error_rate)) {
    throw Error("localiser options", "look_error_rate is not above 0 and at most max_error_rate",
                "use a smaller one, or none");
  }
  if (!(options.off_map >= 0 && options.off_map < 1)) {
    throw Error("localiser options", "off_map is not from 0 to below 1",
                "use 0 for a robot that stays on the map");
  }
  if (!(options.repeats >= 0 && options.repeats < 1)) {
    throw Error("localiser options", "repeats is not from 0 to below 1",
                "use 0 for a building in which all places differ");
  }
}

void check(const TopologicalMap& map) {
  constexpr double most = 1e6;  // metres, radians
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const Pose2D& pose = map.nodes[i].pose;
    if (!(std::abs(pose.x_m) <= most && std::abs(pose.y_m) <= most &&
          std::abs(pose.heading_rad) <= most)) {
      throw Error("map node " + std::to_string(i), "its pose is not finite or beyond 1e6",
                  "leave the node out");
    }
  }
}

struct StageWord {
  std::string_view word;
  bool LocaliserStages::*is_on;
};
constexpr StageWord stage_words[] = {{"align", &LocaliserStages::align},
                                     {"refine", &LocaliserStages::refine},
                                     {"compare", &LocaliserStages::compare},
                                     {"deepen", &LocaliserStages::deepen}};

template <class Method>
LocaliserFactory factory() {
  return [](const TopologicalMap& map, const LocaliserOptions& options) {
    return std::make_unique<Method>(map, options);
  };
}

/// Methods by name, those that ship among them.
class Registry {
 public:
  static Registry& instance() {
    static Registry registry;
    return registry;
  }

  void add(const std::string& method, LocaliserFactory factory, ViewNeeds needs) {
    const std::lock_guard lock(mutex_);
    if (!factory && methods_.count(method) == 0) {
      throw Error("localiser " + vernier::internal::in_quotes(method), "has no factory",
                  "give a function that makes one");
    }
    if (method.empty() || !methods_.emplace(method, Method{std::move(factory), needs, {}}).second) {
      throw Error("localiser " + vernier::internal::in_quotes(method),
                  method.empty() ? "has no name" : "is already registered", "choose another name");
    }
  }

  std::vector<std::string> names() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    names.reserve(methods_.size());
    for (const auto& [name, unused] : methods_) names.push_back(name);
    return names;
  }

  struct Method {
    LocaliserFactory factory;
    ViewNeeds needs;
    std::vector<std::string_view> options;  ///< uses_option; empty: all
  };

  /// Without a factory for an unknown name.
  Method find(std::string_view method) const {
    const std::lock_guard lock(mutex_);
    const auto found = methods_.find(std::string(method));
    return found == methods_.end() ? Method{} : found->second;
  }

 private:
  Registry()
      : methods_{
            {"corners",
             {factory<CornerLocaliser>(),
              {.corners = true, .lines = false},
              {"candidates", "corners", "min_corners"}}},
            {"lines",
             {factory<LineLocaliser>(),
              {},
              {"candidates", "endpoint_sigma", "histograms", "look_error_rate", "looks",
               "max_error_rate", "off_map", "ranker", "repeats", "stages"}}},
            {"pgh", {factory<PghLocaliser>(), {}, {"candidates", "endpoint_sigma", "histograms"}}},
            {"pgh_baseline", {factory<BaselineLocaliser>(), {}, {"histograms"}}},
            {"pgh_baseline_vectorised",
             {factory<VectorisedBaselineLocaliser>(), {}, {"histograms"}}},
            {"program",
             {factory<ProgramLocaliser>(),
              {},
              {"command", "corners", "endpoint_sigma", "looks", "time_limit_s"}}}} {}

  mutable std::mutex mutex_;
  std::map<std::string, Method> methods_;
};

}  // namespace

std::string_view name(LocalisationStatus status) {
  switch (status) {
    case LocalisationStatus::answered:
      return "answered";
    case LocalisationStatus::too_few_lines:
      return "too_few_lines";
    case LocalisationStatus::tie:
      return "tie";
    case LocalisationStatus::no_match:
      return "no_match";
    case LocalisationStatus::unsure:
      return "unsure";
    case LocalisationStatus::failed:
      return "failed";
    case LocalisationStatus::too_few_corners:
      return "too_few_corners";
  }
  return "";
}

std::string name(const LocaliserStages& stages) {
  std::string words;
  for (const auto& [word, is_on] : stage_words) {
    if (!(stages.*is_on)) continue;
    if (!words.empty()) words += '+';
    words += word;
  }
  return words.empty() ? "none" : words;
}

LocaliserStages localiser_stages(std::string_view words) {
  LocaliserStages stages{false, false, false, false};
  if (words == "none") return stages;
  for (std::size_t from = 0; from <= words.size();) {
    const std::size_t end = std::min(words.find('+', from), words.size());
    const std::string_view word = words.substr(from, end - from);
    const auto* found = std::find_if(std::begin(stage_words), std::end(stage_words),
                                     [&](const StageWord& s) { return s.word == word; });
    if (found == std::end(stage_words) || stages.*found->is_on) {
      throw Error("localiser stages " + vernier::internal::in_quotes(std::string(words)),
                  vernier::internal::in_quotes(std::string(word)) +
                      (found == std::end(stage_words) ? " is not a stage" : " is there twice"),
                  "use align+refine+compare+deepen, a part of it, or none");
    }
    stages.*found->is_on = true;
    from = end + 1;
  }
  return stages;
}

LocalisationAnswer Localiser::localise_looks(std::span<const Look> looks) const {
  if (looks.empty()) throw Error("looks", "there are none", "give at least one");
  LocalisationAnswer answer = localise(looks[0].view);
  answer.pose.heading_rad -= looks[0].turn_rad;
  return answer;
}

std::vector<std::string> localiser_names() { return Registry::instance().names(); }

void register_localiser(const std::string& method, LocaliserFactory factory, ViewNeeds needs) {
  Registry::instance().add(method, std::move(factory), needs);
}

bool uses_image_histograms(std::string_view method) { return method.starts_with("pgh_baseline"); }

bool uses_option(std::string_view method,
                 std::string_view option,
                 const LocaliserOptions& options) {
  const std::vector<std::string_view> used = Registry::instance().find(method).options;
  if (used.empty()) return true;
  if (method == "lines") {
    if (option == "histograms" && options.ranker == "view") return false;
    const bool is_of_posterior =
        option == "off_map" || option == "repeats" || option == "look_error_rate";
    if (is_of_posterior && !options.stages.compare) return false;
  }
  return std::find(used.begin(), used.end(), option) != used.end();
}

int most_candidates(std::string_view method) {
  return method == "pgh"       ? PghLocaliser::most_candidates
         : method == "corners" ? CornerLocaliser::most_candidates
                               : std::numeric_limits<int>::max();
}

bool can_be_sure(std::string_view method, const LocaliserOptions& options) {
  return method != "lines" || options.stages.compare || options.max_error_rate >= 1;
}

bool uses_lines(std::string_view method) { return Registry::instance().find(method).needs.lines; }

bool needs_corners(std::string_view method, const LocaliserOptions& options) {
  return options.corners || Registry::instance().find(method).needs.corners;
}

std::unique_ptr<Localiser> make_localiser(std::string_view method,
                                          const TopologicalMap& map,
                                          const LocaliserOptions& options) {
  const LocaliserFactory factory = Registry::instance().find(method).factory;
  if (!factory) {
    throw Error("localiser " + vernier::internal::in_quotes(method), "unknown method",
                "use " + vernier::internal::alternatives(localiser_names()));
  }
  check(options);
  check(map);
  std::unique_ptr<Localiser> localiser = factory(map, options);
  if (!localiser) {
    throw Error("localiser " + vernier::internal::in_quotes(method), "its factory made none",
                "return a localiser or throw Error");
  }
  return localiser;
}

}  // namespace vernier::localise
