#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/base/suggest.h>
#include <fascia/skin/resample.h>
#include <fascia/skin/skin.h>
#include <fascia/skin/wrap.h>

namespace fascia {
namespace {

constexpr int kMinSide = 8, kMaxSide = 4096;
// Share of the skin's mass that the automatic step may add to points whose cells are much smaller
// than the rest (the rings at the ends): below this no one sees a difference.
constexpr double kAddedMassShare = 0.02;
// Radius of an end ring that the file leaves open, over the distance of the ends. The same at every
// resolution: a membrane held at a mere point would stretch without bound there.
constexpr double kEndRadius = 0.022;
// A skin whose waves need shorter steps than this rides on a coarse one with about so many points.
constexpr double kFinestStep_s = 0.4e-3;
constexpr std::size_t kCoarsePoints = 1200;

Vec3 pointAt(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}

// 1 inside [low, high], falling to 0 over `feather` outside of it; low > high wraps around.
double inRange(double x, double low, double high, double feather, bool periodic) {
  const auto outsideBy = [&](double t) {
    if (low <= high) return std::max({0.0, low - t, t - high});
    return std::max(0.0, std::min(low - t, t - high));
  };
  double distance = outsideBy(x);
  if (periodic && low <= high) distance = std::min({distance, outsideBy(x - 1), outsideBy(x + 1)});
  if (distance <= 0) return 1;
  if (distance >= feather) return 0;
  const double t = 1 - distance / feather;
  return t * t * (3 - 2 * t);
}

struct NearestFlesh {
  float distance = std::numeric_limits<float>::max();
  SolidId solid;
  Vec3 normal = Vec3::UnitY();
};

NearestFlesh nearestFlesh(const Field& field, const Vec3& p) {
  const float x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
              z = static_cast<float>(p.z());
  NearestFlesh best;
  for (std::size_t s = 0; s < field.solidCount(); ++s) {
    const SolidId solid(static_cast<std::int64_t>(s));
    float d, nx, ny, nz;
    field.evaluate(solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
    if (d < best.distance) best = {d, solid, Vec3(nx, ny, nz)};
  }
  return best;
}

}  // namespace

// Builds a Skin step by step; each step reads only what the ones before it made.
class SkinBuilder {
 public:
  SkinBuilder(Skin& skin, const SkinDef& def, const SkinBase& base, std::string pointer,
              Diagnostics& diagnostics)
      : skin_(skin),
        def_(def),
        base_(base),
        pointer_(std::move(pointer)),
        diagnostics_(diagnostics) {}

  void build() {
    checkValues();
    EndRing bottom, top;
    if (def_.columns < kMinSide || def_.columns > kMaxSide || def_.rows < kMinSide ||
        def_.rows > kMaxSide)
      return;
    skin_.layout_ = {def_.columns, def_.rows, true};
    if (!checkPoints() || !findEnds(bottom, top)) return;
    makeRestShape(bottom, top);
    placeCarriers();
    setQuantities();
    attach();
    applyEdits();
    makeModel();
    // Without strands nothing draws the two grids together again when they drift apart.
    if (skin_.settings_.integrator == "auto" && def_.tissue.stiffness_N_per_m3 > 0 &&
        skin_.defaultStep_s_ < kFinestStep_s && skin_.pointCount() >= 2 * kCoarsePoints)
      makeCoarse();
  }

 private:
  void error(const std::string& where, std::string message, std::string hint = {}) {
    diagnostics_.error(pointer_ + where, std::move(message), std::move(hint));
  }
  void checkRange(const std::string& where, double value, double low, double high) {
    if (value >= low && value <= high) return;  // false for NaN
    error(where, "found " + std::to_string(value) + ", expected a number from " +
                     std::to_string(low) + " to " + std::to_string(high));
  }

  void checkValues() {
    for (const auto& [side, where] : {std::pair{def_.columns, "/grid/0"}, {def_.rows, "/grid/1"}})
      if (side < kMinSide || side > kMaxSide)
        error(where,
              "found " + std::to_string(side) + ", expected a whole number from " +
                  std::to_string(kMinSide) + " to " + std::to_string(kMaxSide),
              "columns around the body, rows along it");
    static constexpr std::pair<SkinQuantity, const char*> kWhere[] = {
        {SkinQuantity::density, "/material/density_kg_per_m2"},
        {SkinQuantity::stretch_u, "/material/stretch_u_N_per_m"},
        {SkinQuantity::stretch_v, "/material/stretch_v_N_per_m"},
        {SkinQuantity::shear, "/material/shear_N_per_m"},
        {SkinQuantity::bending, "/material/bending_Nm"},
        {SkinQuantity::drag, "/material/drag_Ns_per_m3"},
        {SkinQuantity::prestretch, "/material/prestretch"},
        {SkinQuantity::fat, "/fat/thickness_m"},
        {SkinQuantity::tissue_stiffness, "/tissue/stiffness_N_per_m3"},
        {SkinQuantity::tissue_damping, "/tissue/damping_Ns_per_m3"},
        {SkinQuantity::tissue_rest_length, "/tissue/rest_length_m"}};
    for (const auto& [quantity, where] : kWhere)
      checkRange(where, uniformValue(def_, quantity), info(quantity).min, info(quantity).max);
    checkRange("/material/max_stretch", def_.material.max_stretch, 1.01, 4);
    checkRange("/material/friction_per_s", def_.material.friction_per_s, 0, 1e4);
    checkRange("/material/restitution", def_.material.restitution, 0, 1);
    checkRange("/cling", def_.cling, 0, 1);
    for (std::size_t i = 0; i < def_.brushes.size(); ++i)
      checkRange("/brushes/" + std::to_string(i) + "/radius_m", def_.brushes[i].radius_m, 1e-6,
                 1e6);
  }

  // A saved skin brings all or nothing of its rest shape, and lists of the right length.
  bool checkPoints() {
    if (!def_.points) return true;
    const SkinPointsDef& p = *def_.points;
    if (p.columns < kMinSide || p.columns > kMaxSide || p.rows < kMinSide || p.rows > kMaxSide) {
      error("/points/grid", "found a grid of " + std::to_string(p.columns) + " x " +
                                std::to_string(p.rows) + ", expected sides from 8 to 4096");
      return false;
    }
    const std::size_t count =
        static_cast<std::size_t>(p.columns) * static_cast<std::size_t>(p.rows);
    bool ok = true;
    const auto check = [&](std::size_t size, std::string_view name) {
      if (size == 0 || size == count) return;
      error("/points/" + std::string(name), "found " + std::to_string(size) + " values, expected " +
                                                std::to_string(count) +
                                                " (columns x rows) or none");
      ok = false;
    };
    for (const QuantityInfo& i : quantityInfos()) {
      const std::vector<float>& values = pointValues(p, i.quantity);
      check(values.size(), i.name);
      for (const float v : values) {
        if (v >= static_cast<float>(i.min) && v <= static_cast<float>(i.max)) continue;
        checkRange("/points/" + std::string(i.name), v, i.min, i.max);
        ok = false;
        break;
      }
    }
    check(p.anchor_solid.size(), "anchor_solid");
    check(p.anchor.size(), "anchor");
    check(p.rest_position_m.size(), "rest_position_m");
    if (p.anchor.size() != p.anchor_solid.size()) {
      error("/points/anchor", "found anchors without their solids", "give both lists or none");
      ok = false;
    }
    const auto finite = [](const std::array<float, 3>& v) {
      return std::all_of(v.begin(), v.end(), [](float c) { return std::abs(c) < 1e6f; });
    };
    if (!std::all_of(p.rest_position_m.begin(), p.rest_position_m.end(), finite) ||
        !std::all_of(p.anchor.begin(), p.anchor.end(), finite)) {
      error("/points", "found a coordinate beyond 1e6", "metres are meant");
      ok = false;
    }
    for (const int s : p.anchor_solid) {
      if (s >= -1 && s < static_cast<int>(base_.flesh.solidCount())) continue;
      error("/points/anchor_solid", "found solid number " + std::to_string(s) + ", there are " +
                                        std::to_string(base_.flesh.solidCount()));
      return false;
    }
    return ok;
  }

  bool findEnds(EndRing& bottom, EndRing& top) {
    if (base_.flesh.solidCount() == 0) {
      error("", "found a skin, but no solids for it to lie on", "add at least one solid");
      return false;
    }
    const JointId joints[2] = {findJoint("/bottom/joint", def_.bottom.joint),
                               findJoint("/top/joint", def_.top.joint)};
    if (!joints[0].valid() || !joints[1].valid()) return false;
    const SkinEndDef* ends[2] = {&def_.bottom, &def_.top};
    Vec3 origin[2];
    for (int e = 0; e < 2; ++e)
      origin[e] = base_.posedSkeleton.joint_world[joints[e].index()].point(ends[e]->position_m);
    EndRing* rings[2] = {&bottom, &top};
    for (int e = 0; e < 2; ++e) {
      Vec3 axis = ends[e]->axis.norm() > 0
                      ? base_.posedSkeleton.joint_world[joints[e].index()].vector(ends[e]->axis)
                      : Vec3(origin[e] - origin[1 - e]);
      if (!(axis.norm() > 1e-9)) axis = e == 0 ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitY());
      rings[e]->axis = axis.normalized();
      rings[e]->center_m =
          exitPoint(base_.posedFlesh, origin[e], rings[e]->axis, def_.fat.thickness_m);
      joint_[e] = joints[e];
    }
    const double length = (top.center_m - bottom.center_m).norm();
    for (int e = 0; e < 2; ++e) {
      rings[e]->radius_m = ends[e]->radius_m > 0 ? ends[e]->radius_m : kEndRadius * length;
      if (rings[e]->radius_m > 1e-6) continue;
      error(e == 0 ? "/bottom" : "/top", "found both ends of the skin in the same place",
            "fix the ends to different joints, or give them different axes");
      return false;
    }
    return true;
  }

  JointId findJoint(const std::string& where, const std::string& name) {
    const JointId id = base_.skeleton.find(name);
    if (!id.valid()) {
      std::vector<std::string_view> names;
      for (std::size_t i = 0; i < base_.skeleton.jointCount(); ++i)
        names.push_back(base_.skeleton.joint(JointId(static_cast<std::int64_t>(i))).name);
      error(where, "found no joint named '" + name + "'", didYouMean(name, names));
    }
    return id;
  }

  void makeRestShape(const EndRing& bottom, const EndRing& top) {
    const GridLayout& g = skin_.layout_;
    if (def_.points && !def_.points->rest_position_m.empty()) {
      const GridLayout saved = savedLayout();
      VectorArray r(saved.storage());
      forEachSaved([&](std::size_t p, std::size_t k) {
        const auto& v = def_.points->rest_position_m[p];
        r.x[k] = v[0], r.y[k] = v[1], r.z[k] = v[2];
      });
      fillPads(saved, r);
      skin_.rest_ = sameGrid() ? r : resample(saved, r, g);
    } else {
      skin_.rest_ =
          shrinkWrap(base_.posedFlesh, g, bottom, top, {def_.fat.thickness_m, def_.cling});
    }
    Box box;
    forEachPoint([&](int, int, std::size_t k) { box.add(pointAt(skin_.rest_, k)); });
    skin_.size_m_ = std::max(1e-6, box.size().norm());
  }

  GridLayout savedLayout() const { return {def_.points->columns, def_.points->rows, true}; }
  bool sameGrid() const {
    return def_.points->columns == skin_.columns() && def_.points->rows == skin_.rows();
  }
  template <class Visit>
  void forEachSaved(const Visit& visit) const {
    const GridLayout saved = savedLayout();
    for (int j = 0; j < saved.rows; ++j)
      for (int i = 0; i < saved.columns; ++i)
        visit(static_cast<std::size_t>(j * saved.columns + i), saved.at(i, j));
  }
  template <class Visit>
  void forEachPoint(const Visit& visit) const {
    for (int j = 0; j < skin_.rows(); ++j)
      for (int i = 0; i < skin_.columns(); ++i) visit(i, j, skin_.layout_.at(i, j));
  }

  void placeCarriers() {
    std::vector<TissueAnchors::Anchor> carriers;
    forEachPoint([&](int, int, std::size_t k) {
      const Vec3 p = pointAt(skin_.rest_, k);
      const SolidId solid = nearestFlesh(base_.posedFlesh, p).solid;
      carriers.push_back({k, solid, base_.posedFlesh.materialFromWorld(solid, p)});
    });
    skin_.carriers_ = TissueAnchors(std::move(carriers));
  }

  void setQuantities() {
    const GridLayout& g = skin_.layout_;
    for (const QuantityInfo& i : quantityInfos()) {
      FloatArray& values = skin_.quantities_[i.quantity];
      values.assign(g.storage(), static_cast<float>(uniformValue(def_, i.quantity)));
      if (!def_.points || pointValues(*def_.points, i.quantity).empty()) continue;
      const std::vector<float>& saved = pointValues(*def_.points, i.quantity);
      FloatArray stored(savedLayout().storage());
      forEachSaved([&](std::size_t p, std::size_t k) { stored[k] = saved[p]; });
      values = sameGrid() ? stored : resample(savedLayout(), stored, g);
    }
  }

  // "Attach all" (spec L14): every point to the nearest flesh along its inward normal, or to the
  // nearest flesh at all where the normal misses.
  void attach() {
    VectorArray normals(skin_.layout_.storage());
    gridNormals(skin_.layout_, skin_.rest_, 0, skin_.rows(), normals);
    const bool saved = def_.points && !def_.points->anchor.empty() && sameGrid();
    const bool natural =
        !def_.tissue.rest_length_m && !(def_.points && !def_.points->tissue_rest_length.empty());
    std::vector<TissueAnchors::Anchor> anchors;
    FloatArray& restLength = skin_.quantities_[SkinQuantity::tissue_rest_length];
    for (int j = 1; j + 1 < skin_.rows(); ++j) {
      for (int i = 0; i < skin_.columns(); ++i) {
        const std::size_t k = skin_.layout_.at(i, j);
        TissueAnchors::Anchor anchor{k, SolidId(), Vec3::Zero()};
        if (saved) {
          const auto p = static_cast<std::size_t>(j * skin_.columns() + i);
          anchor.solid = SolidId(def_.points->anchor_solid[p]);
          const auto& m = def_.points->anchor[p];
          anchor.material = Vec3(m[0], m[1], m[2]);
        } else {
          const Vec3 hit = alongNormal(pointAt(skin_.rest_, k), pointAt(normals, k), anchor.solid);
          anchor.material = base_.posedFlesh.materialFromWorld(anchor.solid, hit);
        }
        overrideAnchor(i, j, anchor);
        if (!anchor.solid.valid()) continue;
        if (natural) {
          const Vec3 inner = base_.posedFlesh.worldFromMaterial(anchor.solid, anchor.material);
          restLength[k] = static_cast<float>((pointAt(skin_.rest_, k) - inner).norm());
        }
        anchors.push_back(anchor);
      }
    }
    skin_.anchors_ = TissueAnchors(std::move(anchors));
  }

  Vec3 alongNormal(const Vec3& from, const Vec3& normal, SolidId& solid) const {
    const NearestFlesh start = nearestFlesh(base_.posedFlesh, from);
    constexpr double kTouch_m = 1e-4;
    constexpr int kSteps = 64;
    // A strand much longer than the shortest one would cross the body.
    const double reach = 4 * std::max<double>(start.distance, kTouch_m) + def_.fat.thickness_m;
    double t = 0;
    for (int step = 0; step < kSteps && t <= reach; ++step) {
      const NearestFlesh here = nearestFlesh(base_.posedFlesh, from - t * normal);
      solid = here.solid;
      if (here.distance < kTouch_m) return from - t * normal - here.distance * here.normal;
      t += here.distance;
    }
    solid = start.solid;
    return from - start.distance * start.normal;
  }

  void overrideAnchor(int i, int j, TissueAnchors::Anchor& anchor) {
    for (const SkinAnchorDef& a : def_.anchors) {
      const int column = skin_.layout_.wrapped(
          static_cast<int>(std::lround(a.u * skin_.columns())) % skin_.columns());
      const int row = static_cast<int>(std::lround(a.v * (skin_.rows() - 1)));
      if (column != i || row != j) continue;
      anchor.solid = base_.flesh.find(a.solid);
      if (!anchor.solid.valid()) continue;  // reported by applyEdits
      const Vec3 world = base_.posedFlesh.frame(anchor.solid).point(a.position_m);
      const float x = static_cast<float>(world.x()), y = static_cast<float>(world.y()),
                  z = static_cast<float>(world.z());
      float d, nx, ny, nz;
      base_.posedFlesh.evaluate(anchor.solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
      anchor.material =
          base_.posedFlesh.materialFromWorld(anchor.solid, world - double{d} * Vec3(nx, ny, nz));
    }
  }

  void applyEdits() {
    for (std::size_t n = 0; n < def_.anchors.size(); ++n)
      findSolid("/anchors/" + std::to_string(n) + "/solid", def_.anchors[n].solid);
    for (std::size_t n = 0; n < def_.regions.size(); ++n)
      applyRegion(def_.regions[n], "/regions/" + std::to_string(n));
    for (std::size_t n = 0; n < def_.brushes.size(); ++n)
      applyBrush(def_.brushes[n], "/brushes/" + std::to_string(n));
    for (const QuantityInfo& i : quantityInfos())
      for (float& v : skin_.quantities_[i.quantity])
        v = std::clamp(v, static_cast<float>(i.min), static_cast<float>(i.max));
  }

  SolidId findSolid(const std::string& where, const std::string& name) {
    const SolidId id = base_.flesh.find(name);
    if (!id.valid()) {
      std::vector<std::string_view> names;
      for (std::size_t s = 0; s < base_.flesh.solidCount(); ++s)
        names.push_back(base_.flesh.def(SolidId(static_cast<std::int64_t>(s))).name);
      error(where, "found no solid named '" + name + "'", didYouMean(name, names));
    }
    return id;
  }

  void applyRegion(const SkinRegionDef& region, const std::string& where) {
    if (region.solid.empty() && !(region.v_min <= region.v_max))
      error(where + "/v", "found the larger number first", "only u goes around; v runs upwards");
    std::vector<float> share(skin_.layout_.storage(), 0.f);
    if (!region.solid.empty()) {
      const SolidId solid = findSolid(where + "/solid", region.solid);
      for (const TissueAnchors::Anchor& a : skin_.anchors_.anchors())
        if (a.solid == solid) share[a.point] = 1;
    } else {
      forEachPoint([&](int i, int j, std::size_t k) {
        const double u = static_cast<double>(i) / skin_.columns();
        const double v = static_cast<double>(j) / (skin_.rows() - 1);
        share[k] =
            static_cast<float>(inRange(u, region.u_min, region.u_max, region.feather, true) *
                               inRange(v, region.v_min, region.v_max, region.feather, false));
      });
    }
    for (const SkinRegionDef::Edit& edit : region.edits) {
      FloatArray& values = skin_.quantities_[edit.quantity];
      forEachPoint([&](int, int, std::size_t k) {
        const double old = values[k];
        const double target = edit.mode == SkinRegionDef::Edit::Mode::set     ? edit.value
                              : edit.mode == SkinRegionDef::Edit::Mode::scale ? old * edit.value
                                                                              : old + edit.value;
        values[k] = static_cast<float>(old + share[k] * (target - old));
      });
    }
  }

  void applyBrush(const SkinBrushDef& brush, const std::string& where) {
    Vec3 center = brush.center_m;
    if (!brush.joint.empty()) {
      const JointId joint = findJoint(where + "/joint", brush.joint);
      if (!joint.valid()) return;
      center = base_.posedSkeleton.joint_world[joint.index()].point(center);
    }
    FloatArray& values = skin_.quantities_[brush.quantity];
    forEachPoint([&](int, int, std::size_t k) {
      const double r = (pointAt(skin_.rest_, k) - center).norm() / std::max(1e-9, brush.radius_m);
      values[k] =
          std::max(0.f, values[k] + static_cast<float>(brush.amount * std::exp(-0.5 * r * r)));
    });
  }

  // The skin that a fine one rides on: everything resampled, attached anew.
  void makeCoarse() {
    auto coarse = std::shared_ptr<Skin>(new Skin);
    const double ratio = std::sqrt(static_cast<double>(skin_.pointCount()) / kCoarsePoints);
    const auto side = [&](int fine) {
      return std::max(kMinSide, static_cast<int>(std::lround(fine / ratio)));
    };
    coarse->layout_ = {side(skin_.columns()), side(skin_.rows()), true};
    coarse->settings_ = skin_.settings_;
    coarse->size_m_ = skin_.size_m_;
    coarse->rest_ = resample(skin_.layout_, skin_.rest_, coarse->layout_);
    for (const QuantityInfo& i : quantityInfos())
      coarse->quantities_[i.quantity] =
          resample(skin_.layout_, skin_.quantities_[i.quantity], coarse->layout_);
    SkinBuilder builder(*coarse, def_, base_, pointer_, diagnostics_);
    builder.joint_[0] = joint_[0];
    builder.joint_[1] = joint_[1];
    builder.placeCarriers();
    const FloatArray restLength = coarse->quantities_[SkinQuantity::tissue_rest_length];
    builder.attach();
    coarse->quantities_[SkinQuantity::tissue_rest_length] = restLength;
    builder.makeModel();
    skin_.coarse_ = std::move(coarse);
  }

  void makeModel() {
    const GridLayout& g = skin_.layout_;
    const SkinQuantities& q = skin_.quantities_;
    skin_.elastic_ =
        ElasticGrid(g, skin_.rest_,
                    {q[SkinQuantity::stretch_u], q[SkinQuantity::stretch_v], q[SkinQuantity::shear],
                     q[SkinQuantity::prestretch], static_cast<float>(def_.material.max_stretch)});
    skin_.bending_ = Bending(g, skin_.rest_, q[SkinQuantity::bending]);
    skin_.contactResponse_ = {def_.material.friction_per_s, def_.material.restitution};
    fixEnds();
    makePoints();
    for (int j = 1; j + 1 < g.rows; ++j)
      for (int i = 0; i < g.columns; i += static_cast<int>(PointBlock::kCapacity))
        skin_.blocks_.push_back(
            {g.at(i, j), std::min<std::uint32_t>(PointBlock::kCapacity,
                                                 static_cast<std::uint32_t>(g.columns - i))});
    skin_.defaultStep_s_ = longestStep(skin_.points_, kAddedMassShare);
  }

  void fixEnds() {
    for (int e = 0; e < 2; ++e) {
      const Transform inverse = base_.posedSkeleton.joint_world[joint_[e].index()].inverse();
      for (int i = 0; i < skin_.columns(); ++i) {
        const std::size_t k = skin_.layout_.at(i, e == 0 ? 0 : skin_.rows() - 1);
        skin_.fixed_.push_back({k, joint_[e], inverse.point(pointAt(skin_.rest_, k))});
      }
    }
  }

  void makePoints() {
    const GridLayout& g = skin_.layout_;
    const SkinQuantities& q = skin_.quantities_;
    PointModel& p = skin_.points_;
    for (FloatArray* a : {&p.mass, &p.drag, &p.fat, &p.tissueStiffness, &p.tissueDamping,
                          &p.tissueRestLength, &p.free})
      a->assign(g.storage(), 0.f);
    p.stiffnessBound = skin_.elastic_.stiffnessBound();
    skin_.bending_.addStiffnessBound(p.stiffnessBound);
    const FloatArray areas = pointAreas(g, skin_.rest_);
    // Rest cells that are nearly nothing still need a mass to divide by.
    const float least = 1e-6f * static_cast<float>(skin_.size_m_ * skin_.size_m_) /
                        static_cast<float>(g.pointCount());
    forEachPoint([&](int, int j, std::size_t k) {
      const float area = std::max(areas[k], least);
      p.mass[k] = q[SkinQuantity::density][k] * area;
      p.drag[k] = q[SkinQuantity::drag][k] * area;
      p.fat[k] = q[SkinQuantity::fat][k];
      p.free[k] = j > 0 && j + 1 < skin_.rows() ? 1.f : 0.f;
    });
    for (const TissueAnchors::Anchor& a : skin_.anchors_.anchors()) {
      const float area = std::max(areas[a.point], least);
      p.tissueStiffness[a.point] = q[SkinQuantity::tissue_stiffness][a.point] * area;
      p.tissueDamping[a.point] = q[SkinQuantity::tissue_damping][a.point] * area;
      p.tissueRestLength[a.point] = q[SkinQuantity::tissue_rest_length][a.point];
      p.stiffnessBound[a.point] += p.tissueStiffness[a.point];
    }
  }

  Skin& skin_;
  const SkinDef& def_;
  const SkinBase& base_;
  std::string pointer_;
  Diagnostics& diagnostics_;
  JointId joint_[2];
};

Skin::Skin(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
           const std::string& pointer, Diagnostics& diagnostics)
    : settings_(settings) {
  SkinBuilder(*this, def, base, pointer, diagnostics).build();
}

}  // namespace fascia
