// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>
#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <string>

#include "calib/base/image_codecs.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

using Imdecode = cv::Mat(cv::InputArray, int);
using Imencode = bool(const std::string&,
                      cv::InputArray,
                      std::vector<unsigned char>&,
                      const std::vector<int>&);

void look_for(std::size_t bytes, int protection) {
  void* const place = mmap(nullptr, bytes, protection, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) throw std::bad_alloc();
  munmap(place, bytes);
}

/// Throws std::bad_alloc if the libraries would not fit into what memory the process may have: some
/// of them end the process where their own start fails, and what is thrown there cannot leave
/// dlopen. On Debian 12 they take 150 to 190 MB of addresses, of which 11 MB are written.
void look_for_room() {
  constexpr std::size_t mega = std::size_t{1} << 20;
  look_for(256 * mega, PROT_NONE);
  look_for(32 * mega, PROT_READ | PROT_WRITE);
}

[[noreturn]] void throw_not_loaded() {
  const char* const text = dlerror();
  const std::string why = text ? text : "unknown reason";
  const auto says = [&](const char* part) { return why.find(part) != std::string::npos; };
  // Another thread may have taken the room meanwhile.
  if (says("failed to map") || says("annot allocate") || says("annot map")) throw std::bad_alloc();
  const bool descriptors = says("oo many open files") || says("Error 24") || says("Error 23");
  throw Error(std::string("OpenCV's library ") + imgcodecs_library.name, "cannot be loaded: " + why,
              descriptors ? "allow more open files (ulimit -n)"
                          : "install OpenCV's image codecs (Debian: libopencv-imgcodecs-dev)");
}

struct Codecs {
  Imdecode* imdecode;
  Imencode* imencode;
};

Codecs loaded_codecs() {
  look_for_room();
  void* const library = dlopen(imgcodecs_library.name, RTLD_NOW | RTLD_LOCAL);
  if (!library) throw_not_loaded();
  const Codecs codecs{reinterpret_cast<Imdecode*>(dlsym(library, imgcodecs_library.imdecode)),
                      reinterpret_cast<Imencode*>(dlsym(library, imgcodecs_library.imencode))};
  if (!codecs.imdecode || !codecs.imencode) throw_not_loaded();
  return codecs;
}

const Codecs& codecs() {
  static const Codecs loaded = loaded_codecs();  // for as long as the process lives
  return loaded;
}

}  // namespace

cv::Mat decode_by_imgcodecs(cv::InputArray bytes, int flags) {
  return codecs().imdecode(bytes, flags);
}

void encode_by_imgcodecs(const std::string& ending,
                         cv::InputArray pixels,
                         std::vector<unsigned char>& bytes,
                         const std::vector<int>& options) {
  codecs().imencode(ending, pixels, bytes, options);
}

}  // namespace vernier::internal
