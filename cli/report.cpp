// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/atomic_file.h"
#include "calib/error.h"
#include "calib/rig_file.h"
#include "cli/report_data.h"
#include "cli/session.h"
#include "cli/share_folder.h"
#include "localise/bhattacharyya.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string folder, title, output;
  std::vector<std::string> calibrations;
};

void run(const Options& options, Session& session) {
  const fs::path page_folder = share_folder() / "page";
  if (!fs::is_regular_file(page_folder / "report.html")) {
    throw Error("report", "the page's files are not installed beside the program",
                "set VERNIER_SHARE to the folder share/vernier of an installation");
  }
  const Study study = open_folder(options.folder, session);
  const StudyResults results = study_results(study, options.folder);
  if (results.blocks_done == 0) {
    throw Error(options.folder, "holds no finished block", "run the study first");
  }
  if (results.blocks_done < results.blocks_total) {
    session.doubt(fmt::format("the study is not finished: {} of {} blocks", results.blocks_done,
                              results.blocks_total));
  }
  Json data{
      {"title", options.title.empty() ? "Localisation under calibration error" : options.title}};
  data["program"] = {
      {"version", VERNIER_VERSION},
      {"instruction_set", target_name()},
      {"command", "vernier study study.toml -o " + fs::path(options.folder).filename().string()}};
  data["study"] = report_study(study, results);
  data["world"] = report_world(study.world);
  data["rig"] = report_rig(study.rig, study.file.rig);
  data["view"] = report_view(study);
  data["calibrations"] = Json::array();
  for (const std::string& name : options.calibrations) {
    const RigEstimate rig = read_rig(find_rig(name)).estimate;
    Json entry = report_rig(rig, fs::path(name).filename().string());
    entry["name"] =
        fs::path(name).stem().string() + ", " + std::string(model_name(rig.rig.cameras[0].model));
    if (rig.calibration) {
      entry["rms_px"] = rig.calibration->rms_px;
      entry["pixel_sigma_px"] = rig.calibration->pixel_sigma_px;
      entry["views"] = rig.calibration->views;
    }
    data["calibrations"].push_back(std::move(entry));
  }
  const std::string page = assemble_page(page_folder, data);
  write_atomically(options.output, page);
  session.result({{"output", options.output}, {"bytes", page.size()}},
                 fmt::format("{} ({:.1f} MB, opens without network)\n", options.output,
                             static_cast<double>(page.size()) / 1e6));
}

}  // namespace

void add_report(CLI::App& app, Session& session) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, session, "report", "one self-contained HTML page of a study",
                            "vernier report DIR -o report.html");
  verb->add_option("folder", o->folder, "folder of a study")->required();
  verb->add_option("--calibration", o->calibrations,
                   "a rig file whose calibration is shown too (may be repeated)");
  verb->add_option("--title", o->title, "heading of the page");
  verb->add_option("-o,--output", o->output, "HTML file")->required();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
