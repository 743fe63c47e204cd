#pragma once

#include <memory>
#include <unordered_map>

#include <fascia/render/gl/objects.h>
#include <fascia/render/pixels.h>

namespace fascia::gl {

// Pictures on the graphics side, with mipmaps, for as long as scenes use them.
class TextureCache {
 public:
  GLuint find(const std::shared_ptr<const Pixels>& pixels);  // uploads when new; 0 for null
  void dropUnused();  // frees what find() was not asked for since the last call

 private:
  struct Entry {
    std::shared_ptr<const Pixels> pixels;  // holds the address, which is the key
    Texture texture;
    bool used = true;
  };
  std::unordered_map<const Pixels*, Entry> entries_;
};

}  // namespace fascia::gl
