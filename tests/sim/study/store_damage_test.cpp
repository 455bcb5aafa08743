// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <string>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "sim/study/store_rows.h"
#include "sim/study/study_store.h"
#include "tests/sim/study/stored_example.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim::internal;

namespace {

/// A store cut short or with a flipped bit: it is refused in one line, or what is read is a part of
/// what was written, the rest of which a run computes again.
class DamagedStore : public testing::Test {
 protected:
  void SetUp() override {
    StudyStore store(folder_ / "whole.sqlite", Journal::roll_back);
    for (int block = 0; block < 12; ++block) {
      store.put(test::example_block(block % 2 ? "one cell" : "another", block));
    }
    store.set_note("ceiling of the world", "0.875");
  }

  static std::set<std::string> words(const StoreContent& content) {
    std::set<std::string> all;
    for (const StoredBlock& b : content.blocks) {
      all.insert(b.cell + " " + std::to_string(b.block) + " " + trials_text(b.trials));
    }
    for (const auto& [key, value] : content.notes) all.insert(key + " = " + value);
    return all;
  }

  enum class Outcome { refused, whole, less };

  template <class Read>
  Outcome outcome(Read read) {
    try {
      const std::set<std::string> found = words(read());
      EXPECT_TRUE(std::includes(whole_.begin(), whole_.end(), found.begin(), found.end()));
      return found == whole_ ? Outcome::whole : Outcome::less;
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_LT(line.size(), 600u);
      EXPECT_NE(line.find("damaged.sqlite"), std::string::npos) << line;
      return Outcome::refused;
    }
  }

  /// Of a reader and then of a writer of the damaged bytes.
  void try_both(const std::string& bytes, const std::string& what) {
    const auto file = folder_ / "damaged.sqlite";
    std::ofstream(file, std::ios::binary) << bytes;
    SCOPED_TRACE(what);
    ++count_[outcome([&] { return read_store(file); })];
    outcome([&] { return StudyStore(file, Journal::roll_back).content(); });
    EXPECT_FALSE(std::filesystem::exists(folder_ / "damaged.sqlite.lock"));
    for (const char* end : {"", "-wal", "-shm", "-journal"}) {
      std::filesystem::remove(file.string() + end);
    }
  }

  test::TestFolder folder_{"damaged_store"};
  std::set<std::string> whole_;
  std::map<Outcome, int> count_;
};

TEST_F(DamagedStore, CutShortIsRefusedOrGivesAPart) {
  const std::string bytes = read_whole(folder_ / "whole.sqlite");
  whole_ = words(read_store(folder_ / "whole.sqlite"));
  ASSERT_GT(bytes.size(), 20'000u);
  for (std::size_t size = 0; size < bytes.size(); size += 97) {
    try_both(bytes.substr(0, size), "cut to " + std::to_string(size));
  }
  EXPECT_EQ(count_[Outcome::less], 1);  // the empty file
  EXPECT_EQ(count_[Outcome::whole], 0);
}

TEST_F(DamagedStore, AFlippedBitIsRefusedOrChangesNothing) {
  const std::string bytes = read_whole(folder_ / "whole.sqlite");
  whole_ = words(read_store(folder_ / "whole.sqlite"));
  std::mt19937 seeded(12);  // NOLINT(cert-msc32-c): the same places each time
  for (int i = 0; i < 400; ++i) {
    std::string flipped = bytes;
    const std::size_t at = i < 100 ? static_cast<std::size_t>(i) : seeded() % bytes.size();
    const unsigned bit = seeded() % 8;
    flipped[at] = static_cast<char>(static_cast<unsigned char>(flipped[at]) ^ (1u << bit));
    try_both(flipped, "bit " + std::to_string(bit) + " of byte " + std::to_string(at));
  }
  EXPECT_EQ(count_[Outcome::less], 0);
  EXPECT_GT(count_[Outcome::refused], 100);
  RecordProperty("refused", count_[Outcome::refused]);
  RecordProperty("whole", count_[Outcome::whole]);
}

// The log is what a killed writer leaves; what it lacks is computed again.
TEST_F(DamagedStore, ADamagedLogIsRefusedOrGivesAPart) {
  const auto file = folder_ / "damaged.sqlite";
  {
    StudyStore store(folder_ / "live.sqlite", Journal::write_ahead);
    for (int block = 0; block < 4; ++block) store.put(test::example_block("cell", block));
    whole_ = words(store.content());
    for (const char* end : {"", "-wal", "-shm"}) {
      std::filesystem::copy_file((folder_ / "live.sqlite").string() + end,
                                 (folder_ / "copy").string() + end);
    }
  }
  const std::string log = read_whole(folder_ / "copy-wal");
  std::mt19937 seeded(13);  // NOLINT(cert-msc32-c)
  for (int i = 0; i < 120; ++i) {
    std::string damaged = log;
    const std::size_t at = seeded() % log.size();
    if (i % 2) {
      damaged.resize(at);
    } else {
      damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ 4u);
    }
    for (const char* end : {"", "-shm"}) {
      std::filesystem::copy_file((folder_ / "copy").string() + end, file.string() + end,
                                 std::filesystem::copy_options::overwrite_existing);
    }
    std::ofstream(file.string() + "-wal", std::ios::binary) << damaged;
    SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(at));
    outcome([&] { return read_store(file); });
    outcome([&] { return StudyStore(file).content(); });
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + end);
  }
}

}  // namespace
}  // namespace vernier
