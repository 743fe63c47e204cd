#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

Json pairSchema(Json item, std::string_view help) {
  Json out;
  out.set("type", "array");
  out.set("description", std::string(help));
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
  codec->field("joint", &SkinEndDef::joint, names(), "The joint that holds it",
               Object::Need::required);
  addTunables<SkinEndDef>(*codec);
  return codec;
}

// An object of nothing but the rows of its table.
template <class T>
CodecPtr<T> tunablesCodec(const char* help) {
  auto codec = std::make_shared<ObjectCodec<T>>(help);
  addTunables<T>(*codec);
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
          "Set to the value, multiply by it, or add it");
  addTunables<E>(*codec);
  return codec;
}

class RegionCodec final : public ObjectCodec<SkinRegionDef> {
 public:
  RegionCodec() : ObjectCodec("A named part of the skin, and what differs there.") {
    using R = SkinRegionDef;
    field("name", &R::name, names(), "The region's name", Need::required);
    field("solid", &R::solid, texts(200), "Instead of u and v: all points anchored to this solid");
    field("joint", &R::joint, texts(200), "Instead, on a rig: by the weights of this joint");
    addTunables<R>(*this);
    field("edits", &R::edits, listOf<R::Edit>(editCodec(), kMaxListed), "What differs");
  }

 protected:
  bool readOther(const Json&, const Json::Member& member, const JsonPath& path, Reading& reading,
                 SkinRegionDef& region) const override {
    const bool u = member.key == "u";
    if (!u && member.key != "v") return false;
    if (!expectPair(member.value, path, reading)) return true;
    const NumberRange& range = u ? kRegionU.range : kRegionV.range;
    readNumber(member.value.list()[0], path[0], reading, range, u ? region.u_min : region.v_min);
    readNumber(member.value.list()[1], path[1], reading, range, u ? region.u_max : region.v_max);
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
    for (const TunableInfo& row : {kRegionU, kRegionV})
      properties.set(std::string(row.key), pairSchema(numberSchema(row.range), row.help));
  }
};

CodecPtr<SkinBrushDef> brushCodec() {
  using B = SkinBrushDef;
  using Object = ObjectCodec<B>;
  auto codec = std::make_shared<Object>("A Gaussian dab on one quantity.");
  codec->field("quantity", &B::quantity, quantityCodec(), "What")
      .field("joint", &B::joint, names(), "In whose frame the centre is", Object::Need::required);
  addTunables<B>(*codec);
  return codec;
}

CodecPtr<SkinAnchorDef> anchorCodec() {
  using A = SkinAnchorDef;
  using Object = ObjectCodec<A>;
  auto codec = std::make_shared<Object>("One strand's end, moved by hand.");
  addTunables<A>(*codec);
  codec->field("solid", &A::solid, names(), "The solid it holds to", Object::Need::required);
  return codec;
}

CodecPtr<SkinPartDef> partCodec() {
  using P = SkinPartDef;
  using Object = ObjectCodec<P>;
  auto codec = std::make_shared<Object>("What becomes of a piece of the rig's mesh.");
  codec->field("name", &P::name, names(), "Of the mesh or of its material", Object::Need::required);
  addTunables<P>(*codec);
  return codec;
}

class SkinCodec final : public ObjectCodec<SkinDef> {
 public:
  SkinCodec() : ObjectCodec("The elastic skin: the rig's mesh, or a tube between two joints.") {
    using S = SkinDef;
    field("bottom", &S::grid, &SkinGridDef::bottom, endCodec(), "The first row; none on a rig");
    field("top", &S::grid, &SkinGridDef::top, endCodec(), "The last row; none on a rig");
    field("material", &S::material,
          tunablesCodec<SkinMaterialDef>("Per square metre of skin at rest."), "");
    field("fat", &S::fat, tunablesCodec<SkinFatDef>("Between flesh and skin."), "");
    field("tissue", &S::tissue,
          tunablesCodec<SkinTissueDef>("The strands that hold the skin to the flesh."), "");
    field("pose", &S::mesh, &SkinMeshDef::pose,
          tunablesCodec<SkinPoseDef>("How the rig's mesh follows its joints."), "");
    addTunables(*this, &S::grid);
    field("texture", &S::texture, texts(1000),
          "A PNG or JPEG in the folder of this file, or below it");
    field("color", &S::color, colorArrays(), "Where there is no texture");
    field("regions", &S::regions,
          listOf<SkinRegionDef>(std::make_shared<RegionCodec>(), kMaxListed), "Parts that differ");
    field("brushes", &S::brushes, listOf(brushCodec(), kMaxListed), "Dabs, in order");
    field("anchors", &S::grid, &SkinGridDef::anchors, listOf(anchorCodec(), kMaxListed),
          "Strands moved by hand");
    field("points", &S::points, optionally(skinPointsCodec()),
          "Values per point, row by row from the bottom, in place of the above; on a rig one row "
          "in the order of its points");
    field("contact", &S::contact, tunablesCodec<SkinContactDef>("The skin against itself."), "");
    field("parts", &S::mesh, &SkinMeshDef::parts, listOf(partCodec(), kMaxListed),
          "Pieces of the rig's mesh that are to stay as they are: armour, buckles");
  }

  Json write(const SkinDef& skin) const override {
    Json out = ObjectCodec::write(skin);
    const SkinGridDef standard;
    if (skin.grid.columns != standard.columns || skin.grid.rows != standard.rows) {
      Json::Object& members = out.object();
      members.insert(members.begin(), {"grid", Json::List{skin.grid.columns, skin.grid.rows}});
    }
    return out;
  }

 protected:
  bool readOther(const Json&, const Json::Member& member, const JsonPath& path, Reading& reading,
                 SkinDef& skin) const override {
    if (member.key != "grid") return false;
    if (!expectPair(member.value, path, reading)) return true;
    side_->read(member.value.list()[0], path[0], reading, skin.grid.columns);
    side_->read(member.value.list()[1], path[1], reading, skin.grid.rows);
    if (skin.grid.columns > kMostGridPoints / skin.grid.rows) {
      reading.fault(member.value, path, "more than " + std::to_string(kMostGridPoints) + " points");
    }
    return true;
  }
  void offerOthers(const Json&, NearestName& nearest) const override { nearest.offer("grid"); }
  void schemaOthers(Json& properties) const override {
    Json grid = pairSchema(side_->schema(), kGridSide.help);
    grid.set("default", Json::List{SkinGridDef{}.columns, SkinGridDef{}.rows});
    properties.set("grid", std::move(grid));
  }

 private:
  CodecPtr<int> side_ = integers(kGridSide.range);
};

}  // namespace

CodecPtr<SkinDef> skinCodec() {
  return std::make_shared<SkinCodec>();
}

}  // namespace fascia
