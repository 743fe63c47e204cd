#include <fascia/io/documents/character_codecs.h>

namespace fascia {
namespace {

Json pairSchema(Json item, const std::string& help) {
  Json out;
  out.set("type", "array");
  out.set("description", help);
  out.set("minItems", 2);
  out.set("maxItems", 2);
  out.set("items", std::move(item));
  return out;
}

bool expectPair(const Json& json, const JsonPath& path, Reading& reading) {
  if (json.is(Json::Kind::list) && json.list().size() == 2) return true;
  reading.unexpected(json, path, "a list of 2 numbers");
  return false;
}

CodecPtr<SkinQuantity> quantityCodec() {
  using Q = SkinQuantity;
  return words<Q>({{Q::density, "density"},
                   {Q::stretch_u, "stretch_u"},
                   {Q::stretch_v, "stretch_v"},
                   {Q::shear, "shear"},
                   {Q::bending, "bending"},
                   {Q::drag, "drag"},
                   {Q::prestretch, "prestretch"},
                   {Q::fat, "fat"},
                   {Q::tissue_stiffness, "tissue_stiffness"},
                   {Q::tissue_damping, "tissue_damping"},
                   {Q::tissue_rest_length, "tissue_rest_length"},
                   {Q::jiggle, "jiggle"},
                   {Q::muscle, "muscle"},
                   {Q::volume, "volume"},
                   {Q::tightness, "tightness"}});
}

CodecPtr<SkinEndDef> endCodec() {
  using Object = ObjectCodec<SkinEndDef>;
  auto codec = std::make_shared<Object>("An end of the tube: a small ring fixed to a joint.");
  codec
      ->field("joint", &SkinEndDef::joint, names(), "The joint that holds it",
              Object::Need::required)
      .field("position_m", &SkinEndDef::position_m, vectors({-1e6, 1e6}), "In the joint's frame")
      .field("axis", &SkinEndDef::axis, vectors({-1e6, 1e6}),
             "Towards the end, in the joint's frame; none: away from the other end")
      .field("radius_m", &SkinEndDef::radius_m, numbers({0, 1000}),
             "Of the ring; 0: 0.022 of the distance of the two ends");
  return codec;
}

CodecPtr<SkinMaterialDef> materialCodec() {
  using M = SkinMaterialDef;
  auto codec = std::make_shared<ObjectCodec<M>>("Per square metre of skin at rest.");
  codec
      ->field("density_kg_per_m2", &M::density_kg_per_m2, numbers({0.01, 1000}),
              "Heavier: more follow-through")
      .field("stretch_u_N_per_m", &M::stretch_u_N_per_m, numbers(positive(1e6)),
             "Stiffness around the tube")
      .field("stretch_v_N_per_m", &M::stretch_v_N_per_m, numbers(positive(1e6)),
             "Stiffness along the tube")
      .field("shear_N_per_m", &M::shear_N_per_m, numbers({0, 1e6}), "Stiffness against shear")
      .field("bending_Nm", &M::bending_Nm, numbers({0, 1e3}), "0: a pure membrane")
      .field("drag_Ns_per_m3", &M::drag_Ns_per_m3, numbers({0, 1e5}), "Damps all motion")
      .field("prestretch", &M::prestretch, numbers({0.5, 3}), "Above 1: a taut stocking")
      .field("max_stretch", &M::max_stretch, numbers({1.01, 4}),
             "Beyond it the stress no longer grows")
      .field("friction_per_s", &M::friction_per_s, numbers({0, 1e4}),
             "Rate at which sliding on flesh dies away")
      .field("restitution", &M::restitution, numbers({0, 1}), "Bounce off the flesh");
  return codec;
}

CodecPtr<SkinFatDef> fatCodec() {
  auto codec = std::make_shared<ObjectCodec<SkinFatDef>>("Between flesh and skin.");
  codec
      ->field("thickness_m", &SkinFatDef::thickness_m, numbers({0, 1}),
              "Its thickness; on a rig at most, and never more than lies between mesh and flesh")
      .field("compressible", &SkinFatDef::compressible, numbers({0, 0.95}),
             "Share of the thickness that pressing can take away")
      .field("bulk_Pa", &SkinFatDef::bulk_Pa, numbers({0, 1e5}),
             "Resistance of each solid's fat to a change of its volume");
  return codec;
}

CodecPtr<SkinTissueDef> tissueCodec() {
  using T = SkinTissueDef;
  auto codec = std::make_shared<ObjectCodec<T>>("The strands that hold the skin to the flesh.");
  codec
      ->field("stiffness_N_per_m3", &T::stiffness_N_per_m3, numbers({0, 1e8}),
              "Pull per metre beyond rest, per square metre")
      .field("damping_Ns_per_m3", &T::damping_Ns_per_m3, numbers({0, 1e6}),
             "Damping along a strand")
      .field("carry", &T::carry, numbers({0, 1}),
             "share of the flesh's changes of velocity that the skin takes over at once: 0 shakes "
             "like jelly, 1 not at all")
      .field("rest_length_m", &T::rest_length_m, optionally(numbers({0, 1})),
             "None: the length at attachment");
  return codec;
}

CodecPtr<SkinPoseDef> poseCodec() {
  using P = SkinPoseDef;
  auto codec = std::make_shared<ObjectCodec<P>>("How the rig's mesh follows its joints.");
  codec
      ->field("jiggle", &P::jiggle, numbers({0, 1}),
              "Flesh that moves by itself: 0 none, 0.5 as flesh is, 1 jelly")
      .field("muscle", &P::muscle, numbers({0, 1}),
             "Flexors that swell in a bend: 0 none, 0.3 natural, 1 bodybuilder")
      .field("volume", &P::volume, numbers({0, 1}),
             "Share of what a bend takes from a joint that comes out around it")
      .field("tightness", &P::tightness, numbers({0, 1}),
             "How far the skin evens out: 0 slack, 1 taut")
      .field("simulate", &P::simulate, booleans(),
             "Beyond the pose: elastic skin of the material and tissue here hangs on it");
  return codec;
}

CodecPtr<SkinRegionDef::Edit> editCodec() {
  using E = SkinRegionDef::Edit;
  using Object = ObjectCodec<E>;
  auto codec = std::make_shared<Object>("One quantity made different.");
  codec->field("quantity", &E::quantity, quantityCodec(), "What", Object::Need::required)
      .field(
          "mode", &E::mode,
          words<E::Mode>({{E::Mode::set, "set"}, {E::Mode::scale, "scale"}, {E::Mode::add, "add"}}),
          "Set to the value, multiply by it, or add it")
      .field("value", &E::value, numbers({-1e8, 1e8}), "In the quantity's SI unit; scale: a factor",
             Object::Need::required);
  return codec;
}

class RegionCodec final : public ObjectCodec<SkinRegionDef> {
 public:
  RegionCodec() : ObjectCodec("A named part of the skin, and what differs there.") {
    using R = SkinRegionDef;
    field("name", &R::name, names(), "The region's name", Need::required);
    field("solid", &R::solid, texts(200), "Instead of u and v: all points anchored to this solid");
    field("joint", &R::joint, texts(200), "Instead, on a rig: by the weights of this joint");
    field("feather", &R::feather, numbers({0, 0.5}), "Width of the smooth border in u and v");
    field("edits", &R::edits, listOf<R::Edit>(editCodec(), kMaxListed), "What differs");
  }

 protected:
  bool readOther(const Json&, const Json::Member& member, const JsonPath& path, Reading& reading,
                 SkinRegionDef& region) const override {
    const bool u = member.key == "u";
    if (!u && member.key != "v") return false;
    if (!expectPair(member.value, path, reading)) return true;
    readNumber(member.value.list()[0], path[0], reading, {0, 1}, u ? region.u_min : region.v_min);
    readNumber(member.value.list()[1], path[1], reading, {0, 1}, u ? region.u_max : region.v_max);
    return true;
  }
  void writeOthers(const SkinRegionDef& region, Json& out) const override {
    if (region.u_min != 0 || region.u_max != 1) {
      out.set("u", Json::List{region.u_min, region.u_max});
    }
    if (region.v_min != 0 || region.v_max != 1) {
      out.set("v", Json::List{region.v_min, region.v_max});
    }
  }
  void schemaOthers(Json& properties) const override {
    const Json item = NumberRange{0, 1}.schema();
    properties.set("u", pairSchema(item, "Around, [from, to] in 0 to 1; from > to wraps around"));
    properties.set("v",
                   pairSchema(item, "Along, [from, to] from the bottom end (0) to the top (1)"));
  }
};

CodecPtr<SkinBrushDef> brushCodec() {
  using B = SkinBrushDef;
  using Object = ObjectCodec<B>;
  auto codec = std::make_shared<Object>("A Gaussian dab on one quantity.");
  codec->field("quantity", &B::quantity, quantityCodec(), "What")
      .field("joint", &B::joint, names(), "In whose frame the centre is", Object::Need::required)
      .field("center_m", &B::center_m, vectors({-1e6, 1e6}), "In the joint's frame, rest posture")
      .field("radius_m", &B::radius_m, numbers(positive(1000)), "One standard deviation")
      .field("amount", &B::amount, numbers({-1e8, 1e8}), "Added at the centre; never below 0");
  return codec;
}

CodecPtr<SkinAnchorDef> anchorCodec() {
  using A = SkinAnchorDef;
  using Object = ObjectCodec<A>;
  auto codec = std::make_shared<Object>("One strand's end, moved by hand.");
  codec->field("u", &A::u, numbers({0, 1}), "Around", Object::Need::required)
      .field("v", &A::v, numbers({0, 1}), "Along", Object::Need::required)
      .field("solid", &A::solid, names(), "The solid it holds to", Object::Need::required)
      .field("position_m", &A::position_m, vectors({-1e6, 1e6}),
             "In the solid's frame; put onto its surface");
  return codec;
}

CodecPtr<SkinContactDef> contactCodec() {
  using C = SkinContactDef;
  auto codec = std::make_shared<ObjectCodec<C>>("The skin against itself.");
  codec->field("self", &C::self, booleans(), "Whether sheets of skin keep out of each other")
      .field("gap_m", &C::gap_m, numbers(positive(1)), "Kept between two of them");
  return codec;
}

CodecPtr<SkinPartDef> partCodec() {
  using P = SkinPartDef;
  using Object = ObjectCodec<P>;
  auto codec = std::make_shared<Object>("What becomes of a piece of the rig's mesh.");
  codec->field("name", &P::name, names(), "Of the mesh or of its material", Object::Need::required)
      .field("rigid", &P::rigid, booleans(), "Carried by its joints as it is");
  return codec;
}

class SkinCodec final : public ObjectCodec<SkinDef> {
 public:
  SkinCodec() : ObjectCodec("The elastic skin: the rig's mesh, or a tube between two joints.") {
    using S = SkinDef;
    field("bottom", &S::bottom, endCodec(), "The first row; none on a rig");
    field("top", &S::top, endCodec(), "The last row; none on a rig");
    field("material", &S::material, materialCodec(), "");
    field("fat", &S::fat, fatCodec(), "");
    field("tissue", &S::tissue, tissueCodec(), "");
    field("pose", &S::pose, poseCodec(), "");
    field("cling", &S::cling, numbers({0, 1}),
          "How far the skin follows hollows: 0 spans them like a stocking, 1 fills every valley");
    field("texture", &S::texture, texts(1000),
          "A PNG or JPEG in the folder of this file, or below it");
    field("color", &S::color, colorArrays(), "Where there is no texture");
    field("regions", &S::regions,
          listOf<SkinRegionDef>(std::make_shared<RegionCodec>(), kMaxListed), "Parts that differ");
    field("brushes", &S::brushes, listOf(brushCodec(), kMaxListed), "Dabs, in order");
    field("anchors", &S::anchors, listOf(anchorCodec(), kMaxListed), "Strands moved by hand");
    field("points", &S::points, optionally(skinPointsCodec()),
          "Values per point, row by row from the bottom, in place of the above; on a rig one row "
          "in the order of its points");
    field("contact", &S::contact, contactCodec(), "");
    field("parts", &S::parts, listOf(partCodec(), kMaxListed),
          "Pieces of the rig's mesh that are to stay as they are: armour, buckles");
  }

  Json write(const SkinDef& skin) const override {
    Json out = ObjectCodec::write(skin);
    const SkinDef standard;
    if (skin.columns != standard.columns || skin.rows != standard.rows) {
      Json::Object& members = out.object();
      members.insert(members.begin(), {"grid", Json::List{skin.columns, skin.rows}});
    }
    return out;
  }

 protected:
  bool readOther(const Json&, const Json::Member& member, const JsonPath& path, Reading& reading,
                 SkinDef& skin) const override {
    if (member.key != "grid") return false;
    if (!expectPair(member.value, path, reading)) return true;
    side_->read(member.value.list()[0], path[0], reading, skin.columns);
    side_->read(member.value.list()[1], path[1], reading, skin.rows);
    if (skin.columns > kMaxGridPoints / skin.rows) {
      reading.fault(member.value, path, "more than " + std::to_string(kMaxGridPoints) + " points");
    }
    return true;
  }
  void offerOthers(const Json&, NearestName& nearest) const override { nearest.offer("grid"); }
  void schemaOthers(Json& properties) const override {
    Json grid = pairSchema(side_->schema(), "[columns around, rows along]");
    grid.set("default", Json::List{SkinDef{}.columns, SkinDef{}.rows});
    properties.set("grid", std::move(grid));
  }

 private:
  CodecPtr<int> side_ = integers(8, kMaxGridSide);
};

}  // namespace

CodecPtr<SkinDef> skinCodec() {
  return std::make_shared<SkinCodec>();
}

}  // namespace fascia
