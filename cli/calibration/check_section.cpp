// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_section.h"

namespace vernier::cli {

void add_gates(const std::string& title,
               const std::string& other,
               const std::vector<ToleranceCheck>& gates,
               CheckSection& part) {
  part.text +=
      fmt::format("{}:\n  {:<38} {:>10} {:>8}\n", title, "largest difference", "found", "limit");
  for (const ToleranceCheck& gate : gates) {
    part.json[gate.key] = gate.value;
    part.text += fmt::format("  {:<38} {:>10.1e} {:>8.0e}  {}  ({})\n", gate.what, gate.value,
                             gate.limit, gate.holds() ? "ok" : "FAIL", gate.where);
    if (gate.holds()) continue;
    part.failures.push_back(fmt::format("{} differ from {} by {:.1e} ({}; limit {:.0e})", gate.what,
                                        other, gate.value, gate.where, gate.limit));
  }
}

}  // namespace vernier::cli
