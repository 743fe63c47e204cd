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

CodecPtr<RigDef> rigCodec() {
  using Object = ObjectCodec<RigDef>;
  auto codec = std::make_shared<Object>("A skinned mesh from a file: the skin instead of a grid.");
  codec->field("file", &RigDef::file, names(),
               "glTF or GLB in the folder of this file, or below it", Object::Need::required);
  addTunables<RigDef>(*codec);
  return codec;
}

// What a skin holds depends on where its surface comes from: a rig, or a grid between two ends.
class CharacterCodec final : public ObjectCodec<CharacterDef> {
 public:
  using ObjectCodec::ObjectCodec;

  void read(const Json& json, const JsonPath& path, Reading& reading,
            CharacterDef& def) const override {
    ObjectCodec::read(json, path, reading, def);
    const Json* skin = json.find("skin");
    if (!skin || !skin->is(Json::Kind::object)) return;
    const JsonPath at = path["skin"];
    const bool onRig = json.find("rig");
    if (!onRig)
      for (const char* key : kEnds)
        if (!skin->find(key))
          reading.fault(*skin, at, "the key " + shown(key) + " is missing",
                        "where the skin's tube ends; not needed with \"rig\"");
    for (const char* key : onRig ? kOfGrids : kOfRigs)
      if (const Json* surplus = skin->find(key))
        reading.fault(*surplus, at[key],
                      shown(key) + (onRig ? " does not go with \"rig\"" : " needs a \"rig\""),
                      onRig ? "the rig's mesh is the skin" : "a grid has no pieces");
  }

  Json schema() const override {
    Json out = ObjectCodec::schema();
    Json onRig = requiring({"rig"}), onGrid;
    onRig.set("properties", Json::Object{{"skin", withoutAny(kOfGrids)}});
    Json grid = withoutAny(kOfRigs);
    grid.set("required", listOfTexts(kEnds));
    onGrid.set("not", requiring({"rig"}));
    onGrid.set("properties", Json::Object{{"skin", std::move(grid)}});
    out.set("anyOf", Json::List{std::move(onRig), std::move(onGrid)});
    return out;
  }

 private:
  using Keys = std::initializer_list<const char*>;
  static constexpr Keys kEnds = {"bottom", "top"}, kOfGrids = {"grid", "bottom", "top"},
                        kOfRigs = {"parts"};

  static Json::List listOfTexts(Keys keys) { return Json::List(keys.begin(), keys.end()); }
  static Json requiring(Keys keys) { return Json::Object{{"required", listOfTexts(keys)}}; }
  static Json withoutAny(Keys keys) {
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
