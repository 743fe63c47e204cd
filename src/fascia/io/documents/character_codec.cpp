#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

// Our definitions keep their lists in a structure; files have the lists directly.
template <class Outer, class Item>
class UnwrappedList final : public Codec<Outer> {
 public:
  UnwrappedList(std::vector<Item> Outer::*list, CodecPtr<std::vector<Item>> codec)
      : list_(list), codec_(std::move(codec)) {}
  void read(const Json& json, const JsonPath& path, Reading& reading, Outer& value) const override {
    codec_->read(json, path, reading, value.*list_);
  }
  Json write(const Outer& value) const override { return codec_->write(value.*list_); }
  Json schema() const override { return codec_->schema(); }
  bool same(const Outer& a, const Outer& b) const override {
    return codec_->same(a.*list_, b.*list_);
  }

 private:
  std::vector<Item> Outer::*list_;
  CodecPtr<std::vector<Item>> codec_;
};

CodecPtr<FleshDef> fleshCodec() {
  return std::make_shared<UnwrappedList<FleshDef, FleshSolidDef>>(
      &FleshDef::solids, listOf(solidCodec(), kMostSolids));
}

CodecPtr<SkeletonDef> skeletonCodec() {
  return std::make_shared<UnwrappedList<SkeletonDef, JointDef>>(&SkeletonDef::joints,
                                                                listOf(jointCodec(), kMostJoints));
}

CodecPtr<RigJointNameDef> jointNameCodec() {
  using N = RigJointNameDef;
  using Object = ObjectCodec<N>;
  auto codec = std::make_shared<Object>("A joint that is called otherwise here.");
  codec->field("joint", &N::joint, names(), "Its name in the rig's file", Object::Need::required)
      .field("name", &N::name, names(), "Its name in the skeleton", Object::Need::required);
  return codec;
}

CodecPtr<RigDef> rigCodec() {
  using Object = ObjectCodec<RigDef>;
  auto codec = std::make_shared<Object>("A skinned mesh from a file: the skin instead of a grid.");
  codec->field("file", &RigDef::file, names(),
               "glTF or GLB in the folder of this file, or below it", Object::Need::required);
  addTunables<RigDef>(*codec);
  codec->field("joint_names", &RigDef::joint_names, listOf(jointNameCodec(), kMostJoints),
               "Joints that the skeleton calls otherwise than the rig's file");
  return codec;
}

// What a skin holds depends on where its surface comes from: a rig, the solids, or a grid between
// two ends.
class CharacterCodec final : public ObjectCodec<CharacterDef> {
 public:
  using ObjectCodec::ObjectCodec;

  void read(const Json& json, const JsonPath& path, Reading& reading,
            CharacterDef& def) const override {
    ObjectCodec::read(json, path, reading, def);
    const Json* skin = json.find("skin");
    if (!skin || !skin->is(Json::Kind::object)) return;
    const JsonPath at = path["skin"];
    const SkinKeys& keys = json.find("rig") ? onRig_ : skin->find("surface") ? onSurface_ : onGrid_;
    for (const char* key : keys.needed)
      if (!skin->find(key))
        reading.fault(*skin, at, "the key " + shown(key) + " is missing",
                      "where the skin's tube ends; not needed with \"rig\" or \"surface\"");
    for (const char* key : keys.surplus)
      if (const Json* surplus = skin->find(key))
        reading.fault(*surplus, at[key], shown(key) + keys.surplusText, keys.hint);
  }

  Json schema() const override {
    Json out = ObjectCodec::schema();
    Json onRig = requiring({"rig"}), onSolids;
    onRig.set("properties", Json::Object{{"skin", withoutAny(onRig_.surplus)}});
    Json surface = withoutAny(onSurface_.surplus), grid = withoutAny(onGrid_.surplus);
    surface.set("required", Json::List{"surface"});
    grid.set("required", listOfTexts(onGrid_.needed));
    onSolids.set("not", requiring({"rig"}));
    onSolids.set(
        "properties",
        Json::Object{
            {"skin", Json::Object{{"anyOf", Json::List{std::move(surface), std::move(grid)}}}}});
    out.set("anyOf", Json::List{std::move(onRig), std::move(onSolids)});
    return out;
  }

 private:
  using Keys = std::vector<const char*>;
  struct SkinKeys {
    Keys needed, surplus;
    const char* surplusText;  // after the key
    const char* hint;
  };
  const SkinKeys onRig_{{},
                        {"grid", "bottom", "top", "surface"},
                        " does not go with \"rig\"",
                        "the rig's mesh is the skin"};
  const SkinKeys onSurface_{{},
                            {"grid", "bottom", "top", "parts"},
                            " does not go with \"surface\"",
                            "this skin has no ends and no pieces"};
  const SkinKeys onGrid_{
      {"bottom", "top"}, {"parts", "surface"}, " needs a \"rig\"", "a grid has no pieces"};

  static Json::List listOfTexts(const Keys& keys) { return Json::List(keys.begin(), keys.end()); }
  static Json requiring(const Keys& keys) { return Json::Object{{"required", listOfTexts(keys)}}; }
  static Json withoutAny(const Keys& keys) {
    Json::List each;
    for (const char* key : keys) each.push_back(requiring({key}));
    return Json::Object{{"not", Json::Object{{"anyOf", std::move(each)}}}};
  }
};

}  // namespace

CodecPtr<SimulationDef> simulationCodec() {
  using S = SimulationDef;
  auto codec = std::make_shared<ObjectCodec<S>>("How time passes.");
  addTunables<S>(*codec);
  return codec;
}

CodecPtr<CharacterDef> characterCodec() {
  using C = CharacterDef;
  using Object = ObjectCodec<C>;
  auto codec = std::make_shared<CharacterCodec>(
      "A layered elastic character: skeleton, flesh, fat, tissue, skin. Metres, kilograms, "
      "seconds; "
      "angles in degrees; y is up.");
  codec->field("name", &C::name, names(), "The character's name", Object::Need::required)
      .field("description", &C::description, texts(100'000), "For people")
      .field("skeleton", &C::skeleton, skeletonCodec(), "Joints, parents before children",
             Object::Need::required)
      .field("solids", &C::flesh, fleshCodec(), "Bones and muscles: what the skin lies on")
      .field("ornaments", &C::ornaments, fleshCodec(),
             "Seen, but not felt by the skin: eyes, beak, claws")
      .field("rig", &C::rig, optionally(rigCodec()), "")
      .field("skin", &C::skin, optionally(skinCodec()), "")
      .field("motions", &C::motions, listOf(motionCodec(), kMaxListed), "What it can do")
      .field("simulation", &C::simulation, simulationCodec(), "");
  return codec;
}

}  // namespace fascia
