#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fascia {

// 8-bit sRGB with straight alpha, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // width x height x 4
};

// The largest picture that a file may hold: 16384 a side and 64 million pixels.
inline constexpr int kMaxImageSide = 16384;
inline constexpr std::size_t kMaxImagePixels = 1u << 26;

std::string encodePng(const Image& image);
void writePng(const Image& image, const std::string& path);  // whole or not at all

enum class ImageFormat { unknown, png, jpeg };
ImageFormat imageFormat(std::string_view bytes);  // by the first bytes, not by a name

bool isPicture(const std::vector<std::uint8_t>& bytes);  // begins like a PNG or a JPEG

// PNG or JPEG, told apart by content. Throws Error; `file` is what messages call it.
Image decodeImage(std::string_view bytes, const std::string& file = {});
// What a picture's first bytes tell: throws Error if it is none, or larger than may be decoded.
void checkPicture(std::string_view bytes, const std::string& file = {});
Image readImage(const std::string& path);

}  // namespace fascia
