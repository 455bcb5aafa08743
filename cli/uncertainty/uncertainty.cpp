// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>

#include "calib/base/error_place.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "cli/program/limited_grid.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/uncertainty/uncertainty_report.h"
#include "cli/uncertainty/uncertainty_tables.h"
#include "cli/uncertainty/unphysical_draws.h"

namespace vernier::cli {
namespace {

constexpr int most_grid_points = 1'000'000;

struct UncertaintyArguments {
  std::string rig, output;
  std::string distances = "1,5,inf", grid = "60x45", covariance = "honest";
  double pair_sigma_px = -1;  // default: the calibration's
  double psi_c = 1;
  int samples = 2000;
  std::uint64_t seed = 1;
};

/// The estimate with the selected covariance.
RigEstimate with_choice(RigEstimate estimate,
                        const UncertaintyArguments& options,
                        const std::string& place) {
  if (options.covariance == "honest") return estimate;
  estimate.covariance = required_covariance(estimate, CovarianceChoice::mvb, place);
  return estimate;
}

UncertaintyRequest request_of(const UncertaintyArguments& options, const RigEstimate& estimate) {
  UncertaintyRequest request;
  request.distances_m = parse_distances(options.distances, "--distances-m");
  std::tie(request.columns, request.rows) =
      parse_image_grid(options.grid, "--grid", most_grid_points);
  request.pair_sigma_px = options.pair_sigma_px;
  if (options.pair_sigma_px < 0) {
    request.pair_sigma_px = estimate.calibration ? estimate.calibration->pixel_sigma_px : 0;
  }
  request.sampling = {options.psi_c, options.samples, options.seed};
  return request;
}

/// The sampled figures describe no rig where too many draws are none.
void check_draws(const RigEstimate& estimate,
                 const UncertaintyArguments& options,
                 Session& session) {
  if (options.samples <= 0 || !estimate.covariance || !(options.psi_c > 0)) return;
  const RigSampler sampler(estimate, options.rig);
  UnphysicalDraws unphysical;
  for (int i = 0; i < options.samples; ++i) {
    unphysical.add(sampler.sample(options.psi_c, options.seed, static_cast<std::uint32_t>(i)));
  }
  unphysical.report(options.samples, session);
  const auto doubt = curvature_warning(estimate.rig, *estimate.covariance);
  if (doubt) session.add_trust_warning(*doubt);
}

void run(const UncertaintyArguments& options, Session& session) {
  const std::filesystem::path file = find_rig(options.rig);
  const RigFile rig = read_rig(file);
  for (const std::string& warning : rig.warnings) session.warn(warning);
  const RigEstimate estimate = with_choice(rig.estimate, options, file.string());
  if (!options.output.empty())
    check_output_is_not_input({file}, std::filesystem::path(options.output) / "uncertainty.json");
  UncertaintyReport report = with_errors_of(file.string(), [&] {
    return uncertainty_report(estimate, request_of(options, estimate), file.string());
  });
  if (options.pair_sigma_px < 0 && !estimate.calibration) {
    report.notes.push_back(
        "the rig file contains no pixel noise: triangulation uncertainty excludes matching noise; "
        "give --pair-sigma-px");
  }
  check_draws(estimate, options, session);
  std::string written;
  Json json = Json::object();
  if (!options.output.empty()) {
    const auto names = write_uncertainty(report, options.output);
    written = fmt::format("{} files written to {}\n", names.size(), options.output);
    json["output"] = options.output;
    json["files"] = names;
  }
  Json all = session.json ? uncertainty_json(report, GridDetail::covariances) : Json::object();
  all.update(json);
  session.result(all, uncertainty_text(report) + written);
}

}  // namespace

void add_uncertainty(CLI::App& app, Session& session) {
  auto o = std::make_shared<UncertaintyArguments>();
  CLI::App* verb = add_verb(
      app, session, "uncertainty",
      "projection, triangulation, rectification and depth uncertainty, linearised and sampled",
      "vernier uncertainty rig.json --distances-m 1,5,inf --grid 60x45 -o uncertainty");
  verb->add_option("rig", o->rig, "rig file, or a shipped name (nominal)")->required();
  verb->add_option("--distances-m", o->distances,
                   "distances along the ray, metres; inf for infinity")
      ->capture_default_str();
  verb->add_option("--grid", o->grid, "grid over each image, columns x rows")
      ->capture_default_str();
  verb->add_option("--covariance", o->covariance,
                   "honest (used for sampling) or mvb (minimum variance bound, as in mrcal)")
      ->check(CLI::IsMember({"honest", "mvb"}))
      ->capture_default_str();
  verb->add_option("--pair-sigma-px", o->pair_sigma_px,
                   "noise of a matched pixel coordinate (default: the calibration's)")
      ->check(finite_and_not_negative);
  verb->add_option("--psi-c", o->psi_c,
                   "scale factor for all standard deviations of the calibration")
      ->check(finite_and_not_negative)
      ->capture_default_str();
  verb->add_option("--samples", o->samples, "number of sampled rigs")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  verb->add_option("--seed", o->seed, "random seed")->capture_default_str();
  verb->add_option("-o,--output", o->output, "output folder for tables (CSV), maps (SVG) and JSON");
  check_folder_written(*verb, "--output");
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
