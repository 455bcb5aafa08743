// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/png_rewriting.h"

#include <png.h>

#include <cstddef>
#include <cstring>
#include <exception>

namespace vernier::internal {
namespace {

/// libpng's errors leave its functions by longjmp: nothing that is alive across one of their calls
/// has a destructor, except what the caller owns.
struct PngCopy {
  std::string_view left;
  std::string* written = nullptr;
  bool done = false;
};

void read_bytes(png_structp decoder, png_bytep to, std::size_t count) {
  std::string_view& left = static_cast<PngCopy*>(png_get_io_ptr(decoder))->left;
  if (count > left.size()) png_error(decoder, "the file has no end");
  std::memcpy(to, left.data(), count);
  left.remove_prefix(count);
}

void write_bytes(png_structp encoder, png_bytep from, std::size_t count) {
  try {
    static_cast<PngCopy*>(png_get_io_ptr(encoder))
        ->written->append(reinterpret_cast<const char*>(from), count);
    return;
  } catch (const std::exception&) {  // must not pass through libpng
  }
  png_error(encoder, "out of memory");
}

void flush_nothing(png_structp) {}
void leave_png(png_structp coder, png_const_charp) { png_longjmp(coder, 1); }
void ignore_png_warning(png_structp, png_const_charp) {}

void copy_head(png_structp decoder, png_infop from, png_structp encoder, png_infop to) {
  png_uint_32 width = 0, height = 0;
  int depth = 0, colour = 0, interlace = 0;
  png_get_IHDR(decoder, from, &width, &height, &depth, &colour, &interlace, nullptr, nullptr);
  png_set_IHDR(encoder, to, width, height, depth, colour, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
  png_colorp palette = nullptr;
  int colours = 0, clear_count = 0;
  if (png_get_PLTE(decoder, from, &palette, &colours)) {
    png_set_PLTE(encoder, to, palette, colours);
  }
  png_bytep clear = nullptr;
  png_color_16p clear_colour = nullptr;
  if (png_get_tRNS(decoder, from, &clear, &clear_count, &clear_colour)) {
    png_set_tRNS(encoder, to, clear, clear_count, clear_colour);
  }
  png_set_rows(encoder, to, png_get_rows(decoder, from));
}

void copy_png(
    PngCopy& copy, png_structp decoder, png_infop from, png_structp encoder, png_infop to) {
  if (setjmp(png_jmpbuf(decoder)) != 0) return;
  png_set_read_fn(decoder, &copy, read_bytes);
  png_read_png(decoder, from, PNG_TRANSFORM_IDENTITY, nullptr);
  if (setjmp(png_jmpbuf(encoder)) != 0) return;
  png_set_write_fn(encoder, &copy, write_bytes, flush_nothing);
  png_set_compression_level(encoder, 0);
  copy_head(decoder, from, encoder, to);
  png_write_png(encoder, to, PNG_TRANSFORM_IDENTITY, nullptr);
  copy.done = true;
}

}  // namespace

std::string rewritten_png(std::string_view bytes) {
  std::string written;
  PngCopy copy{bytes, &written};
  png_structp decoder =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_png, ignore_png_warning);
  png_structp encoder =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_png, ignore_png_warning);
  png_infop from = decoder ? png_create_info_struct(decoder) : nullptr;
  png_infop to = encoder ? png_create_info_struct(encoder) : nullptr;
  if (from && to) copy_png(copy, decoder, from, encoder, to);
  png_destroy_write_struct(&encoder, &to);  // its rows belong to the decoder
  png_destroy_read_struct(&decoder, &from, nullptr);
  if (!copy.done) written.clear();
  return written;
}

}  // namespace vernier::internal
