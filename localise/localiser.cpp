// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/localiser.h"

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/baseline_localiser.h"
#include "localise/pgh_localiser.h"

namespace vernier::localise {

using namespace internal;

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
  }
  return "";
}

std::vector<std::string> localiser_names() { return {"pgh", "pgh_baseline"}; }

std::unique_ptr<Localiser> make_localiser(std::string_view method,
                                          const TopologicalMap& map,
                                          const LocaliserOptions& options) {
  if (method == "pgh") return std::make_unique<PghLocaliser>(map, options);
  if (method == "pgh_baseline") return std::make_unique<BaselineLocaliser>(map);
  throw Error("localiser " + vernier::internal::in_quotes(method), "unknown method",
              "use pgh or pgh_baseline");
}

}  // namespace vernier::localise
