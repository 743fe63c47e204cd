#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fascia/character/recording.h>

namespace fascia {

// A PC2 point cache (POINTCACHE2, version 1), as Blender, Maya and Houdini read it: positions of
// every vertex in every frame, in skinSurface order, metres, y up.
struct PointCache {
  float startFrame = 0;
  float sampleRate = 1;  // frames between samples
  std::size_t pointCount = 0;
  std::vector<Eigen::Vector3f> positions_m;  // sampleCount x pointCount
  std::size_t sampleCount() const { return pointCount ? positions_m.size() / pointCount : 0; }
};

void writePc2(const Recording& recording, const std::string& path);  // throws Error
PointCache readPc2(const std::string& path);                         // throws Error
PointCache parsePc2(std::string_view bytes, const std::string& file = {});

}  // namespace fascia
