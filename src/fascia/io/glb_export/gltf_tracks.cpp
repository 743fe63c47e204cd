#include <fascia/io/glb_export/gltf_tracks.h>

#include <fascia/io/glb_export/keep_frames.h>

namespace fascia {
namespace {

// Drops values that lie between their neighbours within `tolerance` (metres, or about radians / 2).
// A track that does not move is one key, or none where the node is there already.
template <class Value, class AddValues>
void addTrack(const std::vector<float>& times, const std::vector<Value>& values, float tolerance,
              bool needed, std::size_t node, const char* path, GlbBuilder& glb,
              GltfAnimation& animation, const AddValues& addValues) {
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
  const std::size_t input = glb.addTimes(keptTimes);
  animation.add(input, addValues(keptValues), node, path);
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

GlbBuilder::Json placeNode(const std::string& name, const PlaceTrack& track) {
  const Eigen::Vector3f& t = track.translations.front();
  const Eigen::Vector4f& r = track.rotations.front();
  return {{"name", name},
          {"translation", {t.x(), t.y(), t.z()}},
          {"rotation", {r.x(), r.y(), r.z(), r.w()}}};
}

void addTracks(const std::vector<float>& times, const PlaceTrack& track, std::size_t node,
               GlbBuilder& glb, GltfAnimation& animation, const TrackOptions& options) {
  addTrack(times, track.translations, options.metres, options.translations, node, "translation",
           glb, animation, [&](const auto& values) {
             return glb.addVectors(values, false, GlbBuilder::Target::none);
           });
  addTrack(times, track.rotations, options.halfRadians, options.rotations, node, "rotation", glb,
           animation, [&](const auto& values) {
             return options.small ? glb.addShortQuaternions(values) : glb.addQuaternions(values);
           });
}

}  // namespace fascia
