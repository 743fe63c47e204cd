#pragma once

#include <span>
#include <vector>

#include <fascia/baking/skinning_decomposition.h>

namespace fascia {

// Motions of bones from the rest pose to every frame: the rig's joints first, then helpers.
class BoneTracks {
 public:
  explicit BoneTracks(std::size_t frameCount) : frameCount_(frameCount) {}

  std::size_t frameCount() const { return frameCount_; }
  std::size_t boneCount() const { return frameCount_ ? motion_.size() / frameCount_ : 0; }
  std::span<const Transform> track(std::size_t bone) const {
    return {motion_.data() + bone * frameCount_, frameCount_};
  }
  std::span<Transform> track(std::size_t bone) {
    return {motion_.data() + bone * frameCount_, frameCount_};
  }
  const Transform& at(std::size_t bone, std::size_t frame) const {
    return motion_[bone * frameCount_ + frame];
  }
  void add(std::span<const Transform> track) {  // as long as frameCount
    motion_.insert(motion_.end(), track.begin(), track.end());
  }

 private:
  std::size_t frameCount_;
  std::vector<Transform> motion_;  // bone * frameCount + frame
};

// What a decomposition is looked for in: a surface at rest and in some frames.
struct SkinningProblem {
  std::vector<Vec3> rest_m;
  std::size_t frameCount = 0;
  std::vector<Eigen::Vector3f> target_m;  // point * frameCount + frame

  std::size_t pointCount() const { return rest_m.size(); }
  const Eigen::Vector3f& target(std::size_t point, std::size_t frame) const {
    return target_m[point * frameCount + frame];
  }
};

// Diagonal of the box around points; 0 if there are none.
double sizeOf(std::span<const Vec3> points);

// Where linear blend skinning puts a point.
Vec3 blendPoint(const Vec3& rest, const PointWeights& weights, const BoneTracks& bones,
                std::size_t frame);

// A run of frames.
struct FrameRange {
  std::size_t first = 0, end = 0;
};

// Per point: sum over these frames of the squared distance to its target.
void squaredErrors(const SkinningProblem& problem, std::span<const PointWeights> weights,
                   const BoneTracks& bones, FrameRange frames, std::vector<double>& error);

// The same with the largest squared distance.
struct PointError {
  double sum_m2 = 0, largest_m2 = 0;
};
std::vector<PointError> pointErrors(const SkinningProblem& problem,
                                    std::span<const PointWeights> weights, const BoneTracks& bones,
                                    FrameRange frames);

}  // namespace fascia
