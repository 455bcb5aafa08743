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
  bool done = false;
};

/// The written bytes. libjpeg's own destination in memory (jpeg_mem_dest) frees the buffer that its
/// caller holds when it grows, and tells the caller at the end only: after an error it is freed
/// twice.
struct WrittenBytes {
  jpeg_destination_mgr manager{};  // first: libjpeg knows no more of this than its address
  unsigned char* bytes = nullptr;  // by malloc
  std::size_t room = 0, size = 0;
};

WrittenBytes& written_by(j_compress_ptr encoder) {
  return *reinterpret_cast<WrittenBytes*>(encoder->dest);
}

void leave(j_common_ptr coder) {
  std::longjmp(reinterpret_cast<Rewriting*>(coder->err)->at_error, 1);
}

void say_nothing(j_common_ptr) {}

void begin_writing(j_compress_ptr) {}

boolean make_room(j_compress_ptr encoder) {
  WrittenBytes& written = written_by(encoder);  // full: libjpeg says no more than that
  const std::size_t room = written.room == 0 ? 4096 : 2 * written.room;
  auto* bytes = static_cast<unsigned char*>(std::realloc(written.bytes, room));
  if (bytes == nullptr) leave(reinterpret_cast<j_common_ptr>(encoder));
  written.manager.next_output_byte = bytes + written.room;
  written.manager.free_in_buffer = room - written.room;
  written.bytes = bytes;
  written.room = room;
  return TRUE;
}

void end_writing(j_compress_ptr encoder) {
  WrittenBytes& written = written_by(encoder);
  written.size = written.room - written.manager.free_in_buffer;
}

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

void rewrite(Rewriting& r, WrittenBytes& written, const unsigned char* bytes, std::size_t size) {
  if (setjmp(r.at_error) != 0) return;
  jpeg_create_decompress(&r.decoder);
  jpeg_create_compress(&r.encoder);
  jpeg_mem_src(&r.decoder, bytes, static_cast<unsigned long>(size));
  jpeg_read_header(&r.decoder, TRUE);
  jvirt_barray_ptr* coefficients = jpeg_read_coefficients(&r.decoder);
  if (!has_all_digits(r.decoder)) return;
  jpeg_copy_critical_parameters(&r.decoder, &r.encoder);
  r.encoder.optimize_coding = TRUE;  // the standard tables do not code every coefficient
  written.manager.init_destination = begin_writing;
  written.manager.empty_output_buffer = make_room;
  written.manager.term_destination = end_writing;
  r.encoder.dest = &written.manager;
  make_room(&r.encoder);
  jpeg_write_coefficients(&r.encoder, coefficients);
  jpeg_finish_compress(&r.encoder);
  r.done = true;
}

}  // namespace

std::string rewritten_jpeg(std::string_view bytes) {
  Rewriting r;
  r.decoder.err = r.encoder.err = jpeg_std_error(&r.errors);
  r.errors.error_exit = leave;
  r.errors.output_message = say_nothing;
  WrittenBytes out;
  rewrite(r, out, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_destroy_compress(&r.encoder);
  jpeg_destroy_decompress(&r.decoder);
  std::string written;
  if (r.done) written.assign(reinterpret_cast<const char*>(out.bytes), out.size);
  std::free(out.bytes);
  return written;
}

}  // namespace vernier::internal
