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

#include "calib/base/atomic_file.h"
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
    for (const std::string& warning : file.warnings) {  // its doubts come with the result
      if (!warning.starts_with(stored_warning_prefix(find_rig(name).string())))
        session.warn(warning);
    }
    input.estimate = std::move(file.estimate);
  }
  return inputs;
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
                  "dof", "clusters", "p", "most against what stood before");
  for (const CombinedInput& input : combination.inputs) {
    const PriorConsistency& a = input.agreement;
    text += fmt::format("{:<{}} {:>15} ", input.name, width, input.kind);
    const std::string out = input.used ? "" : "LEFT OUT: ";
    if (&input == &combination.inputs.front()) {
      text += fmt::format("{:>10} {:>5} {:>8} {:>10}  stands first\n", "", "", "", "");
    } else if (a.dof == 0) {
      text += fmt::format("{:>10} {:>5} {:>8} {:>10}  {}{}\n", "", "", "", "", out, a.description);
    } else {
      text += fmt::format("{:>10.1f} {:>5} {:>8} {:>10.2g}  {}{:.1f} sigma where {}\n", a.chi2,
                          a.dof, a.clusters > 0 ? fmt::format("{}", a.clusters) : "-", a.p_value,
                          out, a.in_sigma, a.description);
    }
  }
  if (by_f) {
    text +=
        "(clusters: image pairs, or parts of them, from which the scatter of the pairs was "
        "estimated; few of them make chi² large by chance, so p is of Fisher's F with clusters - 1 "
        "degrees of freedom below)\n";
  }
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
                    {"words", input.agreement.description}});
  }
  return json;
}

/// What was known before any pairs, as a covariance of the combined rig.
Eigen::MatrixXd covariance_before(const Combination& combination) {
  JointEvidence before = combination.evidence;
  before.pairs = {};
  return calibrate_jointly(before, combination.joint.estimate.rig, combination.options)
      .estimate.covariance->matrix;
}

/// The parameter of a batch that drifted most, in standard deviations.
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
      "drift, every batch alone against all together:\n{:<32} {:>8} {:>8} {:>9} {:>10}"
      "  {}\n",
      "batch", "pairs", "outliers", "rms px", "p", "largest drift of all parameters");
  for (const MonitoredBatch& batch : batches) {
    const auto [z, i] = worst_drift(batch);
    if (batch.is_all) {
      text += fmt::format("{:<32} {:>8} {:>8} {:>9.4f} {:>10.2g}  all there is\n", batch.name,
                          batch.pairs, batch.outliers, batch.rms_px, batch.agreement.p_value);
      continue;
    }
    text += fmt::format(
        "{:<32} {:>8} {:>8} {:>9.4f} {:>10.2g}  {} {:+.3g} ± {:.2g} ({:+.1f} sigma)"
        "\n",
        batch.name, batch.pairs, batch.outliers, batch.rms_px, batch.agreement.p_value, names[i],
        batch.offset[static_cast<Eigen::Index>(i)], batch.sigma[static_cast<Eigen::Index>(i)], z);
  }
  return text;
}

/// One line a batch and parameter: batch,parameter,offset,sigma.
void write_drift(const std::vector<MonitoredBatch>& batches,
                 const std::vector<std::string>& names,
                 const std::string& file) {
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
  write_atomically(file, text);
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
                    {"offset", list(batch.offset)},
                    {"sigma", list(batch.sigma)}});
  }
  return json;
}

void say_filter(const InformationFilterResult& filtered,
                Json& json,
                std::string& text,
                Session& session) {
  text += fmt::format(
      "information filter: {} ends {:.2g} of the batch solution's standard deviations from it; "
      "parameters and covariance above are the filter's, residuals and what the pairs brought the "
      "batch solution's\n",
      filtered.worst_parameter.empty() ? "no parameter" : filtered.worst_parameter,
      filtered.worst_in_sigma);
  constexpr double overconfident = 0.8;
  if (filtered.min_sigma_ratio < overconfident) {
    session.warn(fmt::format(
        "the filter states {:.2g} times the batch solution's sigma for {}: it takes noise for "
        "white and its linearisations for exact",
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
    say_filter(filtered, json, tail, session);
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
    json["observability"] = seen.json;
  }
  Json whole = rig_json(estimate);
  whole["inputs"] = inputs_json(combination);
  whole.update(json);
  whole["output"] = options.output;
  if (!options.drift.empty()) {
    write_drift(batches, parameter_names(estimate.rig), options.drift);
  }
  write_rig(estimate, options.output, options.no_evidence ? KeepEvidence::no : KeepEvidence::yes);
  for (const std::string& warning : estimate.calibration->warnings) session.warn(warning);
  for (const std::string& warning : estimate.calibration->trust_warnings)
    session.add_trust_warning(warning);
  session.result(whole, text + tail + fmt::format("written to {}\n", options.output));
}

}  // namespace

void add_combine(CLI::App& app, Session& session) {
  auto o = std::make_shared<CombineArguments>();
  CLI::App* verb =
      add_verb(app, session, "combine",
               "one calibration from several: boards, batches of matched pairs, priors",
               "vernier combine --prior datasheet.json monday.csv tuesday.csv -o rig.json\n"
               "  vernier combine board.json monday.csv tuesday.csv --monitor --drift drift.csv "
               "-o rig.json");
  verb->add_option("INPUT", o->inputs,
                   "rig files and pairs files (*.csv) in the order of time; the first rig file, or "
                   "--prior, stands first")
      ->required();
  verb->add_option("--prior", o->prior, "a rig file that stands before all others");
  verb->add_option("--mode", o->mode,
                   "batch: all raw data as one problem; information: a filter that keeps a mean "
                   "and a covariance only, with its distance from the batch solution")
      ->check(CLI::IsMember({"batch", "information"}))
      ->capture_default_str();
  verb->add_flag("--keep-disagreeing", o->keep_disagreeing,
                 "average in what disagrees with what stands before it (p below 1e-4)");
  verb->add_flag("--keep-outliers", o->keep_outliers, "leave no pair out");
  verb->add_flag("--monitor", o->monitor, "how the rig drifts from batch to batch");
  verb->add_option("--drift", o->drift, "CSV of every batch's offsets (with --monitor)")
      ->needs("--monitor");
  verb->add_flag("--no-evidence", o->no_evidence, "leave corners and pairs out of the rig file");
  verb->add_option("-o,--output", o->output, "rig file")->required();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
