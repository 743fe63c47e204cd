#pragma once

#include <memory>
#include <vector>

#include <fascia/skin/contact/solid_motions.h>
#include <fascia/skin/point/face_samples.h>

namespace fascia {

// Keeps faces out of the flesh, where SkinContact keeps points out: a sample of a face that is
// inside of a solid moves the face's points out until it lies on it, once per interval: what faces
// side by side leave of each other's depth fades from interval to interval. Comes before the
// points' contact, which is exact.
class FaceContact {
 public:
  FaceContact() = default;
  // clearance_m: kept between faces and flesh, where there is as much fat.
  FaceContact(std::shared_ptr<const FaceSamples> samples, float clearance_m);

  void project(const MovingField& field, const PointModel& points, VectorArray& position,
               VectorArray& velocity);

 private:
  enum Found : char { kFar, kNear, kCut };
  struct Cut {
    Eigen::Vector3f place, normal;
    float depth_m = 0;  // > 0: inside of `solid`
    SolidId solid;
  };

  void search(const MovingField& field, const PointModel& points, const VectorArray& position);
  void searchBlock(const MovingField& field, const PointModel& points, std::size_t block,
                   const VectorArray& position);
  BlockMotion follow(const FaceSamples::Block& block, const VectorArray& position, Box& box);
  void testSolid(const MovingField& field, SolidId solid, const FaceSamples::Block& block,
                 float& gap_m);
  void pushOut(const MovingField& field, const FaceSamples::Sample& sample, const Cut& cut,
               const PointModel& points, VectorArray& position, VectorArray& velocity) const;

  std::shared_ptr<const FaceSamples> samples_;
  float clearance_m_ = 0;

  // What is known from the last search; it saves work and changes no result.
  SolidMotions motions_;
  std::vector<Box> boxes_;     // of the solids
  std::vector<float> gaps_;    // blocks x solids: no sample of the block is nearer
  VectorArray last_;           // of `samples_->points`
  std::vector<Found> found_;   // per block
  std::vector<Cut> cuts_;      // per sample, of blocks that are not far
  std::vector<float> keep_m_;  // per sample, likewise
};

}  // namespace fascia
