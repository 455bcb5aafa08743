// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/instruction_set.h"
#include "calib/base/output_files.h"
#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/machine.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/report/figure_svg.h"
#include "cli/report/report_calibration.h"
#include "cli/report/report_data.h"
#include "cli/report/report_evaluation.h"
#include "cli/report/study_figures.h"
#include "cli/simulation/study_doubts.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_inputs.h"
#include "sim/study/study.h"
#include "sim/study/system_kind.h"
#include "sim/world.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> inputs, calibrations;
  std::string title, output, figures;
  bool no_proof = false;
};

/// Inputs of the page: studies, at most one evaluation of matchers, and rig files.
struct Inputs {
  std::vector<std::string> studies;
  std::string evaluation;
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
    } else if (std::any_of(inputs.studies.begin(), inputs.studies.end(),
                           [&](const std::string& other) { return fs::equivalent(other, name); })) {
      throw Error(name, "is given twice", "give each study once");
    } else {
      inputs.studies.push_back(name);
    }
  }
  inputs.rigs.insert(inputs.rigs.end(), options.calibrations.begin(), options.calibrations.end());
  return inputs;
}

struct LoadedStudy {
  std::string folder;
  Study study;
  StudyResults results;
  StudyDoubts doubts;
};

LoadedStudy load(const std::string& folder, Session& session) {
  LoadedStudy loaded{folder, open_folder(folder, session), {}, {}};
  loaded.results = study_results(loaded.study, folder, listed_of_a_cell(loaded.study));
  const StudyResults& results = loaded.results;
  if (results.blocks_done == 0) {
    throw Error(folder, "contains no finished block", "run the study first");
  }
  loaded.doubts = doubts_of(loaded.study, results);
  tell_stored(loaded.doubts, results, session);
  return loaded;
}

/// The last parts of folders' names, as many as tell them apart: legends have little room.
std::vector<std::string> names_of(const std::vector<LoadedStudy>& studies) {
  std::vector<fs::path> rest;
  std::vector<std::string> names;
  for (const LoadedStudy& loaded : studies) {
    const fs::path folder = fs::path(loaded.folder).lexically_normal();
    const fs::path whole = folder.has_filename() ? folder : folder.parent_path();
    names.push_back(whole.filename().string());
    rest.push_back(whole.parent_path());
  }
  const auto are_distinct = [&] {
    return std::set<std::string>(names.begin(), names.end()).size() == names.size();
  };
  while (!are_distinct()) {
    bool longer = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!rest[i].has_filename()) continue;
      names[i] = rest[i].filename().string() + "/" + names[i];
      rest[i] = rest[i].parent_path();
      longer = true;
    }
    if (!longer) break;
  }
  return names;
}

/// The worlds of the cells, each once and named in its cells by its number, if there are several.
void add_worlds(const Study& study, Json& part) {
  std::map<const World*, std::size_t> numbers;
  Json worlds = Json::array();
  for (std::size_t i = 0; i < study.file.cells.size(); ++i) {
    const World& world = world_of(study, study.file.cells[i]);
    const auto [known, is_new] = numbers.emplace(&world, worlds.size());
    if (is_new) worlds.push_back(report_world(world));
    part["study"]["cells"][i]["world"] = known->second;
  }
  if (worlds.size() > 1) part["worlds"] = std::move(worlds);
}

/// What the page says of one study.
Json study_part(const LoadedStudy& loaded, const std::string& name) {
  Json part{{"name", name}, {"study", report_study(loaded.study, loaded.results)}};
  part["study"]["doubts"] = loaded.doubts.doubts;
  part["study"]["warnings"] = loaded.doubts.warnings;
  if (!loaded.study.file.cells[0].system.is_localiser()) return part;
  part["world"] = report_world(loaded.study.world);
  part["view"] = report_view(loaded.study);
  add_worlds(loaded.study, part);
  return part;
}

/// One study makes the page; several stand below each other. A rig of several is shown once.
void add_studies(const std::vector<LoadedStudy>& studies,
                 Session& session,
                 Validation proof,
                 Json& data) {
  std::set<std::string> rigs;
  const std::vector<std::string> names = names_of(studies);
  for (std::size_t i = 0; i < studies.size(); ++i) {
    const LoadedStudy& loaded = studies[i];
    Json part = study_part(loaded, names[i]);
    if (studies.size() == 1) {
      for (const char* key : {"study", "world", "worlds", "view"}) {
        if (part.contains(key)) data[key] = std::move(part[key]);
      }
    } else {
      data["studies"].push_back(std::move(part));
    }
    if (rigs.insert(loaded.study.rig_fingerprint).second) {
      data["rigs"].push_back(report_rig(loaded.study.rig, loaded.study.file.rig, proof, session));
    }
    for (const auto& [file, told] : loaded.study.told_rigs) {
      if (!rigs.insert(told.fingerprint).second) continue;
      data["rigs"].push_back(report_rig(told.estimate, file, proof, session));
    }
  }
}

struct NamedRig {
  std::string file;
  RigEstimate estimate;
};

/// All input files of the page.
std::vector<fs::path> files_read(const Inputs& inputs) {
  std::vector<fs::path> files;
  for (const std::string& study : inputs.studies) {
    const std::vector<fs::path> more = study_folder_files(study);
    files.insert(files.end(), more.begin(), more.end());
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

void add_rig(const NamedRig& rig, Session& session, Validation proof, Json& data) {
  data["rigs"].push_back(report_rig(rig.estimate, rig.file, proof, session));
  const Json& calibration = data["rigs"].back()["calibration"];
  if (!calibration.is_object()) return;
  for (const Json& words : calibration["warnings"]) {  // trust warnings were printed on reading
    session.warn(rig.file + ": " + words.get<std::string>());
  }
}

/// Figures for papers of each study: DIR/success.svg and .pdf, of several studies in a folder each.
std::vector<std::string> add_figures(const std::vector<LoadedStudy>& studies,
                                     const fs::path& folder,
                                     Session& session,
                                     OutputFiles& outputs) {
  std::vector<std::string> files;
  bool has_pdf = true;
  outputs.add_folder(folder);
  for (std::size_t i = 0; i < studies.size(); ++i) {
    const fs::path into = studies.size() == 1 ? folder : folder / fmt::format("study-{}", i + 1);
    outputs.add_folder(into);
    for (const auto& [name, figure] : study_figures(studies[i].results)) {
      const std::string svg = figure_svg(figure);
      outputs.add(into / (name + ".svg"), svg);
      files.push_back((into / (name + ".svg")).string());
      if (!has_pdf) continue;
      const std::optional<std::string> pdf = svg_as_pdf(svg);
      has_pdf = pdf.has_value();
      if (!pdf) continue;
      outputs.add(into / (name + ".pdf"), *pdf);
      files.push_back((into / (name + ".pdf")).string());
    }
  }
  if (!has_pdf) {
    session.warn("figures are SVG only: PDF needs rsvg-convert (Debian's package librsvg2-bin)");
  }
  return files;
}

std::string title_of(const std::vector<LoadedStudy>& studies) {
  std::set<std::string> systems;
  for (const LoadedStudy& loaded : studies) systems.insert(loaded.study.file.cells[0].system.name);
  if (systems.size() > 1) return "Studies of several systems";
  const bool several = studies.size() > 1;
  if (*systems.begin() == "localiser") {
    return several ? "Studies of localisation under calibration error"
                   : "Localisation under calibration error";
  }
  return fmt::format("{} of {}", several ? "Studies" : "Study", system_kind(*systems.begin()).noun);
}

std::string title_of(const ReportArguments& options,
                     const Inputs& inputs,
                     const std::vector<LoadedStudy>& studies) {
  if (!options.title.empty()) return options.title;
  if (!studies.empty()) return title_of(studies);
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
  if (!options.figures.empty() && inputs.studies.empty()) {
    throw Error("--figures", "no study is given, whose figures they would be",
                "give a folder written by vernier study -o");
  }
  const Validation proof = options.no_proof ? Validation::skip : Validation::make;
  std::vector<LoadedStudy> studies;
  for (const std::string& folder : inputs.studies) studies.push_back(load(folder, session));
  Json data{{"title", title_of(options, inputs, studies)}};
  data["program"] = {{"version", VERNIER_VERSION},
                     {"instruction_set", instruction_set()},
                     {"machine", program_and_machine()},
                     {"command", session.command}};
  data["rigs"] = Json::array();
  add_studies(studies, session, proof, data);
  if (!inputs.evaluation.empty()) data["evaluation"] = report_evaluation(inputs.evaluation);
  for (const NamedRig& rig : rigs) {
    with_errors_of(rig.file, [&] { add_rig(rig, session, proof, data); });
  }
  const std::string page = assemble_page(page_folder, data);
  const bool plots = has_plots(page_folder);
  OutputFiles outputs;
  outputs.add(options.output, page);
  std::vector<std::string> figures;
  if (!options.figures.empty()) figures = add_figures(studies, options.figures, session, outputs);
  outputs.commit();
  if (!plots) {
    session.warn(
        "the page has tables but no plots: vernier was built without plots (see vernier doctor)");
  }
  session.result({{"output", options.output},
                  {"bytes", page.size()},
                  {"rigs", inputs.rigs},
                  {"plots", plots},
                  {"figures", figures}},
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
                   "study folders, an evaluation folder, or rig files; several are allowed")
      ->required();
  verb->add_option("--calibration", o->calibrations, "additional rig file to show (repeatable)");
  verb->add_flag(
      "--no-proof", o->no_proof,
      "skip cross-validation (lens models and held-out boards), which takes some seconds per rig");
  verb->add_option("--title", o->title, "page title");
  verb->add_option("--figures", o->figures,
                   "folder for the figures of studies as SVG and PDF, for papers");
  verb->add_option("-o,--output", o->output, "HTML file")->required();
  check_files_written(*verb, {"--output"});
  check_folder_written(*verb, "--figures");
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
