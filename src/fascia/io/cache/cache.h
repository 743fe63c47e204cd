#pragma once

#include <string>
#include <string_view>

#include <fascia/character/recording.h>
#include <fascia/io/picture/texture.h>

namespace fascia {

// An *.fcache: a simulated motion with everything needed to show it again, in one file.
struct Cache {
  CharacterDef def;
  Texture texture;
  Recording recording;
};

// Exact: readCache(writeCache(x)) has the same bits, but for times that were measured: those are
// not written, so that equal runs give equal files. Both throw Error. Writing takes the texture
// from the character's folder unless one is given.
void writeCache(const CharacterDef& def, const Recording& recording, const std::string& path,
                const Texture* texture = nullptr);
std::string cacheBytes(const CharacterDef& def, const Recording& recording,
                       const Texture* texture = nullptr);
Cache readCache(const std::string& path);
std::string readCacheBytes(const std::string& path);  // the file, of whatever kind of cache
Cache parseCache(std::string_view bytes, const std::string& file = {});
bool isCache(std::string_view bytes);  // by its first bytes

}  // namespace fascia
