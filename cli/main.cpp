// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <opencv2/core/utils/logger.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "cli/program/ending_signals.h"
#include "cli/program/memory_end.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/streams.h"
#include "cli/program/unexpected_words.h"
#include "cli/verbs.h"
#include "sim/image_systems/matcher_system.h"
#include "sim/mpi/mpi_launch.h"
#include "sim/study/system_kind.h"
#include "sim/systems/systems.h"

namespace {

/// What studies can try besides localisers.
void register_all_systems() {
  vernier::sim::internal::register_systems();
  register_system(vernier::sim::internal::matcher_kind());
}

/// The words of the command line, last one first, as CLI11 takes them. Help is given whatever else
/// is on the line, which CLI11 would check first: then only the verb is left.
std::vector<std::string> words_of(const CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> all(argv + 1, argv + argc);
  const auto end = std::find(all.begin(), all.end(), "--");
  const auto is_help = [](const std::string& word) { return word == "--help" || word == "-h"; };
  if (std::none_of(all.begin(), end, is_help)) return {all.rbegin(), all.rend()};
  std::vector<std::string> words{"--help"};
  const CLI::App* verb = &app;
  for (auto word = all.begin(); word != end; ++word) {
    const auto named =
        verb->get_subcommands([&](const CLI::App* other) { return other->get_name() == *word; });
    if (named.empty() && word->starts_with('-')) continue;
    if (named.empty()) break;
    verb = named.front();
    words.insert(words.begin() + 1, *word);
  }
  return words;
}

/// Parses the command line and does what it says.
void perform(CLI::App& app, vernier::cli::Session& session, int argc, char** argv) {
  try {
    app.parse(words_of(app, argc, argv));
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    app.exit(asked, text, text);
    vernier::cli::print_result(text.str());
    return;
  }
  vernier::cli::refuse_empty_values(app);
  if (!session.action) throw CLI::ParseError("no verb given", CLI::ExitCodes::RequiredError);
  session.action();
  session.tell_trust_warnings();
}

/// Ceres' and OpenCV's messages repeat our results and errors.
void silence_libraries() {
  FLAGS_minloglevel = google::GLOG_FATAL;
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  std::cerr.rdbuf(nullptr);  // nothing of ours writes to it
}

int bad_input(const std::string& line) {
  vernier::cli::say(vernier::internal::printable("vernier: " + line) + "\n");
  return static_cast<int>(vernier::cli::Exit::bad_input);
}

std::string line_of(const std::filesystem::filesystem_error& error) {
  const std::string file = (error.path1().empty() ? error.path2() : error.path1()).string();
  return (file.empty() ? std::string(error.what()) : file + ": " + error.code().message()) +
         "; check the path and its permissions";
}

}  // namespace

int main(int argc, char** argv) {
  using namespace vernier;
  cli::open_missing_streams();
  const auto launch = sim::internal::mpi_launch();
  cli::watch_ending_signals(launch && launch->rank > 0);
  cli::watch_memory();
  silence_libraries();
  register_all_systems();
  cli::Session session;
  session.command = cli::command_line(argc, argv);
  CLI::App app{
      "Vernier: stereo calibration uncertainty and its effect on matching and localisation.\n"
      "Calibrate a rig, sample from its covariance, and simulate localisation with the samples."};
  app.name("vernier");
  app.set_version_flag("--version", "vernier " VERNIER_VERSION);
  app.require_subcommand(0, 1);
  app.footer(
      "Example:\n"
      "  vernier calibrate --left 'left*.png' --right 'right*.png' --board 9x6 --square-m 0.025 "
      "-o rig.json\n"
      "Each verb's --help has an example. Exit codes: 0 success, 1 internal error, 2 bad usage or "
      "input,\n3 result not trustworthy.");
  cli::add_doctor(app, session);
  cli::add_detect(app, session);
  cli::add_match(app, session);
  cli::add_calibrate(app, session);
  cli::add_combine(app, session);
  cli::add_check(app, session);
  cli::add_uncertainty(app, session);
  cli::add_sample(app, session);
  cli::add_convert(app, session);
  cli::add_diff(app, session);
  cli::add_advise(app, session);
  cli::add_plan(app, session);
  cli::add_rectify(app, session);
  cli::add_stereo(app, session);
  cli::add_evaluate(app, session);
  cli::add_characterise(app, session);
  cli::add_world(app, session);
  cli::add_simulate(app, session);
  cli::add_drive(app, session);
  cli::add_servo(app, session);
  cli::add_render(app, session);
  cli::add_study(app, session);
  cli::add_tune(app, session);
  cli::add_export(app, session);
  cli::add_lines(app, session);
  cli::add_map(app, session);
  cli::add_localise(app, session);
  cli::add_odometry(app, session);
  cli::add_report(app, session);
  cli::check_numbers(app);
  try {
    perform(app, session, argc, argv);
  } catch (const CLI::ParseError& error) {
    return bad_input(cli::usage_fault(app, error));
  } catch (const Error& error) {
    return bad_input(error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return bad_input(line_of(error));
  } catch (const std::exception& error) {
    if (cli::is_out_of_memory(error)) return bad_input(cli::out_of_memory);
    cli::say(internal::printable(std::string("vernier: internal error: ") + error.what()) + "\n");
    return static_cast<int>(cli::Exit::internal_error);
  }
  return static_cast<int>(session.exit_code());
}
