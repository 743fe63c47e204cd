#include <fascia/io/picture/jpeg.h>

#include <climits>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace fascia {
namespace {

bool failed(std::string& message) {
  const char* reason = stbi_failure_reason();
  message = std::string("not a good JPEG: ") + (reason ? reason : "damaged");
  return false;
}

const stbi_uc* data(std::string_view bytes) {
  return reinterpret_cast<const stbi_uc*>(bytes.data());
}

}  // namespace

bool jpegSize(std::string_view bytes, int& width, int& height, std::string& message) {
  int channels = 0;
  if (bytes.size() > INT_MAX) return failed(message);
  if (stbi_info_from_memory(data(bytes), static_cast<int>(bytes.size()), &width, &height,
                            &channels)) {
    return true;
  }
  return failed(message);
}

bool decodeJpeg(std::string_view bytes, Image& image, std::string& message) {
  int channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(data(bytes), static_cast<int>(bytes.size()), &image.width,
                                          &image.height, &channels, 4);
  if (!pixels) return failed(message);
  const auto count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  image.rgba.assign(pixels, pixels + 4 * count);
  stbi_image_free(pixels);
  return true;
}

}  // namespace fascia
