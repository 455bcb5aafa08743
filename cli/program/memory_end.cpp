// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/memory_end.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <typeinfo>

#include "calib/base/unfinished_work.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

void write_line(const char* text) noexcept {
  // A closed or full standard error changes nothing.
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

[[noreturn]] void end_without_memory() noexcept {
  thread_local bool ending = false;  // what fails for want of memory here would come back
  if (!ending) {
    ending = true;
    abandon_unfinished_work();
  }
  write_line("vernier: ");
  write_line(out_of_memory);
  write_line("\n");
  ::_exit(static_cast<int>(Exit::bad_input));
}

[[noreturn]] void on_terminate() noexcept {
  if (const std::exception_ptr fault = std::current_exception()) {
    try {
      std::rethrow_exception(fault);
    } catch (const std::exception& known) {
      if (is_out_of_memory(known)) end_without_memory();
      write_line("vernier: internal error: ");
      write_line(known.what());
      write_line("\n");
    } catch (...) {
      write_line("vernier: internal error\n");
    }
  }
  std::abort();
}

/// How oneTBB says that it cannot start a thread: "pthread_create has failed: …".
bool is_of_tbb(const std::exception& fault) noexcept {
  if (typeid(fault) != typeid(std::runtime_error)) return false;
  const std::string_view what = fault.what();
  return what.starts_with("pthread_") &&
         (what.ends_with(std::strerror(EAGAIN)) || what.ends_with(std::strerror(ENOMEM)));
}

}  // namespace

bool is_out_of_memory(const std::exception& fault) noexcept {
  if (const auto* of_opencv = dynamic_cast<const cv::Exception*>(&fault)) {
    // The second is how cv::UMat says it.
    return of_opencv->code == cv::Error::StsNoMem ||
           (of_opencv->code == cv::Error::StsAssert && of_opencv->err == "u != 0");
  }
  if (const auto* of_system = dynamic_cast<const std::system_error*>(&fault)) {
    return of_system->code() == std::errc::resource_unavailable_try_again ||
           of_system->code() == std::errc::not_enough_memory;
  }
  return dynamic_cast<const std::bad_alloc*>(&fault) ||
         dynamic_cast<const std::length_error*>(&fault) || is_of_tbb(fault);
}

void watch_memory() noexcept { std::set_terminate(on_terminate); }

}  // namespace vernier::cli
