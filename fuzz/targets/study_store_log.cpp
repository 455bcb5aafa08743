// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fuzz/example_stores.h"
#include "fuzz/fuzz_target.h"
#include "sim/study/store_database.h"
#include "sim/study/study_store.h"

namespace vernier::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace vernier::sim::internal;

/// What lies beside a store, in the input's first byte.
enum class Beside { log, log_with_right_sums, journal };
/// Its second byte counts these of the store, behind which the other file begins.
constexpr std::size_t page = 512;

std::uint32_t word(std::string_view bytes, std::size_t at, bool first_is_high) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[at + (first_is_high ? i : 3 - i)]);
    value = value << 8 | byte;
  }
  return value;
}

void put_word(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
}

constexpr std::size_t head = 32, frame_head = 24;  // bytes of a log, and of each of its pages

/// The log with its checksums and salts put right, without which all of it would be left out
/// (https://sqlite.org/fileformat2.html#walformat).
std::string with_right_sums(std::string log) {
  if (log.size() < head) return log;
  const bool first_is_high = (log[3] & 1) != 0;
  std::uint32_t a = 0, b = 0;
  const auto add = [&](std::size_t at, std::size_t size) {
    for (const std::size_t end = at + size; at < end; at += 8) {
      a += word(log, at, first_is_high) + b;
      b += word(log, at + 4, first_is_high) + a;
    }
  };
  add(0, head - 8);
  put_word(log, head - 8, a);
  put_word(log, head - 4, b);
  const std::size_t size = word(log, 8, true);
  if (size < page || size > 65536 || size % 8 != 0) return log;
  for (std::size_t at = head; at + frame_head + size <= log.size(); at += frame_head + size) {
    log.replace(at + 8, 8, log, 16, 8);
    add(at, 8);
    add(at + frame_head, size);
    put_word(log, at + 16, a);
    put_word(log, at + 20, b);
  }
  return log;
}

/// Whether a log begins as one. Where it does not, readers wait 10 s for a writer to mend it.
bool has_head(const std::string& log) {
  constexpr std::uint32_t magic = 0x377f0682, version = 3007000;
  if (log.size() < head || (word(log, 0, true) & ~1u) != magic) return false;
  const std::uint32_t size = word(log, 8, true);
  return word(log, 4, true) == version && size >= page && size <= 65536 &&
         std::has_single_bit(size) && with_right_sums(log).compare(0, head, log, 0, head) == 0;
}

/// The files of a store that its writer has open, as a kill leaves them.
fs::path as_if_killed(const fs::path& store) {
  const fs::path folder = input_folder() / "killed";
  fs::create_directory(folder);
  for (const char* end : {"", "-wal", "-shm"}) {
    const fs::path file = store.string() + end;
    if (fs::exists(file)) fs::copy_file(file, folder / file.filename());
  }
  return folder / store.filename();
}

/// A killed writer's log or journal beside its store: reading changes nothing; the next run takes
/// it into the store, all readers agree with it, and a kill of that run loses nothing.
void run_study_store_log(std::string_view bytes) {
  if (bytes.size() < 2) return;
  const auto beside = static_cast<Beside>(static_cast<unsigned char>(bytes[0]) % 3);
  const std::string_view store = bytes.substr(2, page * static_cast<unsigned char>(bytes[1]));
  std::string log(bytes.substr(2 + store.size()));
  if (beside == Beside::log_with_right_sums) log = with_right_sums(std::move(log));

  clear_input_folder();
  const fs::path file = input_file(store, "study.sqlite");
  const fs::path other =
      input_file(log, beside == Beside::journal ? "study.sqlite-journal" : "study.sqlite-wal");
  const auto before = accepted([&] { return read_store(file); });
  require(file_bytes(file) == store && file_bytes(other) == log, "reading a store changes nothing");
  const auto files = fs::directory_iterator(input_folder());
  require(std::distance(begin(files), end(files)) == 2, "reading a store leaves no file");

  fs::path killed;
  const auto mended = accepted([&] {
    const StudyStore writer(file, Journal::write_ahead);
    StoreContent content = writer.content();
    killed = as_if_killed(file);
    return content;
  });
  if (!mended) return;
  if (before && !before->interrupted) require_same(*before, *mended);
  require_same(*mended, read_store(file));
  const std::string left_log = file_bytes(killed.string() + "-wal");
  if (!left_log.empty() && !has_head(left_log)) return;
  const StoreContent left = read_store(killed);
  // Where the writer's first page is to the bit the one that was lost, SQLite takes what followed
  // it for good again.
  if (!left.interrupted) require_kept(*mended, left);
}

/// The bytes of a store and of the file beside it, as a target's input.
std::string input_of(Beside beside, const fs::path& store, const char* ending) {
  const std::string bytes = file_bytes(store);
  return std::string{static_cast<char>(beside), static_cast<char>(bytes.size() / page)} + bytes +
         file_bytes(store.string() + ending);
}

std::vector<std::string> study_store_log_seeds() {
  clear_input_folder();
  std::vector<std::string> seeds;
  const fs::path file = input_folder() / "seed.sqlite";
  make_small_pages(file);
  for (int block = 0; block < 2; ++block) {  // of the second run a part is in the store
    StudyStore store(file, Journal::write_ahead);
    store.put({"cell", block, example_trials(block)});
    for (const auto& [key, value] : example_notes()) store.set_note(key, value);
    seeds.push_back(input_of(Beside::log, file, "-wal"));
    seeds.push_back(input_of(Beside::log_with_right_sums, file, "-wal"));
  }
  const Database changing = Database::to_write(file);
  changing.run("PRAGMA synchronous = OFF; BEGIN IMMEDIATE; DELETE FROM trial_block");
  seeds.push_back(input_of(Beside::journal, file, "-journal"));
  changing.run("ROLLBACK");
  return seeds;
}

const Registered registered_study_store_log{
    {"study_store_log", 16'000, "sqlite", run_study_store_log, study_store_log_seeds}};

}  // namespace
}  // namespace vernier::fuzz
