// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/store_lock.h"
#include "sim/study/store_rows.h"
#include "sim/study/study_keys.h"
#include "sim/told/fresh_calibrations.h"
#include "tests/sim/study/stored_example.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

class Store : public testing::Test {
 protected:
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      all[entry.path().filename().string()] = read_whole(entry.path());
    }
    return all;
  }

  template <class Act>
  static std::string refusal(Act act) {
    try {
      act();
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was refused";
  }

  /// Runs SQL on a file, as a user of SQLite or damage might.
  static void sql(const std::filesystem::path& file, const std::string& text) {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(db, text.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(db);
    sqlite3_close(db);
  }

  /// Writes two blocks in another process, which ends as if it were killed.
  static void write_and_die(const std::filesystem::path& file, Journal journal) {
    const pid_t child = ::fork();
    if (child == 0) {
      StudyStore store(file, journal);
      store.put(test::example_block("cell", 0));
      store.put(test::example_block("cell", 1));
      ::_exit(0);
    }
    ASSERT_GT(child, 0);
    ::waitpid(child, nullptr, 0);
  }

  test::TestFolder folder_{"store"};
};

TEST_F(Store, BlocksRoundTripToTheBit) {
  TrialResult t;
  t.trial = 7;
  t.truth = {1.0 / 3, -2.0 / 7, 0.1};
  t.status = LocalisationStatus::too_few_lines;
  t.error = std::nan("");
  t.score = 1e-17;
  t.looks = 3;
  t.probability = 1.0 / 3;
  {
    StudyStore store(folder_ / "a.sqlite");
    store.put({"cell", 3, {t}});
    store.set_note("k", "v");
  }
  const StoreContent again = read_store(folder_ / "a.sqlite");
  ASSERT_EQ(again.blocks.size(), 1u);
  EXPECT_EQ(again.blocks[0].block, 3);
  EXPECT_EQ(again.blocks[0].trials[0].truth.x_m, 1.0 / 3);
  EXPECT_EQ(again.blocks[0].trials[0].score, 1e-17);
  EXPECT_EQ(again.blocks[0].trials[0].looks, 3);
  EXPECT_EQ(again.blocks[0].trials[0].probability, 1.0 / 3);
  EXPECT_TRUE(std::isnan(again.blocks[0].trials[0].error));
  EXPECT_EQ(again.notes.at("k"), "v");
  EXPECT_EQ(again.notes.count("none"), 0u);
}

TEST_F(Store, TrialsOfOtherSystemsRoundTripToTheBit) {
  TrialResult t;
  t.trial = 7;
  t.status = LocalisationStatus::failed;
  t.error = std::nan("");
  t.limit = 1.0 / 7;
  t.measured = {1.0 / 3, std::nan(""), -0.0};
  t.failure = std::string(199, 'x') + "\u00e4\xff";  // cut off within a character
  TrialResult bare = t;
  bare.trial = 8;
  bare.status = LocalisationStatus::answered;
  bare.error = 1.0 / 9;
  bare.measured.emplace();
  bare.failure.clear();
  const auto read = parse_trials(trials_text({t, bare}), "store");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].limit, 1.0 / 7);
  ASSERT_TRUE(read[0].measured && read[0].measured->size() == 3);
  EXPECT_EQ(read[0].measured->at(0), 1.0 / 3);
  EXPECT_TRUE(std::isnan(read[0].measured->at(1)));
  EXPECT_TRUE(std::signbit(read[0].measured->at(2)));
  EXPECT_EQ(read[0].failure, std::string(199, 'x'));
  EXPECT_TRUE(read[1].success());
  EXPECT_TRUE(read[1].measured && read[1].measured->empty());
  EXPECT_EQ(trials_text(read), trials_text(parse_trials(trials_text(read), "store")));
}

TEST_F(Store, DamagedTrialsOfOtherSystemsAreRefused) {
  TrialResult t;
  t.status = LocalisationStatus::answered;
  t.error = 0.5;
  t.measured = {2.5};
  const std::string whole = trials_text({t});
  const auto complaint = [&](const std::string& part, const std::string& instead) {
    std::string text = whole;
    text.replace(text.find(part), part.size(), instead);
    return refusal([&] { parse_trials(text, "store"); });
  };
  const auto expect = [&](const std::string& part, const std::string& instead,
                          const std::string& about) {
    const std::string said = complaint(part, instead);
    EXPECT_NE(said.find(about), std::string::npos) << instead << ": " << said;
  };
  EXPECT_EQ(parse_trials(whole, "store").size(), 1U);
  expect("[2.5]", "2.5", "is no list");
  expect("[2.5]", "[true]", "is no number");
  expect("0.5,1.0", "null,1.0", "is no number");  // answered, without an error
  expect("0.5,1.0", "0.5,0.0", "out of range");   // no limit
  expect(",\"\"]", ",7]", "a reason is no text");
  expect(",\"\"]", "]", "fields");
  expect("\"\"", '"' + std::string(201, 'x') + '"', "a reason is no text");
}

TEST_F(Store, AnotherKindOfFileIsRefusedAndKept) {
  write_atomically(folder_ / "b.sqlite", "this is no database at all, but it is somebody's file\n");
  sql(folder_ / "d.sqlite", "CREATE TABLE mine (x); INSERT INTO mine VALUES (1)");
  const auto before = files();
  for (const char* name : {"b.sqlite", "d.sqlite"}) {
    EXPECT_THROW(StudyStore(folder_ / name), Error) << name;
    EXPECT_THROW(read_store(folder_ / name), Error) << name;
  }
  EXPECT_EQ(files(), before);
}

TEST_F(Store, AnotherInstructionSetIsRefusedForWritingOnly) {
  {
    StudyStore store(folder_ / "c.sqlite");
    store.set_note("instruction_set", "ABACUS");
  }
  EXPECT_NE(refusal([&] { StudyStore store(folder_ / "c.sqlite"); }).find("instruction set ABACUS"),
            std::string::npos);
  EXPECT_EQ(read_store(folder_ / "c.sqlite").notes.at("instruction_set"), "ABACUS");
}

TEST_F(Store, HasOneWriter) {
  const auto file = folder_ / "one.sqlite";
  {
    StudyStore first(file);
    first.put(test::example_block("cell", 0));
    const std::string said = refusal([&] { StudyStore second(file); });
    EXPECT_NE(said.find("is being written by process " + std::to_string(::getpid())),
              std::string::npos)
        << said;
    first.put(test::example_block("cell", 1));
  }
  EXPECT_EQ(read_store(file).blocks.size(), 2u);
  EXPECT_EQ(files().size(), 1u);  // no lock, no log
}

TEST_F(Store, ALockLeftByAKilledWriterIsNoObstacle) {
  for (const Journal journal : {Journal::write_ahead, Journal::roll_back}) {
    const auto file = folder_ / "killed.sqlite";
    write_and_die(file, journal);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "killed.sqlite.lock"));
    EXPECT_EQ(StudyStore(file, journal).content().blocks.size(), 2u);
    EXPECT_EQ(files().size(), 1u);
    std::filesystem::remove(file);
  }
}

TEST_F(Store, ReadersChangeNoFileAndLeaveNone) {
  for (const Journal journal : {Journal::write_ahead, Journal::roll_back}) {
    const auto closed = folder_ / "closed.sqlite", killed = folder_ / "killed.sqlite";
    {
      StudyStore store(closed, journal);
      store.put(test::example_block("cell", 0));
      store.put(test::example_block("cell", 1));
    }
    write_and_die(killed, journal);
    EXPECT_EQ(std::filesystem::exists(folder_ / "killed.sqlite-wal"),
              journal == Journal::write_ahead);
    const auto before = files();
    EXPECT_EQ(read_store(closed).blocks.size(), 2u);
    EXPECT_EQ(read_store(killed).blocks.size(), 2u);
    EXPECT_EQ(files(), before);
    for (const auto& [name, content] : before) std::filesystem::remove(folder_ / name);
  }
}

TEST_F(Store, IsReadWhileItIsWritten) {
  StudyStore store(folder_ / "live.sqlite", Journal::write_ahead);
  for (int block = 0; block < 3; ++block) {
    store.put(test::example_block("cell", block));
    EXPECT_EQ(read_store(folder_ / "live.sqlite").blocks.size(), block + 1u);
  }
}

TEST_F(Store, ALogWithoutItsIndexIsReadAfterTheNextRun) {
  write_and_die(folder_ / "a.sqlite", Journal::write_ahead);
  std::filesystem::remove(folder_ / "a.sqlite-shm");
  EXPECT_TRUE(read_store(folder_ / "a.sqlite").interrupted);
  EXPECT_EQ(StudyStore(folder_ / "a.sqlite").content().blocks.size(), 2u);
}

// A change that was cut short while its pages were being written can only be undone by a writer.
TEST_F(Store, AChangeCutShortIsUndoneByTheNextWriter) {
  const auto file = folder_ / "live.sqlite", cut = folder_ / "cut.sqlite";
  {
    StudyStore store(file, Journal::roll_back);
    for (int block = 0; block < 20; ++block) store.put(test::example_block("cell", block));
  }
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  const char* change = "PRAGMA cache_size = 2; BEGIN; UPDATE trial_block SET results = 'none'";
  ASSERT_EQ(sqlite3_exec(db, change, nullptr, nullptr, nullptr), SQLITE_OK);
  for (const char* end : {"", "-journal"}) {
    std::filesystem::copy_file(file.string() + end, cut.string() + end);
  }
  sqlite3_close(db);
  const auto before = files();
  EXPECT_TRUE(read_store(cut).interrupted);
  EXPECT_EQ(files(), before);
  EXPECT_EQ(StudyStore(cut, Journal::roll_back).content().blocks.size(), 20u);
  EXPECT_EQ(read_store(cut).blocks.size(), 20u);
}

TEST_F(Store, ANoteOfCalibrationsComesBackOrIsDamaged) {
  const CalibrationRecord record{100, 2, 1, "too few views", "bent board", 5, 0.02, std::nan("")};
  const StoreNotes::value_type note = calibration_note("calibration", record);
  const auto read = [&](const std::string& text) {
    return noted_calibrations({{note.first, text}}, note.first).value();
  };
  const CalibrationRecord again = read(note.second);
  EXPECT_EQ(again.calibrations, 100);
  EXPECT_EQ(again.failed, 2);
  EXPECT_EQ(again.why_doubtful, "bent board");
  EXPECT_EQ(again.depth_error_m, 0.02);
  EXPECT_TRUE(std::isnan(again.depth_sd_m));
  for (const char* failed : {"-1", "101", "2.5", "4294967298", "true", "null"}) {
    std::string damaged = note.second;
    damaged.replace(damaged.find("\"failed\":2"), 10, std::string("\"failed\":") + failed);
    EXPECT_NE(refusal([&] { read(damaged); }).find("is damaged"), std::string::npos) << failed;
  }
}

TEST_F(Store, OfVersion1IsReadAndGivenChecksums) {
  const auto file = folder_ / "old.sqlite";
  const StoredBlock block = test::example_block("cell", 4);
  sql(file,
      "PRAGMA journal_mode = WAL;"
      "CREATE TABLE IF NOT EXISTS note (key TEXT PRIMARY KEY, value TEXT);"
      "CREATE TABLE IF NOT EXISTS block (cell TEXT, block INTEGER, trials INTEGER,"
      " answered INTEGER, successes INTEGER, results TEXT, PRIMARY KEY (cell, block));"
      "INSERT INTO note VALUES ('schema', '1'), ('k', 'v');"
      "INSERT INTO block VALUES ('cell', 4, 5, 4, 4, '" +
          trials_text(block.trials) + "')");
  const auto check = [&](const StoreContent& content) {
    ASSERT_EQ(content.blocks.size(), 1u);
    EXPECT_EQ(trials_text(content.blocks[0].trials), trials_text(block.trials));
    EXPECT_EQ(content.notes.at("k"), "v");
    EXPECT_EQ(content.notes.count("schema"), 0u);
  };
  const auto before = files();
  check(read_store(file));
  EXPECT_EQ(files(), before);
  check(StudyStore(file).content());
  sql(file, "UPDATE trial_block SET successes = 3");
  EXPECT_NE(refusal([&] { read_store(file); }).find("block 4 has another checksum"),
            std::string::npos);
}

TEST_F(Store, ALaterVersionIsRefused) {
  { const StudyStore store(folder_ / "later.sqlite"); }
  sql(folder_ / "later.sqlite", "PRAGMA user_version = 3");
  EXPECT_NE(refusal([&] { read_store(folder_ / "later.sqlite"); }).find("version 3 is not support"),
            std::string::npos);
}

TEST_F(Store, TablesOfAnotherMakeAreNotRun) {
  for (const char* text :
       {"CREATE VIEW v AS SELECT 1", "CREATE TRIGGER t AFTER INSERT ON remark BEGIN SELECT 1; END",
        "DROP TABLE remark", "ALTER TABLE remark ADD COLUMN more"}) {
    const auto file = folder_ / "other.sqlite";
    { const StudyStore store(file); }
    sql(file, text);
    EXPECT_NE(refusal([&] { read_store(file); }).find("is not a study store, or its tables"),
              std::string::npos)
        << text;
    std::filesystem::remove(file);
  }
}

// The checksum of these rows is right, as a fault or an enemy could make it.
TEST_F(Store, RowsAreCheckedBesidesTheirChecksum) {
  const std::string pose = "[0,0,0]", rest = ",3,0.5,0.5,0,0,1,1]";
  const auto trial = [&](const std::string& first) {
    return first + "," + pose + "," + pose + "," + pose + ",0.1,0.1,0.1" + rest;
  };
  const std::vector<std::string> bad{
      "",
      "{}",
      "[]",
      "[1]",
      "[[1]]",
      "[" + trial("[0,0") + "," + trial("[2,0") + "]",
      "[" + trial("[-1,0") + "]",
      "[" + trial("[0,7") + "]",
      "[" + trial("[0,1e300") + "]",
      "[" + trial("[4294967296,0") + "]",
      "[" + trial("[18446744073709551615,0") + "]",
      "[" + trial("[0.5,0") + "]",
      "[[0,0," + pose + "," + pose + "," + pose + ",null,0,0" + rest + "]",
      "[[0,0," + pose + ",[0,0]," + pose + ",0,0,0" + rest + "]",
      "[[0,0," + pose + "," + pose + "," + pose + ",0,0,0,3,0.5,0.5,0,0,-1,1]]",
      "[[0,0," + pose + "," + pose + "," + pose + ",0,0,1e999" + rest + "]",
      std::string(100'000, '[')};
  EXPECT_EQ(parse_trials("[" + trial("[0,0") + "," + trial("[1,0") + "]", "p").size(), 2u);
  // Rows of older stores end before the looks and the probability.
  std::string longer = trial("[0,0");
  longer.insert(longer.size() - 1, ",2,0.75");
  EXPECT_EQ(parse_trials("[" + longer + "]", "p")[0].probability, 0.75);
  EXPECT_EQ(parse_trials("[" + trial("[0,0") + "]", "p")[0].looks, 1);
  longer.replace(longer.size() - 5, 4, "1.5");
  EXPECT_THROW(parse_trials("[" + longer + "]", "p"), Error);
  for (const std::string& text : bad) {
    EXPECT_EQ(refusal([&] { parse_trials(text, "p"); }).rfind("p: is damaged: ", 0), 0u)
        << text.substr(0, 80);
  }
}

TEST_F(Store, OnlyKnownLocalDisksGetALog) {
  EXPECT_EQ(journal_for("/proc/x.sqlite"), Journal::roll_back);  // not known to be a disk
  EXPECT_EQ(journal_for("/nowhere/at/all/x.sqlite"), Journal::roll_back);
  EXPECT_EQ(on_local_disk(folder_ / "x.sqlite"),
            journal_for(folder_ / "x.sqlite") == Journal::write_ahead);
}

TEST_F(Store, ANameWithSignsOfUrisIsJustAName) {
  const auto file = folder_ / "a?mode=ro#b%20c.sqlite";
  {
    StudyStore store(file);
    store.put(test::example_block("cell", 0));
  }
  EXPECT_EQ(read_store(file).blocks.size(), 1u);
  EXPECT_EQ(files().begin()->first, file.filename());
}

}  // namespace
}  // namespace vernier
