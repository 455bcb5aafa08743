// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "tests/support/camera_views.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/python_program.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::localise;

namespace {

using test::error_message;
using test::Folder;

TopologicalMap five_rooms() {
  TopologicalMap map;
  for (int i = 0; i < 5; ++i) {
    map.nodes.push_back({{10.0 * i, 0, 0}, test::view_of(test::random_room(i, 60), 0)});
  }
  return map;
}

LocaliserOptions running(const std::string& command, double time_limit_s = 10) {
  LocaliserOptions options;
  options.command = command;
  options.time_limit_s = time_limit_s;
  return options;
}

/// A program in Python, and what it does with each query.
std::string python(const Folder& folder, const std::string& with_query) {
  const std::string program = test::python_program(test::python_reads_map, with_query);
  return "python3 '" + folder.write("program.py", program).string() + "'";
}

/// Whose fourth answer, and it alone, comes twice, the second time so much later.
std::string says_one_twice(const Folder& folder, const std::string& later_s) {
  return python(folder,
                "said = {'status': 'answered', 'pose': [number, 0, 0]}; say(said); "
                "[time.sleep(" +
                    later_s + "), say(said)] if number == 3 else 0");
}

// A line too many is never taken for the answer to the next question, whenever it comes.
TEST(ProgramLocaliser, MayAnswerAQuestionOnce) {
  const TopologicalMap map = five_rooms();
  for (const std::string later_s : {"0", "0.02", "0.2"}) {
    const Folder folder;
    const auto twice = make_localiser("program", map, running(says_one_twice(folder, later_s)));
    for (int i = 0; i < 8; ++i) {
      const LocalisationAnswer said = twice->localise(map.nodes[0].view);
      if (i == 4) {
        EXPECT_EQ(said.status, LocalisationStatus::failed);
        EXPECT_NE(said.failure.find("more than one line for a question"), std::string::npos)
            << said.failure;
        continue;
      }
      EXPECT_EQ(said.status, LocalisationStatus::answered) << said.failure;
      EXPECT_EQ(said.pose.x_m, i < 4 ? i : i - 5) << later_s;  // it is started again
    }
  }
}

TEST(ProgramLocaliser, WorksAsTheManualSays) {
  const TopologicalMap map = five_rooms();
  const auto localiser = make_localiser(
      "program", map, running("python3 " VERNIER_SOURCE_DIR "/docs/examples/own_localiser.py"));
  double cpu_ms = 0;
  for (int i = 0; i < 5; ++i) {
    const LocalisationAnswer answer = localiser->localise(map.nodes[i].view);
    EXPECT_EQ(answer.status, LocalisationStatus::answered) << answer.failure;
    EXPECT_EQ(answer.node, i);
    EXPECT_EQ(answer.pose.x_m, 10.0 * i);
    EXPECT_GE(answer.program_cpu_ms, 0);
    cpu_ms += answer.program_cpu_ms;
  }
  for (int i = 0; i < 200 && cpu_ms == 0; ++i) {  // until the system has counted a tick
    cpu_ms += localiser->localise(map.nodes[0].view).program_cpu_ms;
  }
  EXPECT_GT(cpu_ms, 0);
  EXPECT_EQ(localiser->localise({}).status, LocalisationStatus::no_match);
}

TEST(ProgramLocaliser, ReadsEveryAnswer) {
  const TopologicalMap map = five_rooms();
  const Folder folder;
  const auto localiser = make_localiser(
      "program", map,
      running(python(folder,
                     "say({'status': ['answered', 'unsure', 'tie', 'unsure'][number], "
                     "**({'pose': [1, 2, 0.5], 'probability': 0.25, 'score': -3, 'node': None, "
                     "'next_turn_rad': 1.5} if number < 2 else {})})")));
  const LocalisationAnswer sure = localiser->localise({}), unsure = localiser->localise({});
  EXPECT_EQ(sure.status, LocalisationStatus::answered) << sure.failure;
  EXPECT_EQ(sure.pose.y_m, 2);
  EXPECT_EQ(sure.node, -1);
  EXPECT_EQ(unsure.status, LocalisationStatus::unsure);
  EXPECT_EQ(unsure.probability, 0.25);
  EXPECT_EQ(unsure.next_turn_rad, 1.5);
  EXPECT_EQ(localiser->localise({}).status, LocalisationStatus::tie);
  EXPECT_EQ(localiser->localise({}).status, LocalisationStatus::no_match);  // no best guess
}

/// What a program does wrong spoils the query, and the next one finds it started again.
TEST(ProgramLocaliser, SurvivesItsProgram) {
  const TopologicalMap map = five_rooms();
  const std::string good = "'{\"status\": \"answered\", \"pose\": [1, 2, 0]}'";
  struct Fault {
    std::string does, says;
  };
  const Fault faults[] = {
      {"sys.exit('lost my way')", "lost my way"},
      {"time.sleep(60)", "no answer within"},
      {"print('hello', flush=True)", "nonsense"},
      {"print(" + good + ", flush=True)",
       "does not repeat the number of its question, \"question\": 1"},
      {"say('{\"question\": 2, \"status\": \"tie\"}')", "is for question \"2\" where 1 was asked"},
      {"say('{\"question\": [1], \"status\": \"tie\"}')", "is for question"},
      {"say('{\"status\": \"lost\"}')", "no status"},
      {"say('{\"status\": \"answered\"}')", "pose"},
      {"say('{\"status\": \"answered\", \"pose\": [1, 2, NaN]}')", "nonsense"},
      {"say('{\"status\": \"answered\", \"pose\": [1, 2, 400]}')", "more than a turn"},
      {"say('{\"status\": \"tie\", \"node\": 5}')", "node"},
      {"say('{\"status\": \"tie\", \"probability\": 2}')", "from 0 to 1"},
      {"os.write(1, b'x' * 20000000)", "16 MB"},
      {"os.kill(os.getpid(), 9)", "ended"},
      {"os.close(1), time.sleep(60)", "ended"},
  };
  for (const Fault& fault : faults) {
    const Folder folder;
    const std::string mark = (folder.path() / "again").string();
    const auto localiser = make_localiser(
        "program", map,
        running(python(folder, "say(" + good + ") if os.path.exists('" + mark + "') else [open('" +
                                   mark + "', 'w').close(), " + fault.does + "]"),
                1.5));
    const LocalisationAnswer spoilt = localiser->localise({});
    EXPECT_EQ(spoilt.status, LocalisationStatus::failed) << fault.does;
    EXPECT_NE(spoilt.failure.find(fault.says), std::string::npos)
        << fault.does << ": " << spoilt.failure;
    EXPECT_EQ(localiser->localise({}).status, LocalisationStatus::answered) << fault.does;
  }
}

TEST(ProgramLocaliser, IsLeftAloneAfterThreeFailures) {
  const TopologicalMap map = five_rooms();
  const Folder folder;
  const std::filesystem::path asked = folder.path() / "asked";
  const auto localiser = make_localiser(
      "program", map,
      running(python(folder, "open('" + asked.string() + "', 'a').write('x'), time.sleep(60)"),
              1.5));
  for (int i = 0; i < 100; ++i) {
    const LocalisationAnswer answer = localiser->localise({});
    EXPECT_EQ(answer.status, LocalisationStatus::failed);
    EXPECT_NE(answer.failure.find("no answer"), std::string::npos);
  }
  const auto times_asked = std::filesystem::exists(asked) ? std::filesystem::file_size(asked) : 0;
  EXPECT_LE(times_asked, 3u);
  EXPECT_GE(times_asked, 1u);
}

TEST(ProgramLocaliser, SaysWhatItDoesWithTheMap) {
  const TopologicalMap map = five_rooms();
  const auto first = [&](const std::string& command) {
    return make_localiser("program", map, running(command))->localise({}).failure;
  };
  EXPECT_NE(first("python3 -c 'print(1)'").find("instead of"), std::string::npos);
  EXPECT_NE(first("false").find("ended"), std::string::npos);
  EXPECT_NE(first("python3 -c 'raise SystemExit(\"no map\")'").find("no map"), std::string::npos);
}

TEST(ProgramLocaliser, RefusesCommandsThatCannotRun) {
  const TopologicalMap map = five_rooms();
  const auto message = [&](const std::string& command) {
    return error_message([&] { make_localiser("program", map, running(command)); });
  };
  EXPECT_NE(message("").find("no command"), std::string::npos);
  EXPECT_NE(message("no-such-program-here --x").find("no-such-program-here"), std::string::npos);
  EXPECT_NE(message("python3 'x").find("unclosed quote"), std::string::npos);
  EXPECT_NE(error_message([&] { make_localiser("program", map, running("true", 0)); }).find("time"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
