// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Each function adds one verb to the program: its options, its example and its action.
void add_doctor(CLI::App& app, Session& session);
void add_detect(CLI::App& app, Session& session);
void add_match(CLI::App& app, Session& session);
void add_calibrate(CLI::App& app, Session& session);
void add_combine(CLI::App& app, Session& session);
void add_check(CLI::App& app, Session& session);
void add_uncertainty(CLI::App& app, Session& session);
void add_sample(CLI::App& app, Session& session);
void add_convert(CLI::App& app, Session& session);
void add_diff(CLI::App& app, Session& session);
void add_advise(CLI::App& app, Session& session);
void add_plan(CLI::App& app, Session& session);
void add_rectify(CLI::App& app, Session& session);
void add_stereo(CLI::App& app, Session& session);
void add_evaluate(CLI::App& app, Session& session);
void add_characterise(CLI::App& app, Session& session);
void add_world(CLI::App& app, Session& session);
void add_simulate(CLI::App& app, Session& session);
void add_drive(CLI::App& app, Session& session);
void add_servo(CLI::App& app, Session& session);
void add_render(CLI::App& app, Session& session);
void add_study(CLI::App& app, Session& session);
void add_tune(CLI::App& app, Session& session);
void add_export(CLI::App& app, Session& session);
void add_lines(CLI::App& app, Session& session);
void add_map(CLI::App& app, Session& session);
void add_localise(CLI::App& app, Session& session);
void add_odometry(CLI::App& app, Session& session);
void add_report(CLI::App& app, Session& session);

}  // namespace vernier::cli
