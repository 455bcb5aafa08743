// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calib/base/column_file.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/output_files.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/simulation/export_tables.h"
#include "cli/simulation/study_doubts.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_inputs.h"
#include "sim/study/study.h"

namespace vernier::cli {
namespace {

struct ExportArguments {
  std::string folder, output;
  bool trials = false, settings = false;
};

void run(const ExportArguments& options, Session& session) {
  ColumnFile::format_of(options.output);  // before any work
  if (options.trials && options.settings) {
    throw Error("export", "--settings is for the table of cells", "leave out --trials");
  }
  const Study study = open_folder(options.folder, session);
  check_output_is_not_input(study_folder_files(options.folder), options.output);
  OutputFiles outputs;
  FileInProgress& file = outputs.add(options.output);
  const StudyResults results = options.trials
                                   ? export_trials(study, options.folder, options.output, file)
                                   : study_results(study, options.folder, 0);
  std::size_t rows = 0;
  if (options.trials) {
    for (const CellResult& cell : results.cells) {
      for (const ClusterCount& map : cell.maps) rows += static_cast<std::size_t>(map.trials);
    }
  } else {
    rows = export_cells(study, results, options.settings, options.output, file);
  }
  tell_stored(doubts_of(study, results), results, session);
  outputs.commit();
  const char* what = options.trials ? "trials" : "cells";
  session.result({{"output", options.output}, {"table", what}, {"rows", rows}},
                 fmt::format("{}: {} {}\n", options.output, rows, what));
}

}  // namespace

void add_export(CLI::App& app, Session& session) {
  auto o = std::make_shared<ExportArguments>();
  CLI::App* verb = add_verb(app, session, "export",
                            "write a study's cells or trials as a table: CSV, or NumPy's .npy",
                            "vernier export results -o results.csv\n"
                            "  vernier export results --trials -o trials.npy");
  verb->add_option("folder", o->folder, "folder of a study")->required();
  verb->add_flag("--trials", o->trials, "one row for each trial instead of each cell");
  verb->add_flag("--settings", o->settings, "all settings of a cell, not only those swept");
  verb->add_option("-o,--output", o->output, "table, .csv or .npy")->required();
  check_files_written(*verb, {"--output"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
