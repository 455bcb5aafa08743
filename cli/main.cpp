// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/error.h"
#include "cli/program/session.h"
#include "cli/verbs.h"

namespace {

/// The message for arguments that belong to no option. An unquoted pattern is expanded by the
/// shell.
std::string not_expected(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining(true);
  if (words.empty()) return "unexpected argument";
  std::string text = "unexpected argument \"" + words.front() + "\"";
  if (words.size() == 1) return text;
  text += fmt::format(" and {} more", words.size() - 1);
  const bool images = std::all_of(words.begin(), words.end(), [](const std::string& word) {
    return word.front() != '-' && std::filesystem::path(word).has_extension();
  });
  return images ? text + "; quote the pattern, for example 'left*.png'" : text;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace vernier;
  FLAGS_minloglevel = google::GLOG_FATAL;  // Ceres' messages repeat our results and errors
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
  cli::add_rectify(app, session);
  cli::add_stereo(app, session);
  cli::add_evaluate(app, session);
  cli::add_characterise(app, session);
  cli::add_world(app, session);
  cli::add_simulate(app, session);
  cli::add_study(app, session);
  cli::add_report(app, session);
  try {
    app.parse(argc, argv);
    if (!session.action) {
      fmt::print(stderr, "vernier: no verb given (see vernier --help)\n");
      return static_cast<int>(cli::Exit::bad_input);
    }
    session.action();
  } catch (const CLI::Success& done) {  // --help, --version
    return app.exit(done);
  } catch (const CLI::ExtrasError& error) {
    fmt::print(stderr, "vernier: {} (see vernier --help)\n", not_expected(app));
    return static_cast<int>(cli::Exit::bad_input);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "vernier: {} (see vernier --help)\n", error.what());
    return static_cast<int>(cli::Exit::bad_input);
  } catch (const Error& error) {
    fmt::print(stderr, "vernier: {}\n", error.what());
    return static_cast<int>(cli::Exit::bad_input);
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "vernier: {}: {}; check the path and its permissions\n",
               error.path1().string(), error.code().message());
    return static_cast<int>(cli::Exit::bad_input);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vernier: internal error: {}\n", error.what());
    return static_cast<int>(cli::Exit::internal_error);
  }
  return static_cast<int>(session.exit_code());
}
