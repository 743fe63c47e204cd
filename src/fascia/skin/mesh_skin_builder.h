#pragma once

#include <string>
#include <vector>

#include <fascia/skin/mesh/mesh_rest.h>
#include <fascia/skin/mesh/mesh_topology.h>
#include <fascia/skin/mesh/rigged_skin.h>
#include <fascia/skin/skin_parts.h>

namespace fascia {

// Builds the skin of an imported mesh step by step; each step reads only what the ones before it
// made. Its rest shape is in equilibrium in the rest posture: the strands' anchors are placed so
// that they carry its weight there. Parts of the skin that it was edited from (`before`, of the
// same mesh; may be nullptr) are taken over where nothing that they are made of has changed.
class MeshSkinBuilder {
 public:
  MeshSkinBuilder(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
                  const Skin* before, std::string pointer, Diagnostics& diagnostics)
      : def_(def),
        settings_(settings),
        base_(base),
        rig_(*base.rig),
        before_(before ? &before->parts() : nullptr),
        report_(base, std::move(pointer), diagnostics) {}

  // With errors reported the result must not be used, and may be empty.
  SkinParts build();

 private:
  const std::string& nameOf(std::size_t joint) const {
    return base_.rigJoints.empty() ? rig_.joints[joint].name : base_.rigJoints[joint];
  }
  bool checkDef() const;
  bool findJoints();
  MeshRestKey restKey() const;
  void lay();
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
  std::vector<RigMorph> storedMorphs() const;
  bool keepsTopology() const;
  std::shared_ptr<const MeshTopology> makeTopology() const;
  TriangleMembrane makeMembrane() const;
  std::shared_ptr<const PoseSkin> evaluator(const std::vector<Eigen::Vector3f>& rest,
                                            const std::vector<RigJoint>& joints) const;
  Vec3 modelPoint(std::size_t p) const;
  std::vector<Vec3> pointNormals() const;  // of the model's points, at rest
  Vec3 sag(std::size_t k) const;

  const SkinDef& def_;
  const SkinSettings& settings_;
  const SkinBase& base_;
  const RiggedModel& rig_;
  const SkinParts* before_;
  SkinReport report_;

  struct Joint {
    std::size_t skeletonJoint;
    Transform rest_world;  // of the skeleton's joint
  };
  std::vector<Joint> joints_;  // of the rig
  // What no quantity changes. While it is made, `making_` is the same.
  std::shared_ptr<const MeshRest> rest_;
  std::shared_ptr<MeshRest> making_;
  std::vector<std::vector<SolidId>> felt_;  // per point of the model: solids beneath it
  FloatArray naturalFat_;                   // per storage index, before edits

  SkinParts parts_;
  std::shared_ptr<const SkinShape> shape_;
  std::shared_ptr<SkinQuantities> quantities_ = std::make_shared<SkinQuantities>();
  std::shared_ptr<PointModel> points_ = std::make_shared<PointModel>();
};

}  // namespace fascia
