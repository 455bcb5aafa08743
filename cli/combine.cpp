// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/combine.h"

#include <cmath>

#include "calib/atomic_file.h"
#include "calib/error.h"
#include "calib/pairs_file.h"
#include "calib/rig_file.h"
#include "cli/observability_report.h"
#include "cli/rig_table.h"
#include "cli/session.h"
#include "cli/share_folder.h"
#include "cli/spare_inputs.h"

namespace vernier::cli {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string prior, mode = "batch", output, drift;
  bool keep_disagreeing = false, monitor = false, no_evidence = false, keep_outliers = false;
};

bool is_pairs_file(const std::string& name) {
  return std::filesystem::path(name).extension() == ".csv";
}

std::vector<CombineInput> load(const Options& options, Session& session) {
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
    for (const std::string& warning : file.warnings) session.warn(warning);
    input.estimate = std::move(file.estimate);
  }
  return inputs;
}

std::string input_table(const Combination& combination) {
  std::string text = fmt::format("{:<32} {:>15} {:>10} {:>5} {:>10}  {}\n", "input", "kind", "chi²",
                                 "dof", "p", "most against what stood before");
  for (const CombinedInput& input : combination.inputs) {
    const PriorAgreement& a = input.agreement;
    const bool first = &input == &combination.inputs.front();
    text += fmt::format("{:<32} {:>15} {:>10} {:>5} {:>10}  {}\n", input.name, input.kind,
                        first ? "" : fmt::format("{:.1f}", a.chi2),
                        first ? "" : fmt::format("{}", a.dof),
                        first ? "" : fmt::format("{:.2g}", a.p_value),
                        first ? "stands first"
                              : fmt::format("{}{:.1f} sigma where {}",
                                            input.used ? "" : "LEFT OUT: ", a.in_sigma, a.words));
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
                    {"p_value", input.agreement.p_value},
                    {"in_sigma", input.agreement.in_sigma},
                    {"words", input.agreement.words}});
  }
  return json;
}

/// What was known before any pairs, as a covariance of the combined rig.
Eigen::MatrixXd covariance_before(const Combination& combination, const CombineOptions& options) {
  JointEvidence before = combination.evidence;
  before.pairs = {};
  return calibrate_jointly(before, combination.joint.estimate.rig, options.joint)
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
      "batch", "pairs", "outliers", "rms px", "p", "largest drift");
  for (const MonitoredBatch& batch : batches) {
    const auto [z, i] = worst_drift(batch);
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

void say_filter(const FilteredRig& filtered, Json& json, std::string& text) {
  text += fmt::format(
      "information filter: {} ends {:.2g} of the batch solution's standard deviations from it\n",
      filtered.worst_parameter.empty() ? "no parameter" : filtered.worst_parameter,
      filtered.worst_in_sigma);
  json["information_filter"] = {{"worst_in_sigma", filtered.worst_in_sigma},
                                {"worst_parameter", filtered.worst_parameter}};
}

void run(const Options& options, Session& session) {
  std::vector<std::filesystem::path> files(options.inputs.begin(), options.inputs.end());
  files.emplace_back(options.prior);
  spare_inputs(files, options.output);
  if (!options.drift.empty()) {
    spare_inputs(files, options.drift);
    if (std::filesystem::path(options.drift) == std::filesystem::path(options.output)) {
      throw Error("--drift", "it is the rig file too", "name another file");
    }
  }
  const std::vector<CombineInput> inputs = load(options, session);
  CombineOptions how;
  how.keep_disagreeing = options.keep_disagreeing;
  how.joint.reject_outliers = !options.keep_outliers;
  Combination combination = combine(inputs, how);
  RigEstimate& estimate = combination.joint.estimate;
  for (const CombinedInput& input : combination.inputs) {
    if (input.used) continue;
    estimate.calibration->doubts.push_back(fmt::format(
        "{} disagrees with what stands before it (chi² {:.1f} for {}, p {:.1g}) and was left out: "
        "the rig has changed, or one of them states too little uncertainty",
        input.name, input.agreement.chi2, input.agreement.dof, input.agreement.p_value));
  }
  Json json;
  std::string text = input_table(combination), tail;
  if (options.mode == "information") {
    const FilteredRig filtered = information_filter(inputs, combination, how);
    say_filter(filtered, json, tail);
    estimate.rig = filtered.rig;
    estimate.covariance = whole_covariance({filtered.rig, filtered.covariance});
    estimate.covariance->kind = CovarianceKind::combined;
    estimate.covariance_mvb = estimate.covariance->matrix;
    estimate.evidence.reset();
  }
  if (options.monitor) {
    const std::vector<MonitoredBatch> batches = monitor(inputs, combination, how);
    const std::vector<std::string> names = parameter_names(estimate.rig);
    tail += drift_table(batches, names);
    json["drift"] = drift_json(batches);
    if (!options.drift.empty()) write_drift(batches, names, options.drift);
  }
  write_rig(estimate, options.output, options.no_evidence ? KeepEvidence::no : KeepEvidence::yes);
  for (const std::string& warning : estimate.calibration->warnings) session.warn(warning);
  for (const std::string& doubt : estimate.calibration->doubts) session.doubt(doubt);
  text += rig_table(estimate);
  if (combination.joint.observability) {
    const ObservabilityReport seen =
        report_observability(combination.joint, covariance_before(combination, how));
    text += seen.text;
    json["observability"] = seen.json;
  }
  Json whole = rig_json(estimate);
  whole["inputs"] = inputs_json(combination);
  whole.update(json);
  whole["output"] = options.output;
  session.result(whole, text + tail + fmt::format("written to {}\n", options.output));
}

}  // namespace

void add_combine(CLI::App& app, Session& session) {
  auto o = std::make_shared<Options>();
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
