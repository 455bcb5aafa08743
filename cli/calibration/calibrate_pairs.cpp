// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/calibrate_pairs.h"

#include <filesystem>

#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/formats/pairs_file.h"
#include "calib/joint_calibration.h"
#include "calib/rig_file.h"
#include "cli/calibration/observability_report.h"
#include "cli/calibration/solver_input.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_table.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"

namespace vernier::cli {

void calibrate_pairs(const std::string& pairs_file,
                     const SolverInput& solver,
                     const std::string& output,
                     bool keep_evidence,
                     Session& session) {
  if (solver.prior.empty()) {
    throw Error(
        "--pairs", "matched pairs alone do not determine a rig, in particular not its scale",
        "give --prior with a rig file, for example an earlier calibration or datasheet values");
  }
  const std::filesystem::path prior_file = find_rig(solver.prior);
  check_output_is_not_input({pairs_file, prior_file}, output);
  const RigFile prior = read_rig(prior_file);
  for (const std::string& warning : prior.warnings) session.warn(warning);
  SolverInput rest = solver;
  rest.prior.clear();  // already read above
  const CalibrationOptions how = calibration_options(rest, session);
  JointOptions options;
  options.held = how.held;
  options.reject_outliers = how.reject_outliers;
  options.place = pairs_file;
  JointCalibration joint =
      calibrate_from_pairs(read_pairs(pairs_file), usable_prior(prior, solver.prior), options);
  const ObservabilityReport seen = report_observability(joint, prior.estimate.covariance->matrix);
  if (!seen.warning.empty()) joint.estimate.calibration->warnings.push_back(seen.warning);
  Json json = rig_json(joint.estimate);
  json["observability"] = seen.json;
  json["pair_sigma_scale"] = joint.pair_sigma_scale;
  json["output"] = output;
  const std::string text =
      rig_table(joint.estimate) + seen.text + fmt::format("written to {}\n", output);
  write_rig(joint.estimate, output, keep_evidence ? KeepEvidence::yes : KeepEvidence::no);
  for (const std::string& warning : joint.estimate.calibration->warnings) session.warn(warning);
  for (const std::string& warning : joint.estimate.calibration->trust_warnings)
    session.add_trust_warning(warning);
  session.result(json, text);
}

}  // namespace vernier::cli
