#include <fascia/io/picture/jpeg.h>

#include <csetjmp>
#include <cstdio>  // which jpeglib.h needs and does not include

#include <jerror.h>
#include <jpeglib.h>

namespace fascia {
namespace {

// What a stranger's picture may cost beside its pixels: a progressive one is kept whole until its
// last scan is read, and each scan goes over all of it.
constexpr long kMostMemory_bytes = 512L << 20;
constexpr int kMostScans = 200;  // encoders write about ten

// The library reports errors through calls that must not return. Only plain data live where it is
// left by longjmp.
struct JpegReader {
  jpeg_decompress_struct library;
  jpeg_error_mgr errors;
  jpeg_progress_mgr progress;
  std::jmp_buf failed;
  char message[JMSG_LENGTH_MAX];
  bool cutShort;
};

JpegReader& readerOf(j_common_ptr library) {
  return *static_cast<JpegReader*>(library->client_data);
}

[[noreturn]] void failReading(j_common_ptr library) {
  JpegReader& reader = readerOf(library);
  library->err->format_message(library, reader.message);
  std::longjmp(reader.failed, 1);
}

// Warnings tell of data that were guessed. Most pictures with such show what they should; one that
// ends too early does not.
void noteWarning(j_common_ptr library, int level) {
  if (level < 0 && library->err->msg_code == JWRN_JPEG_EOF) readerOf(library).cutShort = true;
}

void refuseEndlessScans(j_common_ptr library) {
  JpegReader& reader = readerOf(library);
  if (!library->is_decompressor || reader.library.input_scan_number <= kMostScans) return;
  std::snprintf(reader.message, sizeof reader.message, "more than %d scans", kMostScans);
  std::longjmp(reader.failed, 1);
}

void beginReading(std::string_view bytes, JpegReader& reader) {
  reader.library.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = failReading;
  reader.errors.emit_message = noteWarning;
  reader.library.client_data = &reader;
  jpeg_create_decompress(&reader.library);
  reader.library.client_data = &reader;
  reader.library.mem->max_memory_to_use = kMostMemory_bytes;
  reader.progress.progress_monitor = refuseEndlessScans;
  reader.library.progress = &reader.progress;
  jpeg_mem_src(&reader.library, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&reader.library, TRUE);
}

// Inks as Adobe's programs write them: inverted.
void fromInks(const std::uint8_t* inks, std::size_t width, std::uint8_t* rgba) {
  for (std::size_t x = 0; x < width; ++x, inks += 4, rgba += 4) {
    for (int c = 0; c < 3; ++c) rgba[c] = static_cast<std::uint8_t>(inks[c] * inks[3] / 255);
    rgba[3] = 255;
  }
}

bool hasInks(const jpeg_decompress_struct& library) {
  return library.jpeg_color_space == JCS_CMYK || library.jpeg_color_space == JCS_YCCK;
}

void readPixels(JpegReader& reader, std::uint8_t* rgba, std::uint8_t* row) {
  jpeg_decompress_struct& library = reader.library;
  const bool inks = hasInks(library);
  library.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
  jpeg_start_decompress(&library);
  const auto width = static_cast<std::size_t>(library.output_width);
  while (library.output_scanline < library.output_height) {
    std::uint8_t* to = rgba + 4 * width * library.output_scanline;
    JSAMPROW line = inks ? row : to;
    jpeg_read_scanlines(&library, &line, 1);
    if (inks) fromInks(row, width, to);
  }
  jpeg_finish_decompress(&library);
}

std::string notGood(const std::string& reason) {
  return "not a good JPEG: " + reason;
}

}  // namespace

bool jpegSize(std::string_view bytes, int& width, int& height, std::string& message) {
  JpegReader reader{};
  if (setjmp(reader.failed) == 0) {
    beginReading(bytes, reader);
    width = static_cast<int>(reader.library.image_width);
    height = static_cast<int>(reader.library.image_height);
    jpeg_destroy_decompress(&reader.library);
    return true;
  }
  message = notGood(reader.message);
  jpeg_destroy_decompress(&reader.library);
  return false;
}

bool decodeJpeg(std::string_view bytes, Image& image, std::string& message) {
  const auto width = static_cast<std::size_t>(image.width);
  image.rgba.assign(4 * width * static_cast<std::size_t>(image.height), 0);
  std::vector<std::uint8_t> row(4 * width);
  std::uint8_t* const pixels = image.rgba.data();
  std::uint8_t* const oneRow = row.data();
  JpegReader reader{};
  if (setjmp(reader.failed) == 0) {
    beginReading(bytes, reader);
    readPixels(reader, pixels, oneRow);
  } else {
    message = notGood(reader.message);
  }
  const bool cutShort = reader.cutShort;
  jpeg_destroy_decompress(&reader.library);
  if (message.empty() && cutShort) message = notGood("it is cut short");
  return message.empty();
}

}  // namespace fascia
