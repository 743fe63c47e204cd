#include <fascia/baking/morph_basis.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include <fascia/baking/blended_frames.h>
#include <fascia/baking/displacement_basis.h>
#include <fascia/base/error.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Index;

// The fields are found in this many frames, evenly spread, weights in all.
constexpr std::size_t kMostFittedFrames = 240;
// Truncation costs accuracy: with a tolerance, more fields are tried so many times.
constexpr int kMostTries = 6;

struct Simulation {
  std::span<const Eigen::Vector3f> rest;
  std::span<const PointWeights> weights;
  const std::vector<std::vector<Transform>>& bones;
  const PointFrames& frames;
};

Eigen::MatrixXf displacementsOf(const Simulation& simulation) {
  const std::size_t all = simulation.frames.size();
  const std::size_t count = std::min(all, kMostFittedFrames);
  Eigen::MatrixXf out(static_cast<Index>(3 * simulation.rest.size()), static_cast<Index>(count));
  parallelFor(count, [&](std::size_t k) {
    const std::size_t f = count < 2 ? 0 : k * (all - 1) / (count - 1);
    for (std::size_t i = 0; i < simulation.rest.size(); ++i) {
      const Vec3 d = bindPoseDisplacement(blendBones(simulation.weights[i], simulation.bones[f]),
                                          simulation.rest[i].cast<double>(),
                                          simulation.frames[f][i].cast<double>());
      out.col(static_cast<Index>(k)).segment<3>(3 * static_cast<Index>(i)) = d.cast<float>();
    }
  });
  return out;
}

// A frame as the world sees it: what every field moves, and what is missing with the offset alone.
struct WorldFrame {
  Eigen::MatrixXd fields;   // 3 points x K
  Eigen::VectorXd missing;  // 3 points
};

WorldFrame worldFrame(const Simulation& simulation, const DisplacementBasis& basis,
                      std::size_t frame) {
  const Eigen::MatrixXd& fields = basis.fields;
  WorldFrame out{Eigen::MatrixXd(fields.rows(), fields.cols()), Eigen::VectorXd(fields.rows())};
  for (std::size_t i = 0; i < simulation.rest.size(); ++i) {
    const BlendedMatrix blend = blendBones(simulation.weights[i], simulation.bones[frame]);
    const Index row = 3 * static_cast<Index>(i);
    out.fields.middleRows<3>(row) = blend.linear * fields.middleRows<3>(row);
    out.missing.segment<3>(row) =
        simulation.frames[frame][i].cast<double>() -
        blend.point(simulation.rest[i].cast<double>() + basis.offset.segment<3>(row));
  }
  return out;
}

struct FrameError {
  double sum_m2 = 0, max_m2 = 0;
};

// Weights of all frames by least squares in the world, and the error that they leave.
std::vector<FrameError> fitInWorld(const Simulation& simulation, DisplacementBasis& basis) {
  const std::size_t frames = simulation.frames.size();
  basis.weights.resize(basis.fields.cols(), static_cast<Index>(frames));
  std::vector<FrameError> errors(frames);
  parallelFor(frames, [&](std::size_t f) {
    const WorldFrame world = worldFrame(simulation, basis, f);
    Eigen::VectorXd left = world.missing;
    if (basis.fields.cols() > 0) {
      Eigen::MatrixXd gram = world.fields.transpose() * world.fields;
      gram.diagonal().array() += 1e-12 * gram.trace() + 1e-300;
      const Eigen::VectorXd w = gram.ldlt().solve(world.fields.transpose() * world.missing);
      basis.weights.col(static_cast<Index>(f)) = w;
      left -= world.fields * w;
    }
    for (Index i = 0; i < left.size() / 3; ++i) {
      const double e = left.segment<3>(3 * i).squaredNorm();
      errors[f].sum_m2 += e;
      errors[f].max_m2 = std::max(errors[f].max_m2, e);
    }
  });
  return errors;
}

MorphBasis::Target targetOf(const Eigen::VectorXd& field) {
  MorphBasis::Target target;
  for (Index i = 0; i < field.size() / 3; ++i) {
    const Eigen::Vector3d d = field.segment<3>(3 * i);
    if (d.isZero(0)) continue;
    target.points.push_back(static_cast<std::uint32_t>(i));
    target.displacement_m.push_back(d.cast<float>());
  }
  return target;
}

MorphBasis packed(const DisplacementBasis& basis, std::size_t frames) {
  MorphBasis out;
  out.weights.resize(frames);
  const auto add = [&](const Eigen::VectorXd& field, const auto& weightIn) {
    MorphBasis::Target target = targetOf(field);
    if (target.points.empty()) return;
    out.targets.push_back(std::move(target));
    for (std::size_t f = 0; f < frames; ++f) {
      out.weights[f].push_back(static_cast<float>(weightIn(static_cast<Index>(f))));
    }
  };
  add(basis.offset, [](Index) { return 1.0; });
  for (Index k = 0; k < basis.fields.cols(); ++k) {
    add(basis.fields.col(k), [&](Index f) { return std::clamp(basis.weights(k, f), 0.0, 1.0); });
  }
  return out;
}

// One of the targets is the offset.
MorphBasis basisOf(const Simulation& simulation, Eigen::MatrixXf displacements, int targets,
                   const MorphOptions& options) {
  DisplacementBasis basis = principalFields(displacements, targets - 1, 0);
  localizeFields(basis);
  sparsifyFields(displacements, options.sparsity, basis);
  const std::vector<FrameError> errors = fitInWorld(simulation, basis);
  normalizeWeights(basis);
  MorphBasis out = packed(basis, simulation.frames.size());
  double sum_m2 = 0, max_m2 = 0;
  for (const FrameError& e : errors) {
    sum_m2 += e.sum_m2;
    max_m2 = std::max(max_m2, e.max_m2);
  }
  const auto entries =
      static_cast<double>(simulation.rest.size()) * static_cast<double>(errors.size());
  out.rms_m = std::sqrt(sum_m2 / entries);
  out.max_m = std::sqrt(max_m2);
  return out;
}

void check(const Simulation& simulation, const MorphOptions& options) {
  const PointFrames& frames = simulation.frames;
  if (simulation.rest.empty() || frames.empty() || simulation.bones.size() != frames.size() ||
      simulation.weights.size() != simulation.rest.size()) {
    throw Error("a morph basis needs points, weights, and bones for every frame");
  }
  if (options.targets < 1 || options.targets > 256) {
    throw Error("a morph basis takes 1 to 256 targets");
  }
  for (const std::vector<Eigen::Vector3f>& frame : frames) {
    if (frame.size() != simulation.rest.size()) {
      throw Error("every frame of a morph basis must be as long as the rest shape");
    }
    for (const Eigen::Vector3f& p : frame) {
      if (!p.allFinite()) throw Error("a simulated point is not a number");
    }
  }
}

}  // namespace

MorphBasis findMorphBasis(std::span<const Eigen::Vector3f> rest,
                          std::span<const PointWeights> weights,
                          const std::vector<std::vector<Transform>>& bones,
                          const PointFrames& frames, const MorphOptions& options) {
  const Simulation simulation{rest, weights, bones, frames};
  check(simulation, options);
  const Eigen::MatrixXf displacements = displacementsOf(simulation);
  if (options.tolerance_m <= 0) {
    return basisOf(simulation, displacements, options.targets, options);
  }
  // The fewest that could do, then more until they do after truncation too.
  Eigen::MatrixXf scratch = displacements;
  int targets =
      1 + static_cast<int>(
              principalFields(scratch, options.targets - 1, options.tolerance_m).fields.cols());
  MorphBasis best = basisOf(simulation, displacements, targets, options);
  for (int t = 1; t < kMostTries && best.rms_m > options.tolerance_m; ++t) {
    if (targets >= options.targets) break;
    targets = std::min(options.targets, targets + std::max(1, targets / 4));
    best = basisOf(simulation, displacements, targets, options);
  }
  return best;
}

}  // namespace fascia
