// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <set>
#include <system_error>
#include <tuple>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/error_place.h"
#include "calib/base/fingerprint.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/observations_file.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "sim/experiment.h"
#include "sim/study/idle_settings.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/told_settings.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* sources_name = "sources.toml";

enum class InputRole { world, rig, told, corners };

/// A file that a study names, and the name of its copy in the folder of results.
struct StudyInput {
  InputRole role;
  std::string named, copy;
};

std::string numbered(const std::string& stem, std::size_t i, const std::string& ending) {
  return stem + (i == 0 ? "" : "-" + std::to_string(i + 1)) + ending;
}

std::string observations_of(const StudyFile& study) {
  return study.cells[0].told.observations;  // not swept
}

std::vector<StudyInput> named_files(const StudyFile& study) {
  std::vector<StudyInput> inputs;
  const std::vector<std::string> worlds = worlds_of(study), told = told_rigs_of(study);
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    inputs.push_back({InputRole::world, worlds[i], numbered("world", i, ".world.toml")});
  }
  inputs.push_back({InputRole::rig, study.rig, "rig.json"});
  for (std::size_t i = 0; i < told.size(); ++i) {
    inputs.push_back({InputRole::told, told[i], numbered("told", i, ".json")});
  }
  if (const std::string corners = observations_of(study); !corners.empty()) {
    const bool in_rig = corners.ends_with(".json");
    inputs.push_back({InputRole::corners, corners, in_rig ? "corners.json" : "corners.vnl"});
  }
  return inputs;
}

/// Where the study names it.
std::string place_of(const StudyInput& input, const StudyFile& study) {
  switch (input.role) {
    case InputRole::world:
      return place_of(study, "world.file");
    case InputRole::rig:
      return place_of(study, study.cells[0].told.truth.empty() ? "rig.file" : "rig.truth");
    case InputRole::told:
      return place_of(study, "rig.file");
    case InputRole::corners:
      break;
  }
  return place_of(study, "calibration.observations");
}

/// The file itself, beside the study file.
fs::path found_file(const StudyInput& input, const fs::path& beside) {
  if (input.role == InputRole::world) return find_world(input.named, beside);
  if (input.role != InputRole::corners) return find_rig(input.named, beside);
  const fs::path file = beside / input.named;
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) {
    throw Error(input.named, "no such file of corners",
                "give calibration.observations relative to the study file");
  }
  return file;
}

fs::path file_of(const StudyInput& input, const StudyFile& study, const fs::path& beside) {
  return with_errors_of(place_of(input, study), [&] { return found_file(input, beside); });
}

/// Throws Error for a route without or with too many views, before anything is written.
void check_maps(const Study& study) {
  std::set<std::tuple<std::string, double, int>> checked;
  for (const StudyCell& cell : study.file.cells) {
    const ExperimentSettings& settings = cell.experiment;
    if (!checked.emplace(cell.world, settings.map_spacing_m, settings.map_headings).second) {
      continue;
    }
    map_poses(world_of(study, cell).route, settings.map_spacing_m, settings.map_headings);
  }
}

/// The corners of a rig file's evidence, or of a corners file of the study's board.
BoardObservations read_real_corners(const fs::path& file,
                                    const std::string& named,
                                    const Study& study) {
  if (named.ends_with(".json")) {
    RigFile calibrated = read_rig(file);
    if (!calibrated.estimate.evidence || calibrated.estimate.evidence->observations.views.empty()) {
      throw Error(named, "the file has no board views",
                  "give one written by vernier calibrate, with its evidence, or a corners file");
    }
    return std::move(calibrated.estimate.evidence->observations);
  }
  std::vector<Eigen::Vector2i> sizes;
  for (const Camera& camera : study.rig.rig.cameras) sizes.push_back(camera.size_px);
  BoardObservations corners =
      read_corners(file, study.file.cells[0].told.calibration->board, sizes);
  check_and_sort(corners);
  return corners;
}

StudyRig load_rig(const fs::path& file, Session& session) {
  const std::string text = read_whole(file);
  RigFile rig = parse_rig(text, file.string());
  for (const std::string& warning : rig.warnings) session.warn(warning);
  return {std::move(rig.estimate), fingerprint(text)};
}

void load(const StudyInput& input, const fs::path& file, Study& study, Session& session) {
  if (input.role == InputRole::world) {
    const std::string text = read_whole(file);
    World world = build_world(parse_world(text, file.string()));
    if (input.named == study.file.world) {
      study.world = std::move(world);
      study.world_fingerprint = fingerprint(text);
    } else {
      study.other_worlds[input.named] = {std::move(world), fingerprint(text)};
    }
  } else if (input.role == InputRole::rig) {
    StudyRig rig = load_rig(file, session);
    if (const std::size_t cameras = rig.estimate.rig.cameras.size(); cameras != 2) {
      throw Error(place_of(input, study.file),
                  fmt::format("{} is a rig of {} camera{}", file.string(), cameras,
                              cameras == 1 ? "" : "s"),
                  "name a rig of two cameras, as studies simulate pairs of images");
    }
    study.rig = std::move(rig.estimate);
    study.rig_fingerprint = std::move(rig.fingerprint);
  } else if (input.role == InputRole::told) {
    study.told_rigs[input.named] = load_rig(file, session);
  } else {
    study.corners_fingerprint = fingerprint(read_whole(file));
    study.corners =
        std::make_shared<const BoardObservations>(read_real_corners(file, input.named, study));
  }
}

/// Throws Error at the line of rig.file for a rig to draw from that has no covariance.
void check_covariances(const Study& study) {
  for (const StudyCell& cell : study.file.cells) {
    const ToldSettings& told = cell.told;
    if (!(cell.experiment.sources.calibration > 0) || told.calibration) continue;
    const bool is_truth = told.truth.empty();
    if (!is_truth && told.error == ToldSettings::Error::given) continue;
    const RigEstimate& rig = is_truth ? study.rig : study.told_rigs.at(told.file).estimate;
    if (rig.covariance) continue;
    throw Error(place_of(study.file, "rig.file"),
                fmt::format("{} has no covariance to draw what is told of the rig from",
                            is_truth ? study.file.rig : told.file),
                is_truth ? "calibrate it with vernier calibrate, or set sources.calibration = 0: "
                           "it is then told exactly"
                         : "calibrate it with vernier calibrate, or set rig.error = \"given\": its "
                           "difference from rig.truth, times sources.calibration, is then told");
  }
}

enum class WithRig { yes, no };

template <class FileOf>
Study assemble(StudyFile file, Session& session, FileOf file_of_input, WithRig with_rig) {
  Study study;
  study.file = std::move(file);
  for (const StudyInput& input : named_files(study.file)) {
    if (input.role == InputRole::rig && with_rig == WithRig::no) continue;
    load(input, file_of_input(input), study, session);
  }
  if (study.file.cells[0].system.is_localiser()) check_maps(study);
  if (system_of(study.file).uses_opencv) cv::setNumThreads(1);  // as evaluate
  return study;
}

/// The study of a file, its inputs in the folder `beside`.
Study assemble_beside(const StudyFile& study,
                      const fs::path& beside,
                      Session& session,
                      WithRig with_rig) {
  const auto file = [&](const StudyInput& input) { return file_of(input, study, beside); };
  return assemble(study, session, file, with_rig);
}

}  // namespace

StudyInputs inputs_of_study(const fs::path& study_file) {
  return inputs_of_study(read_whole(study_file), study_file);
}

StudyInputs inputs_of_study(const std::string& text, const fs::path& place) {
  const StudyFile study = parse_study(text, place.string());
  StudyInputs inputs;
  for (const StudyInput& input : named_files(study)) {
    inputs.emplace_back(input.copy, read_whole(file_of(input, study, place.parent_path())));
  }
  if (!study.sources.empty()) inputs.emplace_back(sources_name, read_whole(study.sources));
  inputs.emplace_back(study_copy, text);  // last: it makes the folder a study's
  return inputs;
}

std::vector<fs::path> input_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const StudyInput& input :
       named_files(read_study(folder / study_copy, folder / sources_name))) {
    files.push_back(folder / input.copy);
  }
  std::error_code unknown;
  if (fs::exists(folder / sources_name, unknown)) files.push_back(folder / sources_name);
  files.push_back(folder / study_copy);
  return files;
}

StudyInputs inputs_of_folder(const fs::path& folder) {
  StudyInputs inputs;
  for (const fs::path& file : input_files(folder)) {
    inputs.emplace_back(file.filename().string(), read_whole(file));
  }
  return inputs;
}

Study load_study(const fs::path& file, Session& session) {
  return load_study(read_whole(file), file, session);
}

Study load_study(const std::string& text, const fs::path& place, Session& session) {
  Study study = assemble_beside(parse_study(text, place.string()), place.parent_path(), session,
                                WithRig::yes);
  check_covariances(study);
  return study;
}

Study load_inputs_without_rig(const StudyFile& study, const fs::path& beside, Session& session) {
  return assemble_beside(study, beside, session, WithRig::no);
}

void check_new_study(const Study& study, const fs::path& folder, Session& session) {
  std::error_code unknown;
  if (fs::exists(folder / study_copy, unknown)) return;
  std::map<std::string, std::vector<std::string>> idle;  // sources by reason
  for (IdleSource& source : check_settings_act(study)) {
    idle[source.reason].push_back(std::move(source.key));
  }
  for (const auto& [reason, keys] : idle) {
    session.warn(fmt::format("{}: {} {} no effect: {}", place_of(study.file, keys[0]),
                             fmt::join(keys, ", "), keys.size() == 1 ? "has" : "have", reason));
  }
}

Study open_folder(const fs::path& folder, Session& session) {
  if (!fs::is_regular_file(folder / study_copy)) {
    throw Error(folder.string(), "is not a study folder",
                "give a folder written by vernier study -o");
  }
  const auto file = [&](const StudyInput& input) { return folder / input.copy; };
  Study study =
      assemble(read_study(folder / study_copy, folder / sources_name), session, file, WithRig::yes);
  check_covariances(study);
  return study;
}

}  // namespace vernier::cli
