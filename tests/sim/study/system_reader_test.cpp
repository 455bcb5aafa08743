// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The tables [system] and [parameters] of a study file.
#include <gtest/gtest.h>

#include <string>

#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/systems/systems.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::sim::internal;

namespace {

std::string system_complaint(const std::string& text) {
  register_systems();
  return test::error_message([&] { parse_study("[study]\ntrials = 60\n" + text, "s.toml"); });
}

void expect_complaint(const std::string& text, const std::string& about) {
  const std::string complaint = system_complaint(text);
  EXPECT_NE(complaint.find(about), std::string::npos) << text << "\n" << complaint;
}

TEST(SystemReader, AStudyWithoutItTriesLocalisers) {
  register_systems();
  const StudyFile study = parse_study("[study]\n", "s.toml");
  EXPECT_TRUE(study.cells[0].system.is_localiser());
  EXPECT_EQ(system_of(study).name, "localiser");
  for (const auto& [key, value] : study.cells[0].settings) {
    if (key == "system.success_error") {
      EXPECT_EQ(value, "1");
    } else {
      EXPECT_NE(key.substr(0, 7), "system.") << key;
    }
  }
}

TEST(SystemReader, ALimitAloneIsALocalisers) {
  register_systems();
  const StudyFile study = parse_study("[study]\n[system]\nsuccess_error = 0.3\n", "s.toml");
  EXPECT_TRUE(study.cells[0].system.is_localiser());
  EXPECT_EQ(study.cells[0].system.success_error, 0.3);
  const StudyFile swept =
      parse_study("[study]\n[sweep]\n\"system.success_error\" = [0.1, 1]\n", "s.toml");
  EXPECT_EQ(swept.cells[1].settings.at("system.success_error"), "1");
  expect_complaint("[system]\nsuccess_error = 0.3\nrange_m = 4\n", "'name'");
}

TEST(SystemReader, HasTheSettingsOfItsKindOnly) {
  register_systems();
  const StudyFile study = parse_study(
      "[study]\ntrials = 60\n[system]\nname = \"servoing\"\ndistance_m = 2\n"
      "[sources]\nedge_loss = 0.2\n",
      "s.toml");
  const StudyCell& cell = study.cells[0];
  EXPECT_EQ(cell.system.number("distance_m"), 2);
  EXPECT_EQ(cell.system.text("goal"), "taught");
  EXPECT_EQ(cell.settings.at("system.distance_m"), "2");
  EXPECT_EQ(cell.settings.at("sources.edge_loss"), "0.2");
  EXPECT_EQ(cell.settings.count("localiser.method"), 0U);
  EXPECT_EQ(cell.settings.count("map.spacing_m"), 0U);
  EXPECT_EQ(cell.settings.count("study.protocol"), 0U);
  EXPECT_EQ(study.trials_per_block, 2);
}

TEST(SystemReader, ParametersKeepTheirTypesAndAreSwept) {
  register_systems();
  const StudyFile study = parse_study(
      "[study]\n[system]\nname = \"program\"\ncommand = \"./p\"\nsuccess_error = 1\n"
      "measured = [\"a\", \"b_m\"]\n[parameters]\nmode = \"fast\"\non = true\n[sweep]\n"
      "\"parameters.gain\" = [1, 2.5]\n",
      "s.toml");
  ASSERT_EQ(study.cells.size(), 2U);
  EXPECT_EQ(study.cells[1].system.parameters.at("gain"), "2.5");
  EXPECT_EQ(study.cells[1].system.parameters.at("mode"), "\"fast\"");
  EXPECT_EQ(study.cells[1].system.parameters.at("on"), "true");
  EXPECT_EQ(study.cells[1].settings.at("parameters.mode"), "fast");
  EXPECT_EQ(study.cells[0].settings.at("system.measured"), "a, b_m");
}

// What a program is told must differ where the settings do: they are the keys of stored results.
TEST(SystemReader, ATextIsNoNumberAndNoBoolean) {
  register_systems();
  const auto shown = [](const std::string& value) {
    const StudyFile study = parse_study(
        "[study]\n[system]\nname = \"program\"\ncommand = \"./p\"\nsuccess_error = 1\n"
        "[parameters]\na = " +
            value + "\n",
        "s.toml");
    return study.cells[0].settings.at("parameters.a");
  };
  EXPECT_EQ(shown("1"), "1");
  EXPECT_EQ(shown("\"1\""), "\"1\"");
  EXPECT_EQ(shown("true"), "true");
  EXPECT_EQ(shown("\"true\""), "\"true\"");
  EXPECT_EQ(shown("1e300"), "1e+300");
  EXPECT_EQ(shown("\"1e+300\""), "\"1e+300\"");
  EXPECT_EQ(shown("'\"1\"'"), R"("\"1\"")");
  EXPECT_EQ(shown("\"fast\""), "fast");
}

TEST(SystemReader, RefusesWhatIsNone) {
  expect_complaint("[system]\n", "'name'");
  expect_complaint("[system]\nname = \"calibrations\"\n", "s.toml:4: unknown system");
  expect_complaint("[system]\nname = \"calibration\"\nrange = 3\n", "range_m");
  expect_complaint("[system]\nname = \"calibration\"\nrange_m = -3\n",
                   "s.toml:5: system.range_m = -3 is out of range");
  expect_complaint("[system]\nname = \"calibration\"\nsuccess_error = 0\n", "not above 0");
  expect_complaint("[system]\nname = \"calibration\"\nsuccess_error = nan\n", "s.toml:5");
  expect_complaint("[system]\nname = \"localiser\"\nsuccess_error = 2\n", "s.toml:5");
  expect_complaint("[system]\nname = \"localiser\"\nsuccess_error = 1.01\n", "is above 1 m");
  expect_complaint("[system]\nname = \"servoing\"\ngoal = \"here\"\n",
                   "use taught, recorded or model");
  expect_complaint("[system]\nname = \"servoing\"\ndoor = \"\"\n", "system.door is empty");
  expect_complaint("[system]\nname = \"program\"\nsuccess_error = 1\n", "'command'");
  expect_complaint("[system]\nname = \"program\"\ncommand = \"./p\"\n", "'success_error'");
  expect_complaint("[system]\nname = \"program\"\ncommand = \"./p 'x\"\nsuccess_error = 1\n",
                   "s.toml:5: system.command has an");
  const std::string program =
      "[system]\nname = \"program\"\ncommand = \"./p\"\nsuccess_error = 1\n";
  expect_complaint("[system]\nname = \"program\"\ncommand = \" \"\nsuccess_error = 1\n",
                   "s.toml:5: system.command is empty");
  expect_complaint(program + "measured = [\"a\", \"a\"]\n", "twice");
  expect_complaint(program + "measured = [\"error\"]\n", "is no name of what is measured");
  expect_complaint(program + "measured = [\"Über\"]\n", "is no name of what is measured");
  expect_complaint(program + "[parameters]\na = [1]\n", "s.toml:8: parameters.a is neither");
}

TEST(SystemReader, RefusesWhatHasNoEffect) {
  const std::string calibration = "[system]\nname = \"calibration\"\n";
  expect_complaint(calibration + "[map]\nspacing_m = 1\n", "[map] has no effect on a calibration");
  expect_complaint(calibration + "[sources]\ncalibration = 1\n", "[sources] has no effect");
  expect_complaint(calibration + "[one_at_a_time]\n", "[one_at_a_time] has no effect");
  expect_complaint(calibration + "[sweep]\n\"sources.edge_loss\" = [0, 1]\n", "has no effect");
  expect_complaint(calibration + "[rig]\nfile = \"a\"\ntruth = \"b\"\n", "rig.truth has no effect");
  expect_complaint("[system]\nname = \"servoing\"\n[calibration]\n", "[calibration] has no effect");
  expect_complaint(calibration + "[sweep]\n\"sources.edge_loss\" = [0, 0.1]\n",
                   "sources.edge_loss has no effect on a calibration");
  expect_complaint("[sweep]\n\"histogram.blur\" = [\"fixed\"]\n",
                   "'histogram.blur' cannot be swept; did you mean 'histograms.blur'?");
  expect_complaint("[parameters]\na = 1\n", "[parameters] has no effect on a localiser");
  EXPECT_NE(test::error_message([] {
              parse_study("[study]\nprotocol = \"path\"\n[system]\nname = \"servoing\"\n",
                          "s.toml");
            }).find("s.toml:2: study.protocol has no effect on a servoing robot"),
            std::string::npos);
  expect_complaint(
      "[system]\nname = \"program\"\ncommand = \"./p\"\nsuccess_error = 1\n[sources]\n"
      "edge_loss = 0.1\n",
      "s.toml:8: sources.edge_loss has no effect on a program");
}

TEST(SystemReader, ItsKindIsTheSameInAllCells) {
  expect_complaint("[sweep]\n\"system.name\" = [\"localiser\", \"servoing\"]\n", "cannot be swept");
  expect_complaint(
      "[system]\nname = \"program\"\ncommand = \"./p\"\nsuccess_error = 1\n[sweep]\n"
      "\"system.measured\" = [\"a\", \"b\"]\n",
      "cannot be swept");
}

}  // namespace
}  // namespace vernier
