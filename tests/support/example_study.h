// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "tests/support/small_office.h"

namespace vernier::test {

/// A study of the small office that takes a second, over a sweep of the calibration's error.
inline Study example_study(int trials, const std::string& sweep = "[0.1, 10]") {
  Study study;
  study.file = parse_study("[study]\ntrials = " + std::to_string(trials) +
                               "\nprotocol = \"near_path\"\n[map]\nspacing_m = 1\n"
                               "[sweep]\n\"sources.calibration\" = " +
                               sweep + "\n",
                           "s.toml");
  study.world = small_office();
  study.rig = nominal_rig();
  study.world_fingerprint = "office";
  study.rig_fingerprint = "nominal";
  return study;
}

}  // namespace vernier::test
