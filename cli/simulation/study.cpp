// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/output_files.h"
#include "calib/error.h"
#include "cli/program/machine.h"
#include "cli/program/session.h"
#include "cli/simulation/folder_claim.h"
#include "cli/simulation/route_remarks.h"
#include "cli/simulation/shard_choice.h"
#include "cli/simulation/study_doubts.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_inputs.h"
#include "cli/simulation/study_merge.h"
#include "cli/simulation/study_processes.h"
#include "cli/simulation/study_run.h"
#include "cli/simulation/study_table.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

struct StudyArguments {
  std::vector<std::string> words;  ///< FILE, or status DIR, or merge DIR…
  std::string folder, shard;
  int threads = 0;
  bool allow_other_instruction_set = false;

  OtherInstructionSets other_instruction_sets() const {
    return allow_other_instruction_set ? OtherInstructionSets::allowed
                                       : OtherInstructionSets::refused;
  }
};

void print(const Study& study, const fs::path& folder, Session& session) {
  const StudyResults results = study_results(study, folder, 0);
  tell(doubts_of(study, results), session);
  session.result(study_json(study, results), study_table(study, results));
}

/// Of each world and height of the camera.
void tell_blocked_routes(const Study& study, Session& session) {
  if (!system_of(study.file).uses_protocol) return;
  std::set<std::pair<std::string, double>> told;
  for (const StudyCell& cell : study.file.cells) {
    const double height_m = cell.experiment.mount.height_m;
    if (!told.emplace(cell.world, height_m).second) continue;
    tell_blocked_route(world_of(study, cell), cell.world, height_m, session);
  }
}

void run(const StudyArguments& options, Session& session) {
  if (options.folder.empty()) {
    throw Error("study", "no output folder given", "give -o DIR");
  }
  const fs::path file = options.words[0];
  if (!fs::is_directory(options.folder)) check_writable_folder(options.folder);
  StudyProcesses processes;
  if (processes.only_computes()) return processes.compute(file, options.threads, session);
  StudyRun job;
  job.folder = options.folder;
  job.threads = processes.threads(options.threads);
  job.ranks = processes.others();
  job.shard = shard_choice(options.shard);
  job.command = session.command;
  job.machine = program_and_machine();
  job.other_instruction_sets = options.other_instruction_sets();
  const Study study = load_study(file, session);
  check_new_study(study, job.folder, session);
  tell_blocked_routes(study, session);
  const FolderClaim claim(study, inputs_of_study(file), job.folder);
  run_in_folder(claim, study, std::move(job), "study", session);
  processes.end();
  print(study, options.folder, session);
}

void merge(const StudyArguments& options, Session& session) {
  if (options.folder.empty() || options.words.size() < 2) {
    throw Error("study merge", "give the folders to merge and -o DIR", "");
  }
  check_writable_folder(options.folder);
  merge_studies({options.words.begin() + 1, options.words.end()}, options.folder,
                options.other_instruction_sets(), session);
}

void dispatch(const StudyArguments& options, Session& session) {
  const std::string& first = options.words[0];
  if (first == "status" || first == "merge") refuse_several_processes("study " + first);
  if (first == "status") {
    if (options.words.size() != 2) throw Error("study status", "give one folder", "");
    if (!options.folder.empty() || !options.shard.empty() || options.allow_other_instruction_set) {
      throw Error("study status", "takes neither -o nor --shard nor --allow-other-instruction-set",
                  "leave them out");
    }
    print(open_folder(options.words[1], session), options.words[1], session);
  } else if (first == "merge") {
    merge(options, session);
  } else {
    if (options.words.size() != 1) throw Error("study", "give one study file", "");
    run(options, session);
  }
}

/// Of several processes rank 0 alone says what is wrong, and has the exit code of all: where
/// another ends with an error, mpirun may end rank 0 before it could say so.
void act(const StudyArguments& options, Session& session) {
  if (!silence_other_process()) return dispatch(options, session);
  try {
    dispatch(options, session);
  } catch (const Error&) {  // rank 0 has the same, or was told
  }
}

}  // namespace

void add_study(CLI::App& app, Session& session) {
  auto o = std::make_shared<StudyArguments>();
  CLI::App* verb = add_verb(
      app, session, "study",
      "run, resume and merge studies (Monte Carlo trials) of localisation and other systems",
      "vernier study FILE.toml -o DIR        # run, or resume the study in DIR\n"
      "  vernier study status DIR\n"
      "  vernier study merge DIR1 DIR2 -o DIR");
  verb->add_option("what", o->words, "study file, or: status DIR, or: merge DIR…")->required();
  verb->add_option("-o,--output", o->folder, "output folder");
  verb->add_option("--threads", o->threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  verb->add_option("--shard", o->shard,
                   "run part i of n, such as 0/4 (default: from Slurm's array variables)");
  verb->add_flag("--allow-other-instruction-set", o->allow_other_instruction_set,
                 "accept results of another kind of processor, though not identical to the bit");
  verb->callback([o, &session] { session.action = [=, &session] { act(*o, session); }; });
}

}  // namespace vernier::cli
