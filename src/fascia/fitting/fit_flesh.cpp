#include <fascia/fitting/fit_flesh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fascia/base/parallel.h>
#include <fascia/base/suggest.h>
#include <fascia/fitting/containment.h>
#include <fascia/fitting/coverage.h>
#include <fascia/fitting/muscles.h>
#include <fascia/fitting/part_pieces.h>

namespace fascia {
namespace {

constexpr double kLeastUsable = 0.2;  // share of a part's skin that must have room beneath
constexpr double kLeastArea = 2e-4;   // of the body's skin: smaller parts belong to their neighbour

std::string millimetres(double length_m) {
  return std::to_string(static_cast<long>(std::lround(1000 * length_m))) + " mm";
}

std::string whyNone(const RestSurface& surface, const FleshPart& part) {
  if (part.area_m2 <= 0) return "dominates no skin";
  if (part.area_m2 < kLeastArea * surface.area_m2())
    return "dominates next to no skin: left to its neighbour";
  if (part.usable < kLeastUsable) return "too thin for flesh under fat";
  return {};
}

double partResidual_m(const FleshPart& part, const PartFit& fit) {
  double square = 0, area_m2 = 0;
  const std::vector<double> gaps = gaps_m(part, fit.solids);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (std::ranges::find(fit.worn, part.own[i].piece) != fit.worn.end()) continue;
    square += part.own[i].area_m2 * gaps[i] * gaps[i];
    area_m2 += part.own[i].area_m2;
  }
  return std::sqrt(square / area_m2);
}

// What a joint's fit is about.
struct Bone {
  const BoneFrame& frame;
  const BoneFrame* next;
  JointMeaning meaning;
};

PartFit fillPart(const FitSetting& setting, const FleshPart& part, const Bone& bone) {
  PartFit fit;
  fit.solids = fitMuscles(setting, part, bone.frame, bone.next, bone.meaning);
  if (fit.solids.empty()) {
    FittedSolid solid = wholeGuess(setting.surface, part, bone.frame);
    const SolidTarget target = wholeTarget(setting.surface, part, bone.frame);
    if (!fitInside(setting.surface, setting.plane(part), setting.margin_m(), target, solid)) {
      fit.why = "nothing fits inside of the skin (radius " + millimetres(part.radius_m) + ")";
      return fit;
    }
    fit.solids.push_back({"", solid, kFlesh, 0});
  }
  addFillers(setting, part, bone.frame, fit.solids);
  return fit;
}

// The fit of a part's core alone. A bone that leads to no joint ends where its core does.
PartFit fillCore(const FitSetting& setting, const FleshPart& part, const Bone& bone,
                 std::uint32_t core) {
  const FleshPart alone = onlyPiece(setting, bone.frame, part, core);
  BoneFrame frame = bone.frame;
  if (frame.mainChild < 0) {
    frame.length_m = std::max(0.0, alone.high_m);
    frame.end_m = frame.world.translation_m + frame.length_m * alone.axis;
  }
  return fillPart(setting, alone, {frame, bone.next, bone.meaning});
}

// One solid for a head and its hat fills neither: the head comes first, the hat gets what fits.
void preferCore(const FitSetting& setting, const FleshPart& part, const Bone& bone,
                std::uint32_t core, PartFit& fit) {
  constexpr double kLeastGain = 0.1;
  const double share = fit.solids.empty() ? 0 : filledShare(setting, part, fit.solids, core);
  fit.worn = wornPieces(setting, part, fit.solids, core);
  if (share >= kWellFilled && fit.worn.empty()) return;
  PartFit alone = fillCore(setting, part, bone, core);
  if (alone.solids.empty()) return;
  if (share < kWellFilled) {
    if (filledShare(setting, part, alone.solids, core) < share + kLeastGain) return;
    addFillers(setting, part, bone.frame, alone.solids);
  }
  alone.worn = wornPieces(setting, part, alone.solids, core);
  // What is worn pulls at the flesh for nothing.
  if (share < kWellFilled || partResidual_m(part, alone) < partResidual_m(part, fit))
    fit = std::move(alone);
}

PartFit fitPart(const FitSetting& setting, const std::vector<BoneFrame>& frames,
                JointMeaning meaning, std::size_t joint) {
  const BoneFrame& frame = frames[joint];
  const FleshPart part = findFleshPart(setting.surface, setting.symmetry, frame, joint);
  if (std::string why = whyNone(setting.surface, part); !why.empty()) {
    PartFit none;
    none.why = std::move(why);
    return none;
  }
  const BoneFrame* next =
      frame.mainChild < 0 ? nullptr : &frames[static_cast<std::size_t>(frame.mainChild)];
  const Bone bone{frame, next, meaning};
  PartFit fit = fillPart(setting, part, bone);
  if (const auto core = corePiece(part, frame)) preferCore(setting, part, bone, *core, fit);
  if (!fit.solids.empty()) fit.residual_rms_m = partResidual_m(part, fit);
  return fit;
}

// Radius ∝ 1/√length: a muscle that shortens swells, at constant volume.
std::vector<DriverDef> swelling(const NamedSolid& named, const std::string& joint) {
  std::vector<DriverDef> drivers;
  if (named.stretchPerRightAngle == 0) return drivers;
  const char* const names[] = {"half_x_m", "half_y_m", "half_z_m"};
  for (const int axis : {0, 1, 2}) {
    DriverDef driver;
    driver.parameter = names[axis];
    driver.joint = joint;
    driver.dof = Dof::rx;
    for (const double flexion : {-0.4, 0.0, 1.0, 1.6}) {  // right angles
      const double length = std::max(0.3, 1 + named.stretchPerRightAngle * flexion);
      driver.points.push_back(
          {flexion * kPi / 2,
           named.solid.half_m[axis] * (axis == 2 ? length : 1 / std::sqrt(length))});
    }
    drivers.push_back(std::move(driver));
  }
  return drivers;
}

void addSolids(const RiggedModel& model, const std::vector<BoneFrame>& frames, std::size_t joint,
               const PartFit& fit, const MirrorPlane* plane, FleshFit& out) {
  const std::string& name = model.joints[joint].name;
  for (const NamedSolid& named : fit.solids) {
    const FittedSolid solid = plane ? named.solid.mirrored(*plane) : named.solid;
    const std::string full = named.suffix.empty() ? name : name + " " + named.suffix;
    FleshSolidDef def = solid.onJoint(full, name, frames[joint].world, named.color);
    if (const int next = frames[joint].mainChild; next >= 0)
      def.drivers = swelling(named, model.joints[static_cast<std::size_t>(next)].name);
    out.flesh.solids.push_back(std::move(def));
    out.joints[joint].solids.push_back(full);
  }
  out.joints[joint].residual_rms_m = fit.residual_rms_m;
  out.joints[joint].why = fit.why;
}

std::vector<std::size_t> dominatedPoints(const RiggedModel& model) {
  std::vector<std::size_t> counts(model.joints.size(), 0);
  for (const PointWeights& w : model.weights) ++counts[w.joint[0]];
  return counts;
}

void addNotes(const RestSurface& surface, const Symmetry& symmetry, FleshFit& out) {
  const auto hidden = std::lround(100 * surface.hiddenShare());
  if (hidden > 0)
    out.notes.push_back(std::to_string(hidden) +
                        " % of the surface lies inside of its other pieces: flesh may cover it");
  if (!symmetry.present) out.notes.emplace_back("not symmetric: every side was fitted by itself");
}

// A name for a piece: the mesh's that its points are drawn by.
std::string pieceName(const RiggedModel& model, std::uint32_t piece) {
  for (const RigPart& part : model.parts) {
    if (part.vertexCount == 0 || model.component.empty()) continue;
    const std::uint32_t point = model.vertices[part.firstVertex].point;
    if (model.component[point] == piece) return part.name;
  }
  return {};
}

// Pieces of which most points belong to joints where they are worn: not the end of a trunk in a
// head's part.
std::set<std::uint32_t> mostlyWorn(const RiggedModel& model, const WornPieces& worn) {
  std::map<std::uint32_t, std::ptrdiff_t> balance;
  for (std::size_t i = 0; i < model.component.size(); ++i) {
    const std::vector<std::uint32_t>& list = worn[model.weights[i].joint[0]];
    const bool isWorn = std::ranges::find(list, model.component[i]) != list.end();
    balance[model.component[i]] += isWorn ? 1 : -1;
  }
  std::set<std::uint32_t> pieces;
  for (const auto& [piece, points] : balance)
    if (points > 0) pieces.insert(piece);
  return pieces;
}

void noteWorn(const RiggedModel& model, const WornPieces& worn, FleshFit& out) {
  constexpr std::size_t kMostNamed = 3;
  const std::set<std::uint32_t> pieces = mostlyWorn(model, worn);
  if (pieces.empty()) return;
  std::set<std::string> names;
  for (const std::uint32_t piece : pieces)
    if (std::string name = pieceName(model, piece); !name.empty() && names.size() < kMostNamed)
      names.insert(std::move(name));
  std::string named;
  for (const std::string& name : names) named += (named.empty() ? " (" : ", ") + quotedName(name);
  if (!named.empty()) named += pieces.size() > names.size() ? ", …)" : ")";
  out.notes.push_back(std::to_string(pieces.size()) +
                      " pieces of the mesh are worn over the flesh and get none" + named +
                      ": coverage is without them");
}

}  // namespace

FleshFit fitFlesh(const RiggedModel& model, const FitOptions& options) {
  FleshFit out;
  const RestSurface surface(model, options);
  const Symmetry symmetry = findSymmetry(model);
  const std::vector<BoneFrame> frames = findBoneFrames(model, surface, symmetry);
  out.skeleton = makeSkeleton(model, frames);
  const FitSetting setting{surface, symmetry};
  const std::vector<JointMeaning> meanings = guessMeanings(model.joints);
  std::vector<PartFit> fits(model.joints.size());
  parallelFor(fits.size(), [&](std::size_t j) {
    if (symmetry.mirrored(j)) return;
    fits[j] = fitPart(setting, frames, meanings[j], j);
    // As much as the skin's muscles do: the picture of the anatomy agrees with it.
    for (NamedSolid& solid : fits[j].solids)
      solid.stretchPerRightAngle *= options.muscle / FitOptions{}.muscle;
  });
  out.joints.resize(model.joints.size());
  const std::vector<std::size_t> points = dominatedPoints(model);
  std::vector<FittedSolid> solids;
  std::vector<std::size_t> solidJoint;
  for (std::size_t j = 0; j < fits.size(); ++j) {
    const bool mirrored = symmetry.mirrored(j);
    const auto source = mirrored ? static_cast<std::size_t>(symmetry.partner[j]) : j;
    const MirrorPlane* plane = mirrored ? &symmetry.plane : nullptr;
    out.joints[j].joint = model.joints[j].name;
    out.joints[j].points = points[j];
    addSolids(model, frames, j, fits[source], plane, out);
    for (const NamedSolid& named : fits[source].solids) {
      solids.push_back(plane ? named.solid.mirrored(*plane) : named.solid);
      solidJoint.push_back(j);
    }
  }
  WornPieces worn(fits.size());
  for (std::size_t j = 0; j < fits.size(); ++j) {
    const bool mirrored = symmetry.mirrored(j);
    const auto source = mirrored ? static_cast<std::size_t>(symmetry.partner[j]) : j;
    worn[j] = fits[source].worn;  // those of both sides
  }
  measureFit(surface, solids, solidJoint, worn, out);
  addNotes(surface, symmetry, out);
  noteWorn(model, worn, out);
  return out;
}

}  // namespace fascia
