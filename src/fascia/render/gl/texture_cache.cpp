#include <fascia/render/gl/texture_cache.h>

#include <algorithm>
#include <string_view>

#include <fascia/base/error.h>
#include <fascia/render/mip_levels.h>

namespace fascia::gl {
namespace {

bool drawsOnProcessor() {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string_view renderer = name ? name : "";
  return renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe");
}

void upload(const Texture& texture, const Pixels& pixels) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  const auto w = static_cast<std::size_t>(std::max(pixels.width, 0));
  const auto h = static_cast<std::size_t>(std::max(pixels.height, 0));
  if (w == 0 || h == 0 || pixels.rgba.size() != w * h * 4)
    throw Error("render: a texture's size does not fit its pixels");
  if (pixels.width > limit || pixels.height > limit) {
    Issue issue;
    issue.message = "render: found a texture of " + std::to_string(w) + "x" + std::to_string(h) +
                    " pixels, expected at most " + std::to_string(limit) + " on a side";
    issue.hint = "make the picture smaller";
    throw Error(issue);
  }
  const TextureFormat format{GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE};
  allocateTexture(texture, pixels.width, pixels.height, format, GL_LINEAR, pixels.rgba.data());
  MipLevel mip{pixels.width, pixels.height, {}};
  for (int level = 1; mip.width > 1 || mip.height > 1; ++level) {
    const std::uint8_t* larger = level == 1 ? pixels.rgba.data() : mip.texels.data();
    mip = halvedSrgb(larger, mip.width, mip.height);
    uploadLevel(texture, level, mip.width, mip.height, format, mip.texels.data());
  }
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  // Around the tube the picture repeats; along it, it ends.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  // A processor takes the most time for what shows the least: faces seen from the side.
  if (!drawsOnProcessor() && epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
    glTexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, 4.f);
}

}  // namespace

GLuint TextureCache::find(const std::shared_ptr<const Pixels>& pixels) {
  if (!pixels) return 0;
  const auto known = entries_.find(pixels.get());
  if (known != entries_.end()) {
    known->second.used = true;
    return known->second.texture.id();
  }
  Entry entry{pixels, Texture(), true};
  upload(entry.texture, *pixels);
  return entries_.emplace(pixels.get(), std::move(entry)).first->second.texture.id();
}

void TextureCache::dropUnused() {
  std::erase_if(entries_, [](const auto& item) { return !item.second.used; });
  for (auto& [key, entry] : entries_) entry.used = false;
}

}  // namespace fascia::gl
