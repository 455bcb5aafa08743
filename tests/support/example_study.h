// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "tests/support/small_office.h"

namespace vernier::test {

/// A study in the small office with the nominal rig as the true one.
inline Study office_study(const std::string& text) {
  Study study;
  study.file = parse_study(text, "s.toml");
  study.world = small_office();
  study.rig = nominal_rig();
  study.world_fingerprint = "office";
  study.rig_fingerprint = "nominal";
  return study;
}

/// One that takes a second, over a sweep of the calibration's error.
inline Study example_study(int trials, const std::string& sweep = "[0.1, 10]") {
  return office_study("[study]\ntrials = " + std::to_string(trials) +
                      "\nprotocol = \"near_path\"\n[map]\nspacing_m = 1\n"
                      "[sweep]\n\"sources.calibration\" = " +
                      sweep + "\n");
}

}  // namespace vernier::test
