#include <algorithm>

#include <fascia/character/editing.h>

namespace fascia {
namespace {

template <class List>
bool hasName(const List& list, const std::string& name) {
  return std::ranges::any_of(list, [&](const auto& item) { return item.name == name; });
}

template <class List>
void requireRenamable(const List& list, const char* kind, const std::string& from,
                      const std::string& to) {
  if (!hasName(list, from))
    throw Error(std::string("found no ") + kind + " named '" + from + "' to rename");
  if (to.empty()) throw Error(std::string("a ") + kind + " needs a name: found an empty one");
  if (from != to && hasName(list, to))
    throw Error(std::string("there is a ") + kind + " named '" + to + "' already");
}

// Replaces one name by another wherever it stands.
class Renaming {
 public:
  Renaming(const std::string& from, const std::string& to) : from_(from), to_(to) {}
  void operator()(std::string& name) const {
    if (name == from_) name = to_;
  }
  void inTracks(CharacterDef& def, TrackDef::Target target) const {
    for (MotionDef& motion : def.motions)
      for (TrackDef& track : motion.tracks)
        if (track.target == target) (*this)(track.name);
  }

 private:
  std::string from_, to_;  // own: the arguments may be parts of the definition
};

// The rig's file goes on to call it as it does.
void renameInRig(RigDef& rig, const std::string& from, const std::string& to) {
  const auto renamed = std::ranges::find(rig.joint_names, from, &RigJointNameDef::name);
  if (renamed != rig.joint_names.end()) {
    renamed->name = to;
    if (renamed->joint == to) rig.joint_names.erase(renamed);
    return;
  }
  if (!rig.model) throw Error("the rig has to be read before joints are renamed");
  const auto isRenamed = [&](const RigJointNameDef& name) { return name.joint == from; };
  if (hasName(rig.model->joints, from) && from != to &&
      std::ranges::none_of(rig.joint_names, isRenamed))
    rig.joint_names.push_back({from, to});
}

}  // namespace

void renameJoint(CharacterDef& def, const std::string& from, const std::string& to) {
  requireRenamable(def.skeleton.joints, "joint", from, to);
  const Renaming rename(from, to);
  if (def.rig) renameInRig(*def.rig, from, to);
  for (JointDef& joint : def.skeleton.joints) rename(joint.name), rename(joint.parent);
  for (FleshDef* flesh : {&def.flesh, &def.ornaments})
    for (FleshSolidDef& solid : flesh->solids) {
      rename(solid.joint);
      for (DriverDef& driver : solid.drivers) rename(driver.joint);
    }
  rename.inTracks(def, TrackDef::Target::joint);
  if (!def.skin) return;
  rename(def.skin->grid.bottom.joint), rename(def.skin->grid.top.joint);
  for (SkinBrushDef& brush : def.skin->brushes) rename(brush.joint);
  for (SkinRegionDef& region : def.skin->regions) rename(region.joint);
}

void renameSolid(CharacterDef& def, const std::string& from, const std::string& to) {
  requireRenamable(def.flesh.solids, "solid", from, to);
  const Renaming rename(from, to);
  for (FleshSolidDef& solid : def.flesh.solids) rename(solid.name);
  rename.inTracks(def, TrackDef::Target::solid);
  if (!def.skin) return;
  for (SkinRegionDef& region : def.skin->regions) rename(region.solid);
  for (SkinAnchorDef& anchor : def.skin->grid.anchors) rename(anchor.solid);
}

}  // namespace fascia
