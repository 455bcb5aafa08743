// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mpi/mpi_ranks.h"

// Only the C interface: the one for C++ was removed in MPI 3.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <climits>
#include <cstddef>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "calib/error.h"
#include "sim/study/communicator.h"

namespace vernier::sim::internal {

namespace {

/// Throws Error if MPI reports a fault.
void check(int code, const char* what) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> words{};
  int length = 0;
  MPI_Error_string(code, words.data(), &length);
  throw Error("MPI", std::string(what) + " failed: " + words.data(),
              "check that all machines are up, and run the same command again");
}

/// The cores of this process, divided by the number of ranks of this machine that have the same.
int part_of_cores() {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  if (::sched_getaffinity(0, sizeof mine, &mine) != 0) return 1;
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int ranks = 1;
  MPI_Comm_size(machine, &ranks);
  std::vector<cpu_set_t> all(static_cast<std::size_t>(ranks));
  MPI_Allgather(&mine, sizeof mine, MPI_BYTE, all.data(), sizeof mine, MPI_BYTE, machine);
  MPI_Comm_free(&machine);
  const auto same = std::count_if(all.begin(), all.end(),
                                  [&](const cpu_set_t& other) { return CPU_EQUAL(&mine, &other); });
  return std::max(1, CPU_COUNT(&mine) / static_cast<int>(std::max<std::ptrdiff_t>(1, same)));
}

class WorldCommunicator : public MpiRanks {
 public:
  WorldCommunicator() {
    int level = 0;
    check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level), "the start");
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    if (level < MPI_THREAD_FUNNELED) {
      MPI_Finalize();
      throw Error("MPI", "does not allow threads", "use one that does, such as Open MPI");
    }
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    cores_ = part_of_cores();
  }
  /// Gives what is on its way some time: a rank that has left may never receive it.
  ~WorldCommunicator() override {
    using namespace std::chrono_literals;
    const auto end = std::chrono::steady_clock::now() + 1s;
    while (drop_sent(), !sending_.empty() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(1ms);
    }
    MPI_Finalize();
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int cores() const override { return cores_; }

  void send(int to, const std::string& text) override {
    if (text.size() > static_cast<std::size_t>(INT_MAX)) {
      throw Error("MPI", "a message has more than 2 GB", "run smaller blocks");
    }
    // MPI_Send would keep a core busy until the other rank receives, if the text is long.
    drop_sent();
    Sending& one = sending_.emplace_back(Sending{text});
    check(MPI_Isend(one.text.data(), static_cast<int>(one.text.size()), MPI_CHAR, to, tag,
                    MPI_COMM_WORLD, &one.request),
          "sending");
  }

  std::optional<Message> receive() override {
    drop_sent();
    int there = 0;
    MPI_Status status;
    check(MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status), "looking for messages");
    if (!there) return std::nullopt;
    int bytes = 0;
    MPI_Get_count(&status, MPI_CHAR, &bytes);
    Message message{status.MPI_SOURCE, std::string(static_cast<std::size_t>(bytes), '\0')};
    check(MPI_Recv(message.text.data(), bytes, MPI_CHAR, message.from, tag, MPI_COMM_WORLD,
                   MPI_STATUS_IGNORE),
          "receiving");
    return message;
  }

 private:
  struct Sending {
    std::string text;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void drop_sent() {
    std::erase_if(sending_, [](Sending& one) {
      int sent = 0;
      return MPI_Test(&one.request, &sent, MPI_STATUS_IGNORE) != MPI_SUCCESS || sent;
    });
  }

  static constexpr int tag = 1;
  int rank_ = 0, size_ = 1, cores_ = 1;
  std::list<Sending> sending_;  // texts stay in their place until they have gone
};

}  // namespace

std::unique_ptr<MpiRanks> mpi_ranks() { return std::make_unique<WorldCommunicator>(); }

std::string mpi_version() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> words{};
  int length = 0;
  if (MPI_Get_library_version(words.data(), &length) != MPI_SUCCESS) return "unknown";
  const std::string text(words.data());
  return text.substr(0, std::min(text.find(','), text.size()));
}

}  // namespace vernier::sim::internal
