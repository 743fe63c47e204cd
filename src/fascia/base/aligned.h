#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include <fascia/base/assert.h>

namespace fascia {

// Every SIMD array starts on a cache line.
inline constexpr std::size_t kSimdAlignment = 64;

template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{kSimdAlignment}));
  }
  void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{kSimdAlignment}); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

using FloatArray = std::vector<float, AlignedAllocator<float>>;

// Structure of arrays for vectors: three float arrays of the same length.
struct VectorArray {
  FloatArray x, y, z;
  static constexpr FloatArray VectorArray::*kAxes[3] = {&VectorArray::x, &VectorArray::y,
                                                        &VectorArray::z};

  VectorArray() = default;
  explicit VectorArray(std::size_t n) : x(n), y(n), z(n) {}
  std::size_t size() const { return x.size(); }
  void resize(std::size_t n) { x.resize(n), y.resize(n), z.resize(n); }
  void fill(float value) {
    for (FloatArray* a : {&x, &y, &z}) a->assign(a->size(), value);
  }
};

// Read-only and writable views of a range of a VectorArray.
struct ConstVectors {
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t count = 0;
};
struct Vectors {
  float *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t count = 0;
  operator ConstVectors() const { return {x, y, z, count}; }
};

inline ConstVectors view(const VectorArray& a, std::size_t first, std::size_t count) {
  FASCIA_ASSERT(first + count <= a.size(), "the view is of the array");
  return {a.x.data() + first, a.y.data() + first, a.z.data() + first, count};
}
inline Vectors view(VectorArray& a, std::size_t first, std::size_t count) {
  FASCIA_ASSERT(first + count <= a.size(), "the view is of the array");
  return {a.x.data() + first, a.y.data() + first, a.z.data() + first, count};
}

}  // namespace fascia
