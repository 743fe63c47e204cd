#include <cmath>

#include <gtest/gtest.h>

#include <fascia/baking/bone_moments.h>

namespace fascia {
namespace {

// Some number in [-1, 1], always the same.
double wiggle(std::size_t i) {
  return std::sin(12.9898 * static_cast<double>(i + 1));
}

Transform motion(std::size_t bone, std::size_t frame) {
  const std::size_t k = 31 * bone + 7 * frame;
  const Vec3 axis = Vec3(wiggle(k), wiggle(k + 1), 2).normalized();
  return {Eigen::AngleAxisd(wiggle(k + 2), axis).toRotationMatrix(),
          Vec3(5 + wiggle(k + 3), wiggle(k + 4), wiggle(k + 5))};
}

BoneTracks tracks(std::size_t bones, std::size_t frames) {
  BoneTracks out(frames);
  for (std::size_t b = 0; b < bones; ++b) {
    std::vector<Transform> track;
    for (std::size_t f = 0; f < frames; ++f) track.push_back(motion(b, f));
    out.add(track);
  }
  return out;
}

SkinningProblem problemOf(std::size_t points, std::size_t frames) {
  SkinningProblem problem;
  problem.frameCount = frames;
  for (std::size_t i = 0; i < points; ++i) {
    problem.rest_m.emplace_back(wiggle(3 * i), wiggle(3 * i + 1), wiggle(3 * i + 2));
    for (std::size_t f = 0; f < frames; ++f) {
      const std::size_t k = 1000 + 11 * i + 5 * f;
      problem.target_m.push_back(Vec3(5 + wiggle(k), wiggle(k + 1), wiggle(k + 2)).cast<float>());
    }
  }
  return problem;
}

// Sums over frames of (T_a p - m)·(T_b p - m) and (T_a p - m)·(x - m), m the targets' middle.
struct Direct {
  double between = 0, withTarget = 0;
  Direct(const SkinningProblem& problem, const BoneTracks& bones, std::size_t a, std::size_t b,
         std::size_t point) {
    for (std::size_t f = 0; f < problem.frameCount; ++f) {
      Vec3 middle = Vec3::Zero();
      for (std::size_t i = 0; i < problem.pointCount(); ++i)
        middle += problem.target(i, f).cast<double>() / static_cast<double>(problem.pointCount());
      const Vec3 left = bones.at(a, f).point(problem.rest_m[point]) - middle;
      between += left.dot(bones.at(b, f).point(problem.rest_m[point]) - middle);
      withTarget += left.dot(problem.target(point, f).cast<double>() - middle);
    }
  }
};

TEST(BoneMoments, AreSumsOverFramesOfAnyNumber) {
  constexpr std::size_t kPoints = 5, kBones = 6, kRig = 4;
  for (const std::size_t frames : {1u, 2u, 3u, 8u, 11u}) {
    const SkinningProblem problem = problemOf(kPoints, frames);
    const BoneTracks bones = tracks(kBones, frames);
    BoneMoments moments(problem, tracks(kRig, frames));
    moments.update(bones);
    std::vector<double> target;
    for (std::size_t point = 0; point < kPoints; ++point) {
      const Eigen::Vector4d p = problem.rest_m[point].homogeneous();
      moments.target(point, target);
      for (std::size_t a = 0; a < kBones; ++a)
        for (std::size_t b = 0; b < kBones; ++b) {
          const Direct direct(problem, bones, a, b, point);
          EXPECT_NEAR(moments.between(a, b, BoneMoments::squareOf(p)), direct.between, 1e-11);
          EXPECT_NEAR(moments.withTarget(a, p, target), direct.withTarget, 1e-11);
        }
    }
  }
}

TEST(BoneMoments, ForgetHelpersThatMoveElsewhere) {
  const SkinningProblem problem = problemOf(3, 7);
  const BoneTracks before = tracks(5, 7);
  BoneTracks after = before;
  for (Transform& t : after.track(4)) t.translation_m.y() += 2;
  BoneMoments moments(problem, tracks(3, 7)), fresh(problem, tracks(3, 7));
  moments.update(before);
  moments.update(after);
  fresh.update(after);
  const Quadratic square = BoneMoments::squareOf(problem.rest_m[1].homogeneous());
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < 5; ++b)
      EXPECT_EQ(moments.between(a, b, square), fresh.between(a, b, square));
}

}  // namespace
}  // namespace fascia
