// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/error_place.h"
#include "calib/base/instruction_set.h"
#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/report/report_calibration.h"
#include "cli/report/report_data.h"
#include "cli/report/report_evaluation.h"
#include "cli/simulation/study_folder.h"
#include "sim/study/study.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> inputs, calibrations;
  std::string title, output;
  bool no_proof = false;
};

/// Inputs of the page: at most one study, at most one evaluation of matchers, and rig files.
struct Inputs {
  std::string study, evaluation;
  std::vector<std::string> rigs;
};

Inputs inputs_of(const ReportArguments& options) {
  Inputs inputs;
  for (const std::string& name : options.inputs) {
    if (!fs::is_directory(name)) {
      inputs.rigs.push_back(name);
    } else if (is_evaluation(name)) {
      if (!inputs.evaluation.empty()) {
        throw Error(name, "is a second evaluation", "give one per page");
      }
      inputs.evaluation = name;
    } else if (!fs::exists(fs::path(name) / "study.toml")) {
      throw Error(name, "is neither a study folder nor an evaluation folder",
                  "give a folder written by vernier study -o or vernier evaluate -o");
    } else if (inputs.study.empty()) {
      inputs.study = name;
    } else {
      throw Error(name, "is a second study", "give one per page");
    }
  }
  inputs.rigs.insert(inputs.rigs.end(), options.calibrations.begin(), options.calibrations.end());
  return inputs;
}

void add_study(const std::string& folder, Session& session, Validation proof, Json& data) {
  const Study study = open_folder(folder, session);
  const StudyResults results = study_results(study, folder);
  if (results.blocks_done == 0) {
    throw Error(folder, "contains no finished block", "run the study first");
  }
  if (results.blocks_done < results.blocks_total) {
    session.add_trust_warning(fmt::format("the study is not finished: {} of {} blocks",
                                          results.blocks_done, results.blocks_total));
  }
  data["study"] = report_study(study, results);
  data["world"] = report_world(study.world);
  data["view"] = report_view(study);
  data["rigs"].push_back(report_rig(study.rig, study.file.rig, proof, session));
}

struct NamedRig {
  std::string file;
  RigEstimate estimate;
};

/// All input files of the page.
std::vector<fs::path> files_read(const Inputs& inputs) {
  std::vector<fs::path> files;
  if (!inputs.study.empty()) {
    files = study_folder_files(inputs.study);
  }
  if (!inputs.evaluation.empty()) {
    const std::vector<fs::path> more = evaluation_files(inputs.evaluation);
    files.insert(files.end(), more.begin(), more.end());
  }
  for (const std::string& rig : inputs.rigs) files.push_back(find_rig(rig));
  return files;
}

/// Reads all rigs before any computation, so that errors are reported immediately.
std::vector<NamedRig> read_rigs(const std::vector<std::string>& names, Session& session) {
  std::vector<NamedRig> rigs;
  for (const std::string& name : names) {
    const fs::path path = find_rig(name);
    RigFile file = read_rig(path);
    for (const std::string& warning : file.warnings) session.warn(warning);
    rigs.push_back({path.filename().string(), std::move(file.estimate)});
  }
  return rigs;
}

void add_rig(const NamedRig& rig, const Session& session, Validation proof, Json& data) {
  data["rigs"].push_back(report_rig(rig.estimate, rig.file, proof, session));
  const Json& calibration = data["rigs"].back()["calibration"];
  if (!calibration.is_object()) return;
  for (const Json& words : calibration["warnings"]) {  // trust warnings were printed on reading
    session.warn(rig.file + ": " + words.get<std::string>());
  }
}

std::string title_of(const ReportArguments& options, const Inputs& inputs) {
  if (!options.title.empty()) return options.title;
  if (!inputs.study.empty()) return "Localisation under calibration error";
  if (!inputs.evaluation.empty()) return "Stereo matchers at edges";
  return inputs.rigs.size() > 1 ? "Calibrations and their uncertainty"
                                : "Calibration and its uncertainty";
}

void run(const ReportArguments& options, Session& session) {
  const fs::path page_folder = shipped_file("page/report.html").parent_path();
  if (page_folder.empty()) {
    throw Error("report", "the page template is not installed with the program",
                "set VERNIER_SHARE to share/vernier of an installation");
  }
  check_script(page_folder);  // before minutes of work
  const Inputs inputs = inputs_of(options);
  const std::vector<NamedRig> rigs = read_rigs(inputs.rigs, session);
  check_output_is_not_input(files_read(inputs), options.output);
  const Validation proof = options.no_proof ? Validation::skip : Validation::make;
  Json data{{"title", title_of(options, inputs)}};
  data["program"] = {{"version", VERNIER_VERSION},
                     {"instruction_set", instruction_set()},
                     {"command", session.command}};
  data["rigs"] = Json::array();
  if (!inputs.study.empty()) add_study(inputs.study, session, proof, data);
  if (!inputs.evaluation.empty()) data["evaluation"] = report_evaluation(inputs.evaluation);
  for (const NamedRig& rig : rigs) {
    with_errors_of(rig.file, [&] { add_rig(rig, session, proof, data); });
  }
  const std::string page = assemble_page(page_folder, data);
  const bool plots = has_plots(page_folder);
  write_atomically(options.output, page);
  if (!plots) {
    session.warn(
        "the page has tables but no plots: vernier was built without plots (see vernier doctor)");
  }
  session.result(
      {{"output", options.output}, {"bytes", page.size()}, {"rigs", inputs.rigs}, {"plots", plots}},
      fmt::format("{} ({:.1f} MB, self-contained{})\n", options.output,
                  static_cast<double>(page.size()) / 1e6, plots ? "" : ", no plots"));
}

}  // namespace

void add_report(CLI::App& app, Session& session) {
  auto o = std::make_shared<ReportArguments>();
  CLI::App* verb =
      add_verb(app, session, "report",
               "write a self-contained HTML report of a study, an evaluation or calibrations",
               "vernier report rig.json -o report.html");
  verb->add_option("input", o->inputs,
                   "study folder, evaluation folder, or rig files; several are allowed")
      ->required();
  verb->add_option("--calibration", o->calibrations, "additional rig file to show (repeatable)");
  verb->add_flag(
      "--no-proof", o->no_proof,
      "skip cross-validation (lens models and held-out boards), which takes some seconds per rig");
  verb->add_option("--title", o->title, "page title");
  verb->add_option("-o,--output", o->output, "HTML file")->required();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
