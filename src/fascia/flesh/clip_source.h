#pragma once

#include <fascia/flesh/posture_source.h>
#include <fascia/motion/clip.h>

namespace fascia {

// Plays a clip from time 0; one without tracks is the rest posture. Has no memory: any number of
// threads may share it. All must outlive it.
class ClipSource final : public PostureSource {
 public:
  ClipSource(const Skeleton& skeleton, const Morphs& morphs, const BoundClip& clip)
      : skeleton_(&skeleton), morphs_(&morphs), clip_(&clip) {}

  void sample(double time_s, PostureSample& out) const override;
  Info info() const override { return {clip_->name, clip_->duration_s, clip_->loop}; }
  const BoundClip& clip() const { return *clip_; }

 private:
  const Skeleton* skeleton_;
  const Morphs* morphs_;
  const BoundClip* clip_;
};

}  // namespace fascia
