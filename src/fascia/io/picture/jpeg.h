#pragma once

#include <string>
#include <string_view>

#include <fascia/io/picture/image.h>

namespace fascia {

// JPEG through libjpeg-turbo, kept in one translation unit. False with a message for bad data.
bool jpegSize(std::string_view bytes, int& width, int& height, std::string& message);
// `image` has the size that jpegSize() told.
bool decodeJpeg(std::string_view bytes, Image& image, std::string& message);

}  // namespace fascia
