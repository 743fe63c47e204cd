#pragma once

#include <functional>
#include <span>
#include <string_view>

#include <fascia/io/rig_export/rig_source.h>

namespace fascia {

// The animation of the document that holds the baked motion.
struct BakedAnimation {
  int index = 0;
  float start_s = 0;         // of the recording's first frame, on the animation's clock
  int times = 0;             // accessor: of the recording's frames
  bool keepsJoints = false;  // the joints' channels are the file's own
  std::size_t leftOut = 0;   // channels of other things that could not be cut to the recording
};

// Finds the file's animation of the clip's name and keeps its channels, if the recording is of all
// of it and moved the joints as it does; where players would not show that, joints get keys of the
// recording. Otherwise writes the joints' motion: into that animation, whose other channels are cut
// or repeated to the recording's length, or into a new one.
BakedAnimation prepareAnimation(RigSource& source, const RigClip& clip);

// Linear keys at the recording's frames. type: "VEC3"; path: "translation", "rotation", "weights".
void addChannel(RigSource& source, const BakedAnimation& animation, int node, const char* path,
                std::span<const float> values, std::string_view type);

// The recorded weights of a node's own morph targets, in their order, frame by frame. `append`
// adds those of targets that a frame has beside them. Replaces what the animation did with them.
void addWeightChannel(
    RigSource& source, const RigClip& clip, const BakedAnimation& animation, int node,
    const std::function<void(std::size_t frame, std::vector<float>&)>& append = {});
// Those of all nodes whose targets the animation does not show as recorded already.
void addWeightChannels(RigSource& source, const RigClip& clip, const BakedAnimation& animation);

// Rotation and translation keys; neighbouring rotations turn the short way.
void addRigidChannels(RigSource& source, const BakedAnimation& animation, int node,
                      std::span<const Transform> local);

// The animation's index as the importer named them; -1: none.
int animationNamed(const RigSource& source, const std::string& name);

}  // namespace fascia
