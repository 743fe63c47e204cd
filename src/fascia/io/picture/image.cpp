#include <fascia/io/picture/image.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include <png.h>
#include <zlib.h>

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

// libpng's reader of one picture.
class PngReader {
 public:
  PngReader(std::string_view bytes, const std::string& file) : file_(file) {
    std::memset(&reader_, 0, sizeof reader_);
    reader_.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_memory(&reader_, bytes.data(), bytes.size())) fail();
    try {
      checkSize(file_, reader_.width, reader_.height);
    } catch (...) {
      png_image_free(&reader_);
      throw;
    }
  }
  ~PngReader() { png_image_free(&reader_); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  Image image() {
    Image image;
    image.width = static_cast<int>(reader_.width);
    image.height = static_cast<int>(reader_.height);
    reader_.format = PNG_FORMAT_RGBA;
    image.rgba.resize(PNG_IMAGE_SIZE(reader_));
    if (!png_image_finish_read(&reader_, nullptr, image.rgba.data(), 0, nullptr)) fail();
    return image;
  }

 private:
  [[noreturn]] void fail() const {
    throw fileError(file_, std::string("not a good PNG: ") + reader_.message);
  }

  const std::string& file_;
  png_image reader_;
};

// The size of a JPEG that may be decoded.
Image jpegFrame(std::string_view bytes, const std::string& file) {
  Image image;
  std::string message;
  if (!jpegSize(bytes, image.width, image.height, message)) throw fileError(file, message);
  checkSize(file, static_cast<std::size_t>(image.width), static_cast<std::size_t>(image.height));
  return image;
}

Image decodeWholeJpeg(std::string_view bytes, const std::string& file) {
  Image image = jpegFrame(bytes, file);
  std::string message;
  if (!decodeJpeg(bytes, image, message)) throw fileError(file, message);
  return image;
}

[[noreturn]] void refuseFormat(const std::string& file) {
  throw fileError(file, "neither a PNG nor a JPEG");
}

// Drawn pictures are: a quarter less to pack.
bool opaque(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 255) return false;
  return true;
}

void putBigEndian(std::uint32_t value, std::string& out) {
  for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(value >> shift & 0xff);
}

void putChunk(std::string_view kind, std::string_view data, std::string& out) {
  putBigEndian(static_cast<std::uint32_t>(data.size()), out);
  const std::size_t begin = out.size();
  out += kind;
  out += data;
  const auto* bytes = reinterpret_cast<const Bytef*>(out.data() + begin);
  putBigEndian(static_cast<std::uint32_t>(crc32_z(0, bytes, out.size() - begin)), out);
}

// Each row: the filter's number, then differences to the pixel on the left (filter 1, "Sub").
// Choosing among all filters for each row takes six times as long and gives larger files of drawn
// pictures, whose gradients are dithered.
std::string filteredRows(const Image& image, std::size_t channels) {
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  std::string rows;
  rows.reserve(height * (1 + channels * width));
  for (std::size_t y = 0; y < height; ++y) {
    rows += '\1';
    const std::uint8_t* row = image.rgba.data() + 4 * width * y;
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < channels; ++c) {
        const int left = x > 0 ? row[4 * (x - 1) + c] : 0;
        rows += static_cast<char>(row[4 * x + c] - left);
      }
  }
  return rows;
}

std::string deflated(const std::string& bytes) {
  constexpr int kLevel = 3;  // 6 takes twice as long and saves a few per cent
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()),
                               static_cast<uLong>(bytes.size()), kLevel);
  if (status != Z_OK) throw Error("the PNG cannot be encoded: no memory");
  out.resize(size);
  return out;
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
  const bool alpha = !opaque(image);
  std::string out("\x89PNG\r\n\x1a\n", 8);
  std::string header;
  putBigEndian(static_cast<std::uint32_t>(image.width), header);
  putBigEndian(static_cast<std::uint32_t>(image.height), header);
  header += {8, static_cast<char>(alpha ? 6 : 2), 0, 0, 0};  // bits; RGBA or RGB; not interlaced
  putChunk("IHDR", header, out);
  putChunk("IDAT", deflated(filteredRows(image, alpha ? 4 : 3)), out);
  putChunk("IEND", {}, out);
  return out;
}

void writePng(const Image& image, const std::string& path) {
  writeFileWhole(path, encodePng(image));
}

Image decodeImage(std::string_view bytes, const std::string& file) {
  switch (imageFormat(bytes)) {
    case ImageFormat::png:
      return PngReader(bytes, file).image();
    case ImageFormat::jpeg:
      return decodeWholeJpeg(bytes, file);
    case ImageFormat::unknown:
      break;
  }
  refuseFormat(file);
}

void checkPicture(std::string_view bytes, const std::string& file) {
  switch (imageFormat(bytes)) {
    case ImageFormat::png:
      PngReader(bytes, file);
      return;
    case ImageFormat::jpeg:
      jpegFrame(bytes, file);
      return;
    case ImageFormat::unknown:
      break;
  }
  refuseFormat(file);
}

Image readImage(const std::string& path) {
  return decodeImage(readFile(path, kMaxImageBytes), path);
}

}  // namespace fascia
