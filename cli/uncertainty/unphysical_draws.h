// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// The draws that no cameras can have.
struct UnphysicalDraws {
  int count = 0;
  std::string first;  ///< what is wrong with the first of them

  void add(const Rig& rig);
  /// Says the share; a doubt above the share that Gaussian errors may have.
  void report(int draws, Session& session) const;
};

}  // namespace vernier::cli
