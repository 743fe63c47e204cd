#include <fascia/io/picture/image.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include <png.h>

#include <fascia/base/error.h>
#include <fascia/io/file/file.h>
#include <fascia/io/picture/jpeg.h>

namespace fascia {
namespace {

constexpr std::size_t kMaxImageBytes = 256u << 20;

void checkSize(const std::string& file, std::size_t width, std::size_t height) {
  if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide ||
      width * height > kMaxImagePixels) {
    throw fileError(file, "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                              " pixels is not read");
  }
}

Image decodePng(std::string_view bytes, const std::string& file) {
  png_image reader;
  std::memset(&reader, 0, sizeof reader);
  reader.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&reader, bytes.data(), bytes.size())) {
    throw fileError(file, std::string("not a good PNG: ") + reader.message);
  }
  Image image;
  try {
    checkSize(file, reader.width, reader.height);
    image.width = static_cast<int>(reader.width);
    image.height = static_cast<int>(reader.height);
    reader.format = PNG_FORMAT_RGBA;
    image.rgba.resize(PNG_IMAGE_SIZE(reader));
  } catch (...) {
    png_image_free(&reader);
    throw;
  }
  if (!png_image_finish_read(&reader, nullptr, image.rgba.data(), 0, nullptr)) {
    throw fileError(file, std::string("not a good PNG: ") + reader.message);
  }
  return image;
}

}  // namespace

bool isPicture(const std::vector<std::uint8_t>& bytes) {
  const auto begins = [&](std::initializer_list<std::uint8_t> magic) {
    return bytes.size() > magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  return begins({0x89, 'P', 'N', 'G'}) || begins({0xFF, 0xD8, 0xFF});
}

ImageFormat imageFormat(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return ImageFormat::png;
  if (bytes.starts_with("\xff\xd8\xff")) return ImageFormat::jpeg;
  return ImageFormat::unknown;
}

std::string encodePng(const Image& image) {
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width <= 0 || image.height <= 0 || image.rgba.size() != 4 * pixels) {
    throw Error("an image without its pixels cannot be written");
  }
  png_image writer;
  std::memset(&writer, 0, sizeof writer);
  writer.version = PNG_IMAGE_VERSION;
  writer.width = static_cast<png_uint_32>(image.width);
  writer.height = static_cast<png_uint_32>(image.height);
  writer.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(writer);
  std::string out(size, '\0');
  if (!png_image_write_to_memory(&writer, out.data(), &size, 0, image.rgba.data(), 0, nullptr)) {
    throw Error(std::string("the PNG cannot be encoded: ") + writer.message);
  }
  out.resize(size);
  return out;
}

void writePng(const Image& image, const std::string& path) {
  writeFileWhole(path, encodePng(image));
}

Image decodeImage(std::string_view bytes, const std::string& file) {
  switch (imageFormat(bytes)) {
    case ImageFormat::png:
      return decodePng(bytes, file);
    case ImageFormat::jpeg:
      break;
    case ImageFormat::unknown:
      throw fileError(file, "neither a PNG nor a JPEG");
  }
  Image image;
  std::string message;
  if (!jpegSize(bytes, image.width, image.height, message)) throw fileError(file, message);
  checkSize(file, static_cast<std::size_t>(image.width), static_cast<std::size_t>(image.height));
  if (!decodeJpeg(bytes, image, message)) throw fileError(file, message);
  return image;
}

Image readImage(const std::string& path) {
  return decodeImage(readFile(path, kMaxImageBytes), path);
}

}  // namespace fascia
