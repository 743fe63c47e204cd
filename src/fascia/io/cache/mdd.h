#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fascia/character/recording.h>

namespace fascia {

// An MDD point cache (LightWave's Motion Designer), as Blender, Maya, Houdini and Cinema 4D read
// it: big-endian; positions of every vertex in every frame, in skinSurface order, metres, y up.
struct MddCache {
  std::vector<float> times_s;  // per frame
  std::size_t pointCount = 0;
  std::vector<Eigen::Vector3f> positions_m;  // frame * pointCount + point
};

void writeMdd(const Recording& recording, const std::string& path);  // throws Error
MddCache readMdd(const std::string& path);                           // throws Error
MddCache parseMdd(std::string_view bytes, const std::string& file = {});

}  // namespace fascia
