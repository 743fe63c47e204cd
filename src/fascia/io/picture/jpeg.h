#pragma once

#include <string>
#include <string_view>

#include <fascia/io/picture/image.h>

namespace fascia {

// JPEG through stb_image, kept in one translation unit. False with a message for bad data.
bool jpegSize(std::string_view bytes, int& width, int& height, std::string& message);
bool decodeJpeg(std::string_view bytes, Image& image, std::string& message);

}  // namespace fascia
