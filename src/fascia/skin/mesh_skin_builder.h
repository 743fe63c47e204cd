#pragma once

#include <string>
#include <vector>

#include <fascia/skin/mesh/triangle_membrane.h>
#include <fascia/skin/skin_parts.h>

namespace fascia {

// Builds the skin of an imported mesh step by step; each step reads only what the ones before it
// made. Its rest shape is in equilibrium in the rest posture: the strands' anchors are placed so
// that they carry its weight there.
class MeshSkinBuilder {
 public:
  MeshSkinBuilder(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
                  std::string pointer, Diagnostics& diagnostics)
      : def_(def),
        settings_(settings),
        base_(base),
        rig_(*base.rig),
        report_(base, std::move(pointer), diagnostics) {}

  // With errors reported the result must not be used, and may be empty.
  SkinParts build();

 private:
  bool checkDef() const;
  bool findJoints();
  void findFelt();
  void measureFat();
  void chooseFixed();
  void orderPoints();
  void makeRestShape();
  void setQuantities();
  void makeModel();
  void makePoseSkin();
  void fixLoosePieces();
  void layFat(const VectorArray& skin, const VectorArray& anchors);
  std::vector<TriangleMembrane::Corners> storedTriangles() const;
  TriangleMembrane makeMembrane() const;
  Vec3 modelPoint(std::size_t p) const;
  std::vector<Vec3> pointNormals() const;  // of the model's points, at rest
  Vec3 sag(std::size_t k) const;

  const SkinDef& def_;
  const SkinSettings& settings_;
  const SkinBase& base_;
  const RiggedModel& rig_;
  SkinReport report_;

  struct Joint {
    std::size_t skeletonJoint;
    Transform rest_world;  // of the skeleton's joint
  };
  std::vector<Joint> joints_;  // of the rig
  // Per point of the model:
  std::vector<std::vector<SolidId>> felt_;  // solids beneath it
  std::vector<float> gap_;                  // from the nearest of them, m
  std::vector<SolidId> solid_;              // that one
  std::vector<char> covered_;               // whether it counts as flesh beneath
  std::vector<char> fixed_;                 // never simulated
  std::vector<char> rigid_;                 // carried by its joints as it is
  std::vector<std::uint32_t> storageOf_;
  std::vector<std::uint32_t> order_;  // model point per storage index
  std::size_t elasticCount_ = 0;      // the first so many in storage are simulated
  FloatArray naturalFat_;             // per storage index, before edits

  SkinParts parts_;
  std::shared_ptr<SkinShape> shape_ = std::make_shared<SkinShape>();
  std::shared_ptr<SkinQuantities> quantities_ = std::make_shared<SkinQuantities>();
  std::shared_ptr<PointModel> points_ = std::make_shared<PointModel>();
};

}  // namespace fascia
