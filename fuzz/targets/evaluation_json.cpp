// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cli/program/session.h"
#include "cli/report/report_evaluation.h"
#include "cli/stereo/evaluate_figures.h"
#include "fuzz/fuzz_target.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::fuzz {
namespace {

using vernier::cli::Json;

void run_evaluation_json(std::string_view bytes) {
  input_file("no picture", "teddy.png");
  input_file(bytes, cli::evaluation_file);
  const auto json = accepted([&] { return cli::report_evaluation(input_folder()); });
  const auto files = accepted([&] { return cli::evaluation_files(input_folder()); });
  if (!json || !files) return;
  require(files->front().filename() == cli::evaluation_file, "the files begin with the evaluation");
  json->dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The form of what `evaluate -o` writes.
std::vector<std::string> evaluation_json_seeds() {
  const Json scene{{"name", "teddy"},
                   {"matchers", {{"edge", {{"density", 0.5}, {"median_px", 0.25}}}}},
                   {"pictures", {{"disparity", "teddy.png"}, {"error", "teddy.png"}}}};
  const Json whole{{"matchers", {{"edge", {{"density", 0.5}}}}}, {"scenes", {scene, scene}}};
  return {whole.dump(), whole.dump(1)};
}

const Registered registered_evaluation_json{
    {"evaluation_json", 4000, "json", run_evaluation_json, evaluation_json_seeds}};

}  // namespace
}  // namespace vernier::fuzz
