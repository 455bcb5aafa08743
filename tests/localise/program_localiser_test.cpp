// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "tests/support/camera_views.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
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

/// A program in Python: what it does before it is ready, and with each query.
std::string python(const Folder& folder, const std::string& with_query) {
  const std::string program =
      "import json, sys, os, time\n"
      "n = json.loads(sys.stdin.readline())['nodes']\n"
      "nodes = [json.loads(sys.stdin.readline()) for _ in range(n)]\n"
      "print('{\"ready\": true}', flush=True)\n"
      "for number, line in enumerate(sys.stdin):\n"
      "    " +
      with_query + "\n";
  return "python3 '" + folder.write("program.py", program).string() + "'";
}

// A second line would be taken for the answer to the next question.
TEST(ProgramLocaliser, MayPrintOneLineForAQuestion) {
  const TopologicalMap map = five_rooms();
  const Folder folder;
  const std::string line = R"('{"status": "unsure"}')";
  const auto twice = make_localiser(
      "program", map,
      running(python(folder, "print(" + line + " + chr(10) + " + line + ", flush=True)")));
  for (int i = 0; i < 2; ++i) {
    const LocalisationAnswer said = twice->localise(map.nodes[i].view);
    EXPECT_EQ(said.status, LocalisationStatus::failed);
    EXPECT_NE(said.failure.find("prints more than one line for a question"), std::string::npos)
        << said.failure;
  }
}

// Also if it comes late.
TEST(ProgramLocaliser, MayPrintNothingUnasked) {
  const TopologicalMap map = five_rooms();
  const Folder folder;
  const std::filesystem::path told = folder.path() / "told";
  const auto late = make_localiser(
      "program", map,
      running(python(folder, R"(print('{"status": "unsure"}', flush=True); time.sleep(0.2); )"
                             R"(print('{"status": "unsure"}', flush=True); open(')" +
                                 told.string() + R"(', 'w').close())")));
  EXPECT_NE(late->localise(map.nodes[0].view).status, LocalisationStatus::failed);
  for (int wait = 0; wait < 600 && !std::filesystem::exists(told); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const LocalisationAnswer said = late->localise(map.nodes[1].view);
  EXPECT_EQ(said.status, LocalisationStatus::failed);
  EXPECT_NE(said.failure.find("prints more than one line"), std::string::npos) << said.failure;
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
                     "print(json.dumps({'status': ['answered', 'unsure', 'tie', 'unsure'][number], "
                     "**({'pose': [1, 2, 0.5], 'probability': 0.25, 'score': -3, 'node': None, "
                     "'next_turn_rad': 1.5} if number < 2 else {})}), flush=True)")));
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
      {"print('{\"status\": \"lost\"}', flush=True)", "no status"},
      {"print('{\"status\": \"answered\"}', flush=True)", "pose"},
      {"print('{\"status\": \"answered\", \"pose\": [1, 2, NaN]}', flush=True)", "nonsense"},
      {"print('{\"status\": \"answered\", \"pose\": [1, 2, 400]}', flush=True)",
       "more than a turn"},
      {"print('{\"status\": \"tie\", \"node\": 5}', flush=True)", "node"},
      {"print('{\"status\": \"tie\", \"probability\": 2}', flush=True)", "from 0 to 1"},
      {"os.write(1, b'x' * 20000000)", "16 MB"},
      {"os.kill(os.getpid(), 9)", "ended"},
      {"os.close(1), time.sleep(60)", "ended"},
  };
  for (const Fault& fault : faults) {
    const Folder folder;
    const std::string mark = (folder.path() / "again").string();
    const auto localiser = make_localiser(
        "program", map,
        running(
            python(folder, "print(" + good + ", flush=True) if os.path.exists('" + mark +
                               "') else [open('" + mark + "', 'w').close(), " + fault.does + "]"),
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
