// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "calib/base/output_files.h"
#include "calib/error.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/simulation/study_processes.h"
#include "cli/simulation/tune_result.h"
#include "cli/simulation/tune_search.h"

namespace vernier::cli {
namespace {

void run(const TuneOptions& options, Session& session) {
  refuse_several_processes("tune");
  const TuneResult result = tune_study(options, session);
  const Json json = tune_json(result);
  OutputFiles files;
  files.add(std::filesystem::path(options.folder) / tune_result_file, json.dump(2) + "\n");
  files.commit();
  if (const std::string doubt = doubt_of(result); !doubt.empty()) session.add_trust_warning(doubt);
  session.result(json, tune_text(result));
}

}  // namespace

void add_tune(CLI::App& app, Session& session) {
  auto o = std::make_shared<TuneOptions>();
  CLI::App* verb = add_verb(
      app, session, "tune",
      "search the settings of a study's sweep by a race on shared trials, and confirm the best",
      "vernier tune FILE.toml -o DIR         # run, or go on with the search in DIR");
  verb->add_option("file", o->file, "study file with [sweep] and [tune]")->required();
  verb->add_option("-o,--output", o->folder, "output folder")->required();
  verb->add_option("--threads", o->threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  verb->add_flag("--allow-other-instruction-set", o->allow_other_instruction_set,
                 "accept results of another kind of processor, though not identical to the bit");
  check_folder_written(*verb, "--output");
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
