#include <fascia/io/gltf/gltf_animation.h>

namespace fascia {

void addGltfTrack(Json& animation, int times, int values, int node, const char* path) {
  Json::List& samplers = ensureList(animation, "samplers").list();
  const std::size_t sampler = samplers.size();
  samplers.push_back(
      Json::Object{{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
  // `samplers` may have moved from here on.
  ensureList(animation, "channels")
      .list()
      .push_back(Json::Object{{"sampler", sampler},
                              {"target", Json::Object{{"node", node}, {"path", path}}}});
}

bool hasGltfTracks(const Json& animation) {
  const Json* channels = animation.find("channels");
  return channels && !channels->list().empty();
}

}  // namespace fascia
