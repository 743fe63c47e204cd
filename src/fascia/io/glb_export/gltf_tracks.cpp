#include <fascia/io/glb_export/gltf_tracks.h>

#include <fascia/io/glb_export/keep_frames.h>
#include <fascia/io/gltf/gltf_animation.h>

namespace fascia {
namespace {

// Drops values that lie between their neighbours within `tolerance` (metres, or about radians / 2).
// A track that does not move is one key, or none where the node is there already.
template <class Value, class AddValues>
void addTrack(const std::vector<float>& times, const std::vector<Value>& values, float tolerance,
              bool needed, int node, const char* path, GltfBuilder& glb, Json& animation,
              const AddValues& addValues) {
  const std::vector<std::size_t> kept =
      keepFrames(values.size(), [&](std::size_t a, std::size_t b) {
        for (std::size_t f = a + 1; f < b; ++f) {
          const float s = (times[f] - times[a]) / (times[b] - times[a]);
          Value blend = values[a] + s * (values[b] - values[a]);
          if constexpr (Value::RowsAtCompileTime == 4) blend.normalize();
          if (!((blend - values[f]).norm() <= tolerance)) return false;
        }
        return true;
      });
  bool moves = false;
  std::vector<float> keptTimes;
  std::vector<Value> keptValues;
  for (const std::size_t k : kept) {
    keptTimes.push_back(times[k]);
    keptValues.push_back(values[k]);
    moves = moves || (values[k] - values[0]).norm() > tolerance;
  }
  if (!moves && !needed) return;
  if (!moves) keptTimes.resize(1), keptValues.resize(1);
  const int input = glb.addTimes(keptTimes);
  addGltfTrack(animation, input, addValues(keptValues), node, path);
}

}  // namespace

Eigen::Vector4f gltfQuaternion(const Mat3& rotation) {
  return Quat(rotation).normalized().coeffs().cast<float>();
}

void PlaceTrack::add(const Transform& place) {
  Eigen::Vector4f rotation = gltfQuaternion(place.rotation);
  if (!rotations.empty() && rotations.back().dot(rotation) < 0) rotation = -rotation;
  rotations.push_back(rotation);
  translations.push_back(place.translation_m.cast<float>());
}

Json placeNode(const std::string& name, const PlaceTrack& track) {
  return Json::Object{{"name", name},
                      {"translation", numberList(track.translations.front())},
                      {"rotation", numberList(track.rotations.front())}};
}

void addTracks(const std::vector<float>& times, const PlaceTrack& track, int node, GltfBuilder& glb,
               Json& animation, const TrackOptions& options) {
  addTrack(times, track.translations, options.metres, options.translations, node, "translation",
           glb, animation, [&](const auto& values) {
             return glb.addVectors(values, false, GltfBuilder::Target::none);
           });
  addTrack(times, track.rotations, options.halfRadians, options.rotations, node, "rotation", glb,
           animation, [&](const auto& values) {
             return options.small ? glb.addShortQuaternions(values) : glb.addQuaternions(values);
           });
}

}  // namespace fascia
