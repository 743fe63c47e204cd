#include <fascia/skin/mesh/mesh_kernels.h>

#include <algorithm>

#include <fascia/base/parallel.h>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/mesh/mesh_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/field/kernel_math-inl.h>
#include <fascia/skin/mesh/quads-inl.h>
#include <fascia/skin/point/point_step-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

constexpr std::size_t kBatch = MeshLayout::kBatch;

std::size_t lanesImpl() {
  return hn::Lanes(D());
}

// A batch of triangles' forces on their corners. Formulas at TriangleMembrane; with t = |x|² − 1 =
// 2E the stress along x is (K/2) t x.
HWY_INLINE void triangleForces(const std::uint32_t* corners, const float* coefficients, float cap,
                               const float* quads, float* out) {
  const D d;
  const V limit = hn::Set(d, cap), one = hn::Set(d, 1.f), minus = hn::Set(d, -1.f);
  for (std::size_t l = 0; l < kBatch; l += hn::Lanes(d)) {
    const auto coefficient = [&](std::size_t q)
                                 HWY_ATTR { return hn::Load(d, coefficients + q * kBatch + l); };
    const V3 origin = loadQuads(quads, corners + l);
    const V3 e1 = loadQuads(quads, corners + kBatch + l) - origin;
    const V3 e2 = loadQuads(quads, corners + 2 * kBatch + l) - origin;
    const V u1 = coefficient(0), u2 = coefficient(1), v1 = coefficient(2), v2 = coefficient(3);
    const V3 xu = mulAdd(u1, e1, scaled(u2, e2)), xv = mulAdd(v1, e1, scaled(v2, e2));
    const V su = hn::Mul(coefficient(4), clampAbs(hn::Sub(dot(xu, xu), one), limit));
    const V sv = hn::Mul(coefficient(5), clampAbs(hn::Sub(dot(xv, xv), one), limit));
    const V shear = hn::Mul(coefficient(6), clampAbs(dot(xu, xv), limit));
    const V3 pu = mulAdd(su, xu, scaled(shear, xv)), pv = mulAdd(sv, xv, scaled(shear, xu));
    const V3 pull1 = mulAdd(u1, pu, scaled(v1, pv)), pull2 = mulAdd(u2, pu, scaled(v2, pv));
    storeQuads(pull1 + pull2, out + l * MeshLayout::kQuad);
    storeQuads(scaled(minus, pull1), out + (kBatch + l) * MeshLayout::kQuad);
    storeQuads(scaled(minus, pull2), out + (2 * kBatch + l) * MeshLayout::kQuad);
  }
}

// A batch of hinges' forces on their corners, the gradient as in hinge_bending.cpp. The moment
// fades where a height or the edge is below its floor, by the same factor on both sides: it never
// turns the hinge as a whole.
HWY_INLINE void hingeForces(const std::uint32_t* corners, const float* coefficients,
                            const float* quads, float* out) {
  const D d;
  const V minus = hn::Set(d, -1.f);
  for (std::size_t l = 0; l < kBatch; l += hn::Lanes(d)) {
    const auto coefficient = [&](std::size_t q)
                                 HWY_ATTR { return hn::Load(d, coefficients + q * kBatch + l); };
    const auto inverse = [&](V square, V floor)
                             HWY_ATTR { return reciprocal(d, hn::Max(square, floor)); };
    const V3 p0 = loadQuads(quads, corners + l);
    const V3 e = loadQuads(quads, corners + kBatch + l) - p0;
    const V3 to1 = loadQuads(quads, corners + 2 * kBatch + l) - p0;
    const V3 to2 = loadQuads(quads, corners + 3 * kBatch + l) - p0;
    const V3 n1 = cross(e, to1), n2 = cross(to2, e);
    const V squareE = dot(e, e);
    const V perSquareE = inverse(squareE, hn::Set(d, 1e-30f)), perLength = hn::Sqrt(perSquareE);
    const V height1 = hn::Mul(dot(n1, n1), perSquareE);  // squared
    const V height2 = hn::Mul(dot(n2, n2), perSquareE);
    const V inverse1 = inverse(height1, coefficient(3));
    const V inverse2 = inverse(height2, coefficient(4));
    const V fadeE = hn::Mul(squareE, inverse(squareE, coefficient(5)));
    const V fade1 = hn::Mul(height1, inverse1), fade2 = hn::Mul(height2, inverse2);

    const V cosine = dot(n1, n2);
    const V sine = hn::Neg(hn::Mul(hn::Mul(squareE, perLength), dot(n1, to2)));
    const V restCosine = coefficient(1), restSine = coefficient(2);
    const V angle = atan2(d, hn::MulSub(sine, restCosine, hn::Mul(cosine, restSine)),
                          hn::MulAdd(cosine, restCosine, hn::Mul(sine, restSine)));
    const V moment = hn::Mul(hn::Mul(coefficient(0), angle), hn::Mul(fadeE, perLength));
    const V3 f2 = scaled(hn::Mul(moment, hn::Mul(inverse1, fade2)), n1);
    const V3 f3 = scaled(hn::Mul(moment, hn::Mul(inverse2, fade1)), n2);
    const V share1 = hn::Mul(dot(to1, e), perSquareE), share2 = hn::Mul(dot(to2, e), perSquareE);
    const V3 pull1 = mulAdd(share1, f2, scaled(share2, f3));
    storeQuads(pull1 - (f2 + f3), out + l * MeshLayout::kQuad);
    storeQuads(scaled(minus, pull1), out + (kBatch + l) * MeshLayout::kQuad);
    storeQuads(f2, out + (2 * kBatch + l) * MeshLayout::kQuad);
    storeQuads(f3, out + (3 * kBatch + l) * MeshLayout::kQuad);
  }
}

// Calls forces(corners, coefficients, out) for every batch; returns the end of their corner forces.
template <std::size_t kCorners, std::size_t kFloats, class Forces>
HWY_INLINE float* forEachBatch(const MeshLayout::Elements& elements, MeshLayout::Range batches,
                               float* out, const Forces& forces) {
  for (std::size_t b = batches.first; b < std::size_t{batches.first} + batches.count; ++b) {
    forces(elements.corners.data() + b * kCorners * kBatch,
           elements.coefficients.data() + b * kFloats * kBatch, out);
    out += kCorners * kBatch * MeshLayout::kQuad;
  }
  return out;
}

// Forces on the corners of the chunk's elements, to scratch.
HWY_INLINE void cornerForces(const MeshLayout& layout, const MeshLayout::Chunk& chunk,
                             const float* quads, float* scratch) {
  float* out = scratch + MeshLayout::kScratchHead;
  out = forEachBatch<MeshLayout::kTriangleCorners, MeshLayout::kTriangleFloats>(
      layout.triangles, chunk.triangles, out,
      [&](const std::uint32_t* corners, const float* coefficients, float* forces)
          HWY_ATTR { triangleForces(corners, coefficients, layout.cap, quads, forces); });
  forEachBatch<MeshLayout::kHingeCorners, MeshLayout::kHingeFloats>(
      layout.hinges, chunk.hinges, out,
      [&](const std::uint32_t* corners, const float* coefficients, float* forces)
          HWY_ATTR { hingeForces(corners, coefficients, quads, forces); });
}

// Calls apply(k, force) for every vector of the chunk's points k….
template <class Apply>
HWY_INLINE void forEachForce(const MeshLayout& layout, const MeshLayout::Chunk& chunk,
                             const float* scratch, const Apply& apply) {
  // Sums are read back some slices later, when the stores have reached the cache: a vector load
  // does not wait for narrower stores kindly.
  constexpr std::size_t kGroup = 4 * kBatch;
  alignas(64) float sums[kGroup * MeshLayout::kQuad];
  const D d;
  const std::size_t end = std::size_t{chunk.points.first} + chunk.points.count;
  for (std::size_t group = chunk.points.first; group < end; group += kGroup) {
    const std::size_t stop = std::min(group + kGroup, end);
    for (std::size_t k = group; k < stop; k += kBatch) {
      const std::uint32_t first = layout.sliceFirst[k / kBatch];
      const std::size_t count = (layout.sliceFirst[k / kBatch + 1] - first) / kBatch;
      const std::uint32_t* places = layout.places.data() + first;
      float* slice = sums + (k - group) * MeshLayout::kQuad;
      for (std::size_t p = 0; p < kBatch; ++p, places += count)
        sumQuads(scratch, places, count, slice + layout.quadOffset(p));
    }
    for (std::size_t k = group; k < stop; k += hn::Lanes(d))
      apply(k, loadQuads(sums + (k - group) * MeshLayout::kQuad));
  }
}

void toQuadsImpl(const VectorArray& position, std::size_t count, float* quads) {
  for (std::size_t k = 0; k < count; k += hn::Lanes(D()))
    storeQuads(pointers(position).at(k), quads + k * MeshLayout::kQuad);
}

void stepChunkImpl(const MeshLayout& layout, const MeshLayout::Chunk& chunk,
                   const StepInputs& inputs, float time_s, const float* quads, float* nextQuads,
                   float* scratch, VectorArray& position, VectorArray& velocity) {
  cornerForces(layout, chunk, quads, scratch);
  const PointStep step{inputs, time_s};
  const MutablePointers r = pointers(position), v = pointers(velocity);
  forEachForce(layout, chunk, scratch, [&](std::size_t k, V3 force) HWY_ATTR {
    storeQuads(step(k, force, r, v, k), nextQuads + k * MeshLayout::kQuad);
  });
}

void chunkForcesImpl(const MeshLayout& layout, const MeshLayout::Chunk& chunk, const float* quads,
                     float* scratch, VectorArray& force) {
  cornerForces(layout, chunk, quads, scratch);
  const MutablePointers out = pointers(force);
  forEachForce(layout, chunk, scratch, [&](std::size_t k, V3 f) HWY_ATTR { out.set(k, f); });
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(lanesImpl);
HWY_EXPORT(toQuadsImpl);
HWY_EXPORT(stepChunkImpl);
HWY_EXPORT(chunkForcesImpl);

namespace {

// Below this many points waking threads costs more than they save.
constexpr std::size_t kParallelPoints = 4096;

}  // namespace

MeshStepper::MeshStepper(const TriangleMembrane& membrane)
    : layout_(membrane, HWY_DYNAMIC_DISPATCH(lanesImpl)()),
      quads_(layout_.pointCount * MeshLayout::kQuad),
      nextQuads_(quads_.size()) {
  const auto threads = static_cast<std::size_t>(hardwareThreads());
  const bool parallel = layout_.pointCount >= kParallelPoints;
  scratch_.resize(parallel ? std::min(threads, layout_.chunks.size()) : 1);
  for (FloatArray& scratch : scratch_) scratch.resize(layout_.scratchFloats);
}

// Each task has its own scratch and runs over its share of the chunks; which task computes a chunk
// makes no difference to the result.
template <class Task>
void MeshStepper::forEachChunk(const Task& task) {
  const std::size_t chunks = layout_.chunks.size(), tasks = scratch_.size();
  parallelFor(tasks, [&](std::size_t t) {
    for (std::size_t c = chunks * t / tasks; c < chunks * (t + 1) / tasks; ++c)
      task(layout_.chunks[c], scratch_[t].data());
  });
}

void MeshStepper::run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
                      VectorArray& velocity) {
  HWY_DYNAMIC_DISPATCH(toQuadsImpl)(position, layout_.pointCount, quads_.data());
  for (int s = 1; s <= steps; ++s) {
    const float time_s = static_cast<float>(firstStep + s) * inputs.step->step_s;
    forEachChunk([&](const MeshLayout::Chunk& chunk, float* scratch) {
      HWY_DYNAMIC_DISPATCH(stepChunkImpl)
      (layout_, chunk, inputs, time_s, quads_.data(), nextQuads_.data(), scratch, position,
       velocity);
    });
    std::swap(quads_, nextQuads_);
    if (!inputs.stepEnd) continue;
    inputs.stepEnd->stepped(time_s, position, velocity);
    HWY_DYNAMIC_DISPATCH(toQuadsImpl)(position, layout_.pointCount, quads_.data());
  }
}

void MeshStepper::forces(const VectorArray& position, VectorArray& force) {
  HWY_DYNAMIC_DISPATCH(toQuadsImpl)(position, layout_.pointCount, quads_.data());
  forEachChunk([&](const MeshLayout::Chunk& chunk, float* scratch) {
    HWY_DYNAMIC_DISPATCH(chunkForcesImpl)(layout_, chunk, quads_.data(), scratch, force);
  });
}

void meshForces(const TriangleMembrane& membrane, const VectorArray& position, VectorArray& force) {
  MeshStepper(membrane).forces(position, force);
}

}  // namespace fascia
#endif
