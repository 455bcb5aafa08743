// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/image_damage.h"

#include <png.h>

#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

// libjpeg's headers need <cstddef> and <cstdio> first.
#include <jpeglib.h>

#include <jerror.h>

#include "calib/base/image_size.h"

namespace vernier::internal {
namespace {

/// libjpeg and libpng report errors by longjmp, so no object with a destructor may be alive across
/// their calls.
struct JpegCheck {
  jpeg_error_mgr errors{};  // first member: libjpeg is given only its address
  std::jmp_buf at_error{};
  jpeg_decompress_struct decoder{};
  std::uint32_t width = 0, height = 0;  ///< as the header says
  bool cut_off = false, warned = false;
  std::array<char, JMSG_LENGTH_MAX> damage{};  ///< libjpeg's first message
};

JpegCheck& check_of(j_common_ptr decoder) { return *reinterpret_cast<JpegCheck*>(decoder->err); }

/// Whether a libjpeg warning means lost pixels, not just an unusual file.
bool loses_pixels(int code) {
  return code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE || code == JWRN_ARITH_BAD_CODE ||
         code == JWRN_MUST_RESYNC;
}

void on_jpeg_message(j_common_ptr decoder, int level) {
  JpegCheck& check = check_of(decoder);
  if (level >= 0) return;  // a trace
  check.warned = true;
  const int code = decoder->err->msg_code;
  check.cut_off = code == JWRN_JPEG_EOF;
  if (loses_pixels(code)) decoder->err->format_message(decoder, check.damage.data());
  // libjpeg would go on and fill in all the pixels that the file does not have.
  if (check.cut_off || check.damage[0] != '\0') std::longjmp(check.at_error, 1);
}

void on_jpeg_error(j_common_ptr decoder) { std::longjmp(check_of(decoder).at_error, 1); }

void print_nothing(j_common_ptr) {}

void read_jpeg(JpegCheck& check, const unsigned char* bytes, std::size_t size) {
  jpeg_decompress_struct& decoder = check.decoder;
  if (setjmp(check.at_error) != 0) return;
  jpeg_create_decompress(&decoder);
  jpeg_mem_src(&decoder, bytes, static_cast<unsigned long>(size));
  jpeg_read_header(&decoder, TRUE);
  check.width = decoder.image_width;
  check.height = decoder.image_height;
  if (!size_fault({check.width, check.height}).empty()) return;
  decoder.out_color_space = decoder.jpeg_color_space;
  decoder.scale_num = 1;
  decoder.scale_denom = 8;
  decoder.do_fancy_upsampling = FALSE;
  jpeg_start_decompress(&decoder);
  auto* row = decoder.mem->alloc_sarray(
      reinterpret_cast<j_common_ptr>(&decoder), JPOOL_IMAGE,
      decoder.output_width * static_cast<unsigned>(decoder.output_components), 1);
  while (decoder.output_scanline < decoder.output_height) jpeg_read_scanlines(&decoder, row, 1);
  jpeg_finish_decompress(&decoder);
}

struct PngCheck {
  const unsigned char* next = nullptr;
  std::size_t left = 0;
  std::uint32_t width = 0, height = 0;  ///< as the header says
  bool cut_off = false, warned = false;
  std::array<char, 200> damage{};  ///< libpng's message
};

void read_png_bytes(png_structp decoder, png_bytep to, std::size_t count) {
  auto& check = *static_cast<PngCheck*>(png_get_io_ptr(decoder));
  if (count > check.left) {
    check.cut_off = true;
    png_error(decoder, "the file has no end");
  }
  std::memcpy(to, check.next, count);
  check.next += count;
  check.left -= count;
}

void on_png_error(png_structp decoder, png_const_charp words) {
  auto& check = *static_cast<PngCheck*>(png_get_error_ptr(decoder));
  std::snprintf(check.damage.data(), check.damage.size(), "%s", words);
  png_longjmp(decoder, 1);
}

void on_png_warning(png_structp decoder, png_const_charp) {
  static_cast<PngCheck*>(png_get_error_ptr(decoder))->warned = true;
}

void read_png(PngCheck& check, png_structp decoder, png_infop info) {
  if (setjmp(png_jmpbuf(decoder)) != 0) return;
  png_set_read_fn(decoder, &check, read_png_bytes);
  // Of chunks that the pixels do not need as well: OpenCV would only print their wrong checksum.
  png_set_crc_action(decoder, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_read_info(decoder, info);
  check.width = png_get_image_width(decoder, info);
  check.height = png_get_image_height(decoder, info);
  if (!size_fault({check.width, check.height}).empty()) return;
  const int passes = png_set_interlace_handling(decoder);
  png_start_read_image(decoder);
  for (int pass = 0; pass < passes; ++pass) {
    for (png_uint_32 y = 0; y < check.height; ++y) png_read_row(decoder, nullptr, nullptr);
  }
  png_read_end(decoder, nullptr);
}

}  // namespace

std::string jpeg_damage(std::string_view bytes, bool* warned) {
  JpegCheck check;
  check.decoder.err = jpeg_std_error(&check.errors);
  check.errors.error_exit = on_jpeg_error;
  check.errors.emit_message = on_jpeg_message;
  check.errors.output_message = print_nothing;
  read_jpeg(check, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_destroy_decompress(&check.decoder);
  if (warned) *warned = check.warned;
  if (check.cut_off) return "is cut off (its JPEG data have no end)";
  if (check.damage[0] == '\0') return size_fault({check.width, check.height});
  return "is damaged (libjpeg: " + std::string(check.damage.data()) + ")";
}

std::string png_damage(std::string_view bytes, bool* warned) {
  PngCheck check;
  check.next = reinterpret_cast<const unsigned char*>(bytes.data());
  check.left = bytes.size();
  png_structp decoder =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, &check, on_png_error, on_png_warning);
  png_infop info = decoder ? png_create_info_struct(decoder) : nullptr;
  if (info) read_png(check, decoder, info);
  png_destroy_read_struct(&decoder, &info, nullptr);
  if (warned) *warned = check.warned;
  if (check.cut_off) return "is cut off (its PNG data have no end)";
  if (check.damage[0] == '\0') return size_fault({check.width, check.height});
  return "is damaged (libpng: " + std::string(check.damage.data()) + ")";
}

}  // namespace vernier::internal
