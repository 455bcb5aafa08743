// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "calib/error.h"
#include "cli/program/session.h"
#include "cli/simulation/study_folder.h"
#include "sim/study/study_store.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

struct StudyArguments {
  std::vector<std::string> words;  ///< FILE, or status DIR, or merge DIR…
  std::string folder, shard;
  int threads = 0;
};

int environment_number(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  int value = otherwise;
  if (text) std::from_chars(text, text + std::char_traits<char>::length(text), value);
  return value;
}

/// The shard from "i/n" or else from Slurm's array variables; without both, the whole study.
Shard shard_of(const std::string& text) {
  if (text.empty()) {
    const int first = environment_number("SLURM_ARRAY_TASK_MIN", 0);
    return {environment_number("SLURM_ARRAY_TASK_ID", first) - first,
            environment_number("SLURM_ARRAY_TASK_COUNT", 1)};
  }
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, shard.count) : index;
  if (!slash || count.ec != std::errc() || count.ptr != end || shard.count < 1 || shard.index < 0 ||
      shard.index >= shard.count) {
    throw Error("--shard", "\"" + text + "\" is not i/n with 0 <= i < n", "use the form 0/4");
  }
  return shard;
}

void print(const Study& study, const fs::path& folder, Session& session) {
  const StudyResults results = study_results(study, folder);
  session.result(study_json(study, results), study_table(study, results));
}

void run(const StudyArguments& options, Session& session) {
  if (options.folder.empty()) {
    throw Error("study", "no output folder given", "give -o DIR");
  }
  const fs::path file = options.words[0];
  StudyRun job;
  job.folder = options.folder;
  job.threads = options.threads;
  job.shard = shard_of(options.shard);
  job.command = session.command;
  const Study study = load_study(file, session);
  keep_inputs(file, job.folder);
  {
    std::optional<Progress> ceilings, blocks;
    job.ceiling_progress = [&](int done, int total) {
      if (!ceilings) ceilings.emplace(session, "study: world ceiling queries");
      ceilings->update(done, total);
    };
    job.progress = [&](int done, int total) {
      ceilings.reset();
      if (!blocks) blocks.emplace(session, "study: blocks");
      blocks->update(done, total);
    };
    run_study(study, job);
  }
  print(study, job.folder, session);
}

/// Throws Error unless all parts belong to the same study: same settings, world and rig.
void check_parts(const std::vector<fs::path>& parts, const fs::path& target, Session& session) {
  const Study first = open_folder(parts[0], session);
  for (const fs::path& part : parts) {
    if (fs::exists(target) && fs::equivalent(part, target)) {
      throw Error(part.string(), "is also the output folder", "give another -o DIR");
    }
    const Study study = open_folder(part, session);
    bool same = study.world_fingerprint == first.world_fingerprint &&
                study.rig_fingerprint == first.rig_fingerprint &&
                study.file.trials == first.file.trials &&
                study.file.trials_per_block == first.file.trials_per_block &&
                study.file.cells.size() == first.file.cells.size();
    for (std::size_t i = 0; same && i < study.file.cells.size(); ++i) {
      same = study.file.cells[i].settings == first.file.cells[i].settings;
    }
    if (!same) {
      throw Error(part.string(), "is not part of the same study as " + parts[0].string(),
                  "merge only parts of one study");
    }
  }
}

/// Merges the result stores of several folders and reports missing blocks.
void merge(const StudyArguments& options, Session& session) {
  if (options.folder.empty() || options.words.size() < 2) {
    throw Error("study merge", "give the folders to merge and -o DIR", "");
  }
  const fs::path target = options.folder;
  const std::vector<fs::path> parts(options.words.begin() + 1, options.words.end());
  check_parts(parts, target, session);
  std::map<std::pair<std::string, int>, StoredBlock> blocks;
  std::map<std::string, std::string> notes;
  for (const fs::path& part : parts) {
    for (const auto& file : store_files(part)) {
      const StudyStore store(file);
      for (StoredBlock& block : store.blocks()) {
        auto& kept = blocks[{block.cell, block.block}];
        kept = longer_block(std::move(block), std::move(kept), file.string());
      }
      for (const auto& [key, value] : store.notes()) notes[key] = value;
    }
  }
  fs::create_directories(target);
  for (const char* name : {"study.toml", "world.world.toml", "rig.json"}) {
    fs::copy_file(parts[0] / name, target / name, fs::copy_options::overwrite_existing);
  }
  if (fs::exists(parts[0] / "sources.toml")) {
    fs::copy_file(parts[0] / "sources.toml", target / "sources.toml",
                  fs::copy_options::overwrite_existing);
  }
  StudyStore merged(target / "results.sqlite");
  for (const auto& [key, block] : blocks) merged.put(block);
  for (const auto& [key, value] : notes) merged.set_metadata(key, value);
  merged.set_metadata(command_key(session.command), session.command);

  const Study study = open_folder(target, session);
  const StudyResults results = study_results(study, target);
  if (results.blocks_done < results.blocks_total) {
    session.add_trust_warning(fmt::format("{} of {} blocks are missing from the merged study",
                                          results.blocks_total - results.blocks_done,
                                          results.blocks_total));
  }
  session.result(study_json(study, results), study_table(study, results));
}

void dispatch(const StudyArguments& options, Session& session) {
  const std::string& first = options.words[0];
  if (first == "status") {
    if (options.words.size() != 2) throw Error("study status", "give one folder", "");
    print(open_folder(options.words[1], session), options.words[1], session);
  } else if (first == "merge") {
    merge(options, session);
  } else {
    if (options.words.size() != 1) throw Error("study", "give one study file", "");
    run(options, session);
  }
}

}  // namespace

void add_study(CLI::App& app, Session& session) {
  auto o = std::make_shared<StudyArguments>();
  CLI::App* verb = add_verb(
      app, session, "study", "run, resume and merge localisation studies (Monte Carlo trials)",
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
  verb->callback([o, &session] { session.action = [=, &session] { dispatch(*o, session); }; });
}

}  // namespace vernier::cli
