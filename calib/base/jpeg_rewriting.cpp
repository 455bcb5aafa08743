// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/jpeg_rewriting.h"

#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

// libjpeg's header needs <cstddef> and <cstdio> before it.
#include <jpeglib.h>

namespace vernier::internal {
namespace {

/// libjpeg's errors leave its functions by longjmp: nothing that is alive across one of their calls
/// has a destructor.
struct Rewriting {
  jpeg_error_mgr errors{};  // first: libjpeg knows no more of this than its address
  std::jmp_buf at_error{};
  jpeg_decompress_struct decoder{};
  jpeg_compress_struct encoder{};
  unsigned char* written = nullptr;  // by malloc
  unsigned long size = 0;
  bool done = false;
};

void leave(j_common_ptr coder) {
  std::longjmp(reinterpret_cast<Rewriting*>(coder->err)->at_error, 1);
}

void say_nothing(j_common_ptr) {}

/// Whether every scan of a progressive file is there: decoders smooth where digits are missing.
bool has_all_digits(const jpeg_decompress_struct& decoder) {
  if (!decoder.progressive_mode) return true;
  for (int c = 0; c < decoder.num_components; ++c) {
    for (const int missing : decoder.coef_bits[c]) {
      if (missing != 0) return false;
    }
  }
  return true;
}

void rewrite(Rewriting& r, const unsigned char* bytes, std::size_t size) {
  constexpr int exif = JPEG_APP0 + 1;
  if (setjmp(r.at_error) != 0) return;
  jpeg_create_decompress(&r.decoder);
  jpeg_create_compress(&r.encoder);
  jpeg_mem_src(&r.decoder, bytes, static_cast<unsigned long>(size));
  jpeg_save_markers(&r.decoder, exif, 0xffff);
  jpeg_read_header(&r.decoder, TRUE);
  jvirt_barray_ptr* coefficients = jpeg_read_coefficients(&r.decoder);
  if (!has_all_digits(r.decoder)) return;
  jpeg_copy_critical_parameters(&r.decoder, &r.encoder);
  r.encoder.optimize_coding = TRUE;  // the standard tables do not code every coefficient
  jpeg_mem_dest(&r.encoder, &r.written, &r.size);
  jpeg_write_coefficients(&r.encoder, coefficients);
  for (const auto* marker = r.decoder.marker_list; marker; marker = marker->next) {
    jpeg_write_marker(&r.encoder, marker->marker, marker->data, marker->data_length);
  }
  jpeg_finish_compress(&r.encoder);
  r.done = true;
}

}  // namespace

std::string rewritten_jpeg(std::string_view bytes) {
  Rewriting r;
  r.decoder.err = r.encoder.err = jpeg_std_error(&r.errors);
  r.errors.error_exit = leave;
  r.errors.output_message = say_nothing;
  rewrite(r, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_destroy_compress(&r.encoder);
  jpeg_destroy_decompress(&r.decoder);
  std::string written;
  if (r.done) written.assign(reinterpret_cast<const char*>(r.written), r.size);
  std::free(r.written);
  return written;
}

}  // namespace vernier::internal
