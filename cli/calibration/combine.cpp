// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/combine.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <utility>

#include "calib/base/output_files.h"
#include "calib/calibration/information_filter.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/formats/pairs_file.h"
#include "calib/joint_calibration.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "calib/validation/rig_drift.h"
#include "cli/calibration/observability_report.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_table.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"

namespace vernier::cli {
namespace {

struct CombineArguments {
  std::vector<std::string> inputs;
  std::string prior, mode = "batch", output, drift;
  bool keep_disagreeing = false, monitor = false, no_evidence = false, keep_outliers = false;
};

bool is_pairs_file(const std::string& name) {
  return std::filesystem::path(name).extension() == ".csv";
}

std::vector<CombineInput> load(const CombineArguments& options, Session& session) {
  std::vector<std::string> names = options.inputs;
  if (!options.prior.empty()) names.insert(names.begin(), options.prior);
  std::vector<CombineInput> inputs;
  for (const std::string& name : names) {
    CombineInput& input = inputs.emplace_back();
    input.name = name;
    if (is_pairs_file(name)) {
      input.pairs = read_pairs(name);
      continue;
    }
    RigFile file = read_rig(find_rig(name));
    for (const std::string& warning : file.warnings) {  // stored warnings come with the result
      if (!warning.starts_with(stored_warning_prefix(find_rig(name).string())))
        session.warn(warning);
    }
    input.estimate = std::move(file.estimate);
    const RigEstimate& estimate = *input.estimate;
    if (estimate.calibration && estimate.calibration->effects && estimate.evidence) {
      session.warn(name +
                   ": was calibrated with the board's shape or motion; its corners are "
                   "combined without");
    }
  }
  return inputs;
}

/// Which image pairs of an input have other numbers in what is said of the combination.
std::string renumbered_lines(const CombinedInput& input) {
  std::string text;
  const auto& numbers = input.image_pairs;
  for (std::size_t first = 0, end = 0; first < numbers.size(); first = end) {
    const auto [own, here] = numbers[first];
    end = first + 1;
    while (end < numbers.size() && numbers[end].first == numbers[end - 1].first + 1 &&
           numbers[end].second == numbers[end - 1].second + 1)
      ++end;
    if (own == here) continue;
    const auto [last_own, last_here] = numbers[end - 1];
    text += first + 1 == end
                ? fmt::format("image pair {} of {} is numbered {} below\n", own, input.name, here)
                : fmt::format("image pairs {} to {} of {} are numbered {} to {} below\n", own,
                              last_own, input.name, here, last_here);
  }
  return text;
}

std::string input_table(const Combination& combination) {
  std::size_t width = 5;
  bool by_f = false;
  for (const CombinedInput& input : combination.inputs) {
    width = std::max(width, input.name.size());
    by_f |= input.agreement.clusters > 0;
  }
  std::string text =
      fmt::format("{:<{}} {:>15} {:>10} {:>5} {:>8} {:>10}  {}\n", "input", width, "kind", "chi²",
                  "dof", "clusters", "p", "largest inconsistency with previous inputs");
  for (const CombinedInput& input : combination.inputs) {
    const PriorConsistency& a = input.agreement;
    text += fmt::format("{:<{}} {:>15} ", input.name, width, input.kind);
    const std::string excluded = input.used ? "" : "EXCLUDED: ";
    if (&input == &combination.inputs.front()) {
      text += fmt::format("{:>10} {:>5} {:>8} {:>10}  first input\n", "", "", "", "");
    } else if (a.dof == 0) {
      text +=
          fmt::format("{:>10} {:>5} {:>8} {:>10}  {}{}\n", "", "", "", "", excluded, a.description);
    } else {
      text += fmt::format("{:>10.1f} {:>5} {:>8} {:>10.2g}  {}{:.1f} sigma along {}\n", a.chi2,
                          a.dof, a.clusters > 0 ? fmt::format("{}", a.clusters) : "-", a.p_value,
                          excluded, a.in_sigma, a.description);
    }
  }
  if (by_f) {
    text +=
        "(clusters: image pairs, or parts of them, used to estimate the covariance of the pairs; "
        "chi² is inflated for few clusters, so p is from an F distribution with 4 (clusters - 1) "
        "denominator degrees of freedom)\n";
  }
  for (const CombinedInput& input : combination.inputs) text += renumbered_lines(input);
  return text;
}

Json inputs_json(const Combination& combination) {
  Json json = Json::array();
  for (const CombinedInput& input : combination.inputs) {
    json.push_back({{"name", input.name},
                    {"kind", input.kind},
                    {"used", input.used},
                    {"chi2", input.agreement.chi2},
                    {"dof", input.agreement.dof},
                    {"clusters", input.agreement.clusters},
                    {"p_value", input.agreement.p_value},
                    {"in_sigma", input.agreement.in_sigma},
                    {"words", input.agreement.description},
                    {"image_pairs", input.image_pairs}});
  }
  return json;
}

/// The covariance of the combined rig without any pairs.
Eigen::MatrixXd covariance_before(const Combination& combination) {
  JointEvidence before = combination.evidence;
  before.pairs = {};
  return calibrate_jointly(before, combination.joint.estimate.rig, combination.options)
      .estimate.covariance->matrix;
}

/// The largest drift of a batch in standard deviations, with the index of its parameter.
std::pair<double, std::size_t> worst_drift(const MonitoredBatch& batch) {
  std::pair<double, std::size_t> worst{0, 0};
  for (Eigen::Index i = 0; i < batch.offset.size(); ++i) {
    if (!(batch.sigma[i] > 0)) continue;
    const double z = batch.offset[i] / batch.sigma[i];
    if (std::abs(z) > std::abs(worst.first)) worst = {z, static_cast<std::size_t>(i)};
  }
  return worst;
}

std::string drift_table(const std::vector<MonitoredBatch>& batches,
                        const std::vector<std::string>& names) {
  std::string text = fmt::format(
      "drift of each batch relative to the combined solution:\n{:<32} {:>8} {:>8} {:>9} {:>10}"
      "  {}\n",
      "batch", "pairs", "outliers", "rms px", "p", "parameter with the largest drift");
  for (const MonitoredBatch& batch : batches) {
    const auto [z, i] = worst_drift(batch);
    const auto k = static_cast<Eigen::Index>(i);
    const std::string drift = batch.is_all             ? "combined solution"
                              : !batch.failure.empty() ? batch.failure
                              : z == 0 ? "none: the batch says too little of each parameter; see p"
                                       : fmt::format("{} {:+.3g} ± {:.2g} ({:+.1f} sigma)",
                                                     names[i], batch.offset[k], batch.sigma[k], z);
    text += fmt::format("{:<32} {:>8} {:>8} {:>9.4f} {:>10.2g}  {}\n", batch.name, batch.pairs,
                        batch.outliers, batch.rms_px, batch.agreement.p_value, drift);
  }
  return text;
}

/// One line per batch and parameter: batch,name,parameter,offset,sigma (0 where the batch says
/// nothing of the parameter).
std::string drift_csv(const std::vector<MonitoredBatch>& batches,
                      const std::vector<std::string>& names) {
  std::string text = "batch,name,parameter,offset,sigma\n";
  for (std::size_t b = 0; b < batches.size(); ++b) {
    std::string name = batches[b].name;
    for (char& c : name) c = c == ',' || c == '"' || c == '\n' ? '_' : c;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      text += fmt::format("{},{},{},{},{}\n", b, name, names[i], batches[b].offset[k],
                          batches[b].sigma[k]);
    }
  }
  return text;
}

Json drift_json(const std::vector<MonitoredBatch>& batches) {
  Json json = Json::array();
  const auto list = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.begin(), v.end());
  };
  for (const MonitoredBatch& batch : batches) {
    json.push_back({{"name", batch.name},
                    {"pairs", batch.pairs},
                    {"outliers", batch.outliers},
                    {"rms_px", batch.rms_px},
                    {"p_value", batch.agreement.p_value},
                    {"failure", batch.failure},
                    {"offset", list(batch.offset)},
                    {"sigma", list(batch.sigma)}});
  }
  return json;
}

void report_filter(const InformationFilterResult& filtered,
                   Json& json,
                   std::string& text,
                   Session& session) {
  text += fmt::format(
      "information filter: {} differs most from the batch solution, by {:.2g} of its standard "
      "deviations; parameters and covariance above are from the filter, residuals and information "
      "gain from the batch solution\n",
      filtered.worst_parameter.empty() ? "no parameter" : filtered.worst_parameter,
      filtered.worst_in_sigma);
  constexpr double overconfident = 0.8;
  if (filtered.min_sigma_ratio < overconfident) {
    session.warn(
        fmt::format("the filter's sigma is {:.2g} times the batch solution's for {}: the filter "
                    "assumes white noise and exact linearisation",
                    filtered.min_sigma_ratio, filtered.min_parameter));
  }
  json["information_filter"] = {{"worst_in_sigma", filtered.worst_in_sigma},
                                {"worst_parameter", filtered.worst_parameter},
                                {"least_sigma_ratio", filtered.min_sigma_ratio},
                                {"least_parameter", filtered.min_parameter}};
}

void run(const CombineArguments& options, Session& session) {
  std::vector<std::filesystem::path> files(options.inputs.begin(), options.inputs.end());
  files.emplace_back(options.prior);
  check_output_is_not_input(files, options.output);
  if (!options.drift.empty()) {
    check_output_is_not_input(files, options.drift);
    check_different("--drift", options.drift, options.output);
  }
  const std::vector<CombineInput> inputs = load(options, session);
  CombineOptions how;
  how.keep_disagreeing = options.keep_disagreeing;
  how.joint.reject_outliers = !options.keep_outliers;
  Combination combination = combine(inputs, how);
  RigEstimate& estimate = combination.joint.estimate;
  Json json = Json::object();
  std::string text = input_table(combination), tail;
  if (options.mode == "information") {
    const InformationFilterResult filtered = information_filter(inputs, combination, how);
    report_filter(filtered, json, tail, session);
    estimate.rig = filtered.rig;
    estimate.covariance = full_covariance({filtered.rig, filtered.covariance});
    estimate.covariance->kind = CovarianceKind::combined;
    estimate.covariance_mvb = estimate.covariance->matrix;
    estimate.evidence.reset();
  }
  std::vector<MonitoredBatch> batches;
  if (options.monitor) {
    batches = monitor(inputs, combination);
    tail += drift_table(batches, parameter_names(estimate.rig));
    json["drift"] = drift_json(batches);
  }
  text += rig_table(estimate);
  if (combination.joint.observability) {
    const ObservabilityReport seen =
        report_observability(combination.joint, covariance_before(combination));
    text += seen.text;
    if (!seen.warning.empty()) estimate.calibration->warnings.push_back(seen.warning);
    json["observability"] = seen.json;
  }
  Json whole = rig_json(estimate);
  whole["inputs"] = inputs_json(combination);
  whole.update(json);
  whole["output"] = options.output;
  OutputFiles outputs;
  if (!options.drift.empty()) {
    outputs.add(options.drift, drift_csv(batches, parameter_names(estimate.rig)));
  }
  outputs.add(options.output,
              format_rig(estimate, options.no_evidence ? KeepEvidence::no : KeepEvidence::yes));
  outputs.commit();
  for (const std::string& warning : estimate.calibration->warnings) session.warn(warning);
  for (const std::string& warning : estimate.calibration->trust_warnings)
    session.add_trust_warning(warning);
  session.result(whole, text + tail + fmt::format("written to {}\n", options.output));
}

}  // namespace

void add_combine(CLI::App& app, Session& session) {
  auto o = std::make_shared<CombineArguments>();
  CLI::App* verb = add_verb(
      app, session, "combine",
      "combine board calibrations, batches of matched pairs and priors into one calibration",
      "vernier combine --prior datasheet.json monday.csv tuesday.csv -o rig.json\n"
      "  vernier combine board.json monday.csv tuesday.csv --monitor --drift drift.csv "
      "-o rig.json");
  verb->add_option("INPUT", o->inputs,
                   "rig files and pairs files (*.csv) in chronological order; --prior, or else the "
                   "first rig file, is processed first")
      ->required();
  verb->add_option("--prior", o->prior, "rig file to process before all other inputs");
  verb->add_option("--mode", o->mode,
                   "batch: solve all raw data jointly; information: filter that keeps only mean "
                   "and covariance, compared with the batch solution")
      ->check(CLI::IsMember({"batch", "information"}))
      ->capture_default_str();
  verb->add_flag("--keep-disagreeing", o->keep_disagreeing,
                 "keep inputs that are inconsistent with the previous ones (p below 1e-4)");
  verb->add_flag("--keep-outliers", o->keep_outliers, "do not reject outlier pairs");
  verb->add_flag("--monitor", o->monitor, "report the drift of the rig from batch to batch");
  verb->add_option("--drift", o->drift, "CSV file with the offsets of every batch (with --monitor)")
      ->needs("--monitor");
  verb->add_flag("--no-evidence", o->no_evidence, "do not store corners and pairs in the rig file");
  verb->add_option("-o,--output", o->output, "rig file")->required();
  check_files_written(*verb, {"--output", "--drift"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
