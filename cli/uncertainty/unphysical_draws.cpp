// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/uncertainty/unphysical_draws.h"

#include <string>

#include "calib/rig.h"
#include "calib/uncertainty/physical_rig.h"
#include "cli/program/session.h"

namespace vernier::cli {

void UnphysicalDraws::add(const Rig& rig) {
  const std::string fault = unphysical(rig);
  if (fault.empty()) return;
  if (count++ == 0) first = fault;
}

void UnphysicalDraws::report(int draws, Session& session) const {
  if (count == 0) return;
  const double share = static_cast<double>(count) / draws;
  const std::string words =
      fmt::format("{} of {} samples ({:.2g} %) are rigs that no cameras can have (the first: {})",
                  count, draws, 100 * share, first);
  if (share <= most_unphysical) {
    session.warn(words);
    return;
  }
  session.add_trust_warning(fmt::format(
      "{}: more than {:.1g} %, so a Gaussian with this covariance does not describe the rig's "
      "errors; give a smaller --psi-c, or a rig that is better determined",
      words, 100 * most_unphysical));
}

}  // namespace vernier::cli
