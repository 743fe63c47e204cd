#include <fascia/motion/sampled_motion.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

// Two frames around a time, and how far it is from the first to the second.
struct Between {
  std::size_t before, after;
  float share;
};

Between between(const SampledMotion& motion, double time_s) {
  const auto count = static_cast<double>(motion.frameCount());
  double frame = time_s * motion.rate_hz;
  if (!std::isfinite(frame)) frame = 0;
  if (motion.loop) {
    frame = std::fmod(frame, count);
    if (frame < 0) frame = std::min(frame + count, std::nextafter(count, 0.0));
  } else {
    frame = std::clamp(frame, 0.0, count - 1);
  }
  const double whole = std::min(std::floor(frame), count - 1);
  const auto before = static_cast<std::size_t>(whole);
  const std::size_t after = before + 1 < motion.frameCount() ? before + 1
                            : motion.loop                    ? 0
                                                             : before;
  return {before, after, static_cast<float>(frame - whole)};
}

}  // namespace

Transform sampleJoint(const SampledMotion& motion, std::size_t joint, double time_s) {
  const Between at = between(motion, time_s);
  const std::size_t a = at.before * motion.joints.size() + joint;
  const std::size_t b = at.after * motion.joints.size() + joint;
  const Eigen::Quaternionf turn = motion.rotation[a].slerp(at.share, motion.rotation[b]);
  const Eigen::Vector3f place =
      motion.translation_m[a] + at.share * (motion.translation_m[b] - motion.translation_m[a]);
  return {turn.normalized().cast<double>().toRotationMatrix(), place.cast<double>()};
}

}  // namespace fascia
