// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/sampler.h"
#include "cli/program/option_checks.h"

#include "calib/base/file_in_progress.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/rig_file.h"
#include "calib/uncertainty/physical_rig.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_table.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/uncertainty/unphysical_draws.h"

namespace vernier::cli {
namespace {

constexpr int long_job = 100'000;  ///< samples; progress is said of more

struct SampleArguments {
  std::string rig, output;
  double psi_c = 1;
  int count = 1000;
  std::uint64_t seed = 1;
};

/// Writes the samples as they are drawn, so that any number fits in memory.
UnphysicalDraws write_samples(const SampleArguments& options,
                              const RigFile& rig,
                              const RigSampler& sampler,
                              Session& session) {
  UnphysicalDraws unphysical_draws;
  FileInProgress csv(options.output);
  std::string row;
  for (const std::string& name : rig.listed) row += (row.empty() ? "" : ",") + name;
  csv.append(row + '\n');
  Progress progress(session, "sample");
  for (int i = 0; i < options.count; ++i) {
    const Rig drawn = sampler.sample(options.psi_c, options.seed, static_cast<std::uint32_t>(i));
    unphysical_draws.add(drawn);
    const Eigen::VectorXd a = parameters(drawn)(rig.listed_places);
    row.clear();
    for (Eigen::Index k = 0; k < a.size(); ++k) row += fmt::format("{}{}", k ? "," : "", a[k]);
    csv.append(row += '\n');
    if (i >= long_job && i % long_job == 0) progress.update(i, options.count);
  }
  csv.commit();
  return unphysical_draws;
}

void run(const SampleArguments& options, Session& session) {
  const std::filesystem::path file = find_rig(options.rig);
  const RigFile rig = read_rig(file);
  for (const std::string& warning : rig.warnings) session.warn(warning);
  const RigSampler sampler(rig.estimate, file.string());
  check_output_is_not_input({file}, options.output);

  const UnphysicalDraws unphysical_draws = write_samples(options, rig, sampler, session);
  unphysical_draws.report(options.count, session);
  const auto doubt = curvature_warning(rig.estimate.rig, *rig.estimate.covariance);
  if (doubt) session.add_trust_warning(*doubt);

  Json directions = Json::array();
  for (const CovarianceDirection& d : sampler.decomposition().directions()) {
    directions.push_back({{"share", d.variance_share}, {"words", d.description}});
  }
  session.result({{"samples", options.count},
                  {"unphysical", unphysical_draws.count},
                  {"psi_c", options.psi_c},
                  {"seed", options.seed},
                  {"covariance_kind", name(rig.estimate.covariance->kind)},
                  {"raw_condition", sampler.decomposition().raw_condition()},
                  {"scaled_condition", sampler.decomposition().scaled_condition()},
                  {"directions", directions},
                  {"doubts", session.trust_warnings()},
                  {"output", options.output}},
                 fmt::format("{} rigs at psi_c = {} written to {}\nprincipal directions of the "
                             "scaled covariance ({}):\n",
                             options.count, options.psi_c, options.output,
                             name(rig.estimate.covariance->kind)) +
                     direction_lines(sampler.decomposition()));
}

}  // namespace

void add_sample(CLI::App& app, Session& session) {
  auto o = std::make_shared<SampleArguments>();
  CLI::App* verb = add_verb(app, session, "sample",
                            "sample rigs with correlated errors from a rig's covariance (SVD)",
                            "vernier sample rig.json --psi-c 1 -n 1000 --seed 1 -o samples.csv");
  verb->add_option("rig", o->rig, "rig file, or a shipped name (nominal)")->required();
  verb->add_option("--psi-c", o->psi_c, "scale factor for all standard deviations")
      ->check(finite_and_not_negative)
      ->capture_default_str();
  verb->add_option("-n,--count", o->count, "number of samples")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  verb->add_option("--seed", o->seed, "random seed")->capture_default_str();
  verb->add_option("-o,--output", o->output, "CSV file with the parameter names as header")
      ->required();
  check_files_written(*verb, {"--output"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
