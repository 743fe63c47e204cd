#include <fascia/io/rig_export/other_channels.h>

#include <algorithm>
#include <map>

#include <fascia/base/index.h>

namespace fascia {
namespace {

// Writes keys, and shares the times that several channels have in common.
class KeyWriter {
 public:
  KeyWriter(RigSource& source, const Json& animation) : source_(source), old_(animation) {}

  // The new sampler of a channel.
  Json samplerOf(const Json& channel, const GltfKeys& keys) {
    Json sampler = oldSampler(channel);
    const auto [times, isNew] = times_.try_emplace(keys.times_s, -1);
    if (isNew) times->second = source_.document.addFloats(keys.times_s, "SCALAR", true);
    const auto output = static_cast<int>(sampler.find("output")->number());
    const std::string type =
        source_.document.root()["accessors"].at(at(output))["type"].textOr("SCALAR");
    putMember(sampler, "input", times->second);
    putMember(sampler, "output", source_.document.addFloats(keys.values, type));
    return sampler;
  }

 private:
  const Json& oldSampler(const Json& channel) const {
    const auto index = static_cast<std::size_t>(channel.find("sampler")->number());
    return old_.find("samplers")->list().at(index);
  }

  RigSource& source_;
  const Json& old_;
  std::map<std::vector<float>, int> times_;
};

}  // namespace

bool movesJoint(const RigSource& source, const Json& channel) {
  const Json* target = channel.find("target");
  const Json* node = target ? target->find("node") : nullptr;
  const Json* path = target ? target->find("path") : nullptr;
  if (!node || !path || !node->is(Json::Kind::number) || !path->is(Json::Kind::text)) return false;
  const auto& joints = source.rig.nodeOfJoint;
  return (path->text() == "rotation" || path->text() == "translation") &&
         std::ranges::find(joints, static_cast<int>(node->number())) != joints.end();
}

bool weighsMorphs(const Json& channel, int node) {
  const Json* target = channel.find("target");
  const Json* path = target ? target->find("path") : nullptr;
  const Json* index = target ? target->find("node") : nullptr;
  return path && path->is(Json::Kind::text) && path->text() == "weights" && index &&
         static_cast<int>(index->number()) == node;
}

std::size_t cutOtherChannels(RigSource& source, int animation, const GltfSpan& span) {
  const Json old = source.document.item("animations", animation);
  KeyWriter writer(source, old);
  Json::List samplers, channels;
  std::size_t left = 0;
  const Json* all = old.find("channels");
  for (std::size_t i = 0; all && i < all->list().size(); ++i) {
    const Json& channel = all->list()[i];
    if (movesJoint(source, channel)) continue;
    const GltfPlace place = source.document.root()["animations"].at(at(animation));
    GltfKeys keys;
    if (readGltfKeys(source.document, place, channel, keys)) keys = cutGltfKeys(keys, span);
    if (keys.times_s.empty()) {
      ++left;
      continue;
    }
    Json fresh = channel;
    putMember(fresh, "sampler", static_cast<int>(samplers.size()));
    samplers.push_back(writer.samplerOf(channel, keys));
    channels.push_back(std::move(fresh));
  }
  Json& json = source.document.item("animations", animation);
  putMember(json, "samplers", std::move(samplers));
  putMember(json, "channels", std::move(channels));
  return left;
}

std::vector<std::string> notesOfMotions(std::span<const RigClip> clips, std::size_t leftOut) {
  std::vector<std::string> notes;
  for (const RigClip& clip : clips) {
    const std::string named = " in " + jsonText(clip.motion);
    for (const std::string& note : clip.model.notes)
      if (note.find(named) != std::string::npos) notes.push_back(note);
  }
  if (leftOut > 0)
    notes.push_back(std::to_string(leftOut) +
                    " animation channels could not be cut to the baked length: left out");
  return notes;
}

}  // namespace fascia
