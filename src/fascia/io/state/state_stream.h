#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/io/file/byte_stream.h>

namespace fascia {

// The members of a state in the order of their file, for writing (constant) and reading alike. What
// follows from them is left out: frames of joints and solids; and scratch memory.

template <class T, class U>
concept IsA = std::same_as<std::remove_const_t<T>, U>;

template <class Visit>
void eachMember(IsA<VectorArray> auto& a, Visit& visit) {
  visit(a.x), visit(a.y), visit(a.z);
}

template <class Visit>
void eachMember(IsA<Transform> auto& t, Visit& visit) {
  visit(t.rotation), visit(t.translation_m);
}

template <class Visit>
void eachMember(IsA<JointRotation> auto& r, Visit& visit) {
  visit(r.joint.value), visit(r.rotation.coeffs()), visit(r.angular_rad_per_s);
}

template <class Visit>
void eachMember(IsA<Flesh::ParameterOverride> auto& p, Visit& visit) {
  visit(p.solid.value), visit(p.parameter), visit(p.value), visit(p.rate);
  visit(p.weight), visit(p.weightRate_per_s);
}

template <class Visit>
void eachMember(IsA<JiggleState> auto& j, Visit& visit) {
  visit(j.offset), visit(j.velocity), visit(j.place), visit(j.placeVelocity);
  visit(j.origin_m), visit(j.frames);
}

template <class Visit>
void eachMember(IsA<PointSurroundings> auto& s, Visit& visit) {
  visit(s.anchor), visit(s.anchorVelocity), visit(s.normal), visit(s.fleshVelocity);
  visit(s.offset), visit(s.fleshNormal);
}

template <class Visit>
void eachMember(IsA<SkinState> auto& s, Visit& visit) {
  visit(s.position), visit(s.velocity), visit(s.surroundings), visit(s.coarseVelocity);
  visit(s.coarse), visit(s.joints), visit(s.jiggle), visit(s.maxSpeed_m_per_s);
  visit(s.odeStep_s), visit(s.ready), visit(s.starting);
}

template <class Visit>
void eachMember(IsA<CharacterState> auto& s, Visit& visit) {
  visit(s.time_s), visit(s.posture.values), visit(s.posture.rates), visit(s.posture.rotations);
  visit(s.bodies.t_s), visit(s.bodies.r), visit(s.bodies.v);
  visit(s.held), visit(s.sampled.parameters), visit(s.morphs.weights), visit(s.morphs.rates);
  visit(s.skin);
}

// Vectors and matrices of fixed size are numbers in a row.
template <class T>
concept FixedMatrix = requires {
  T::SizeAtCompileTime;
}
&&(T::SizeAtCompileTime > 0);
template <class T>
concept GrowingList = requires(T& list) {
  list.emplace_back();
};
template <class T>
concept FlatValue = std::is_arithmetic_v<T> || FixedMatrix<T>;

class StateWriter {
 public:
  explicit StateWriter(ByteWriter& out) : out_(out) {}

  template <class T>
  void operator()(const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      out_.value(value);
    } else if constexpr (FixedMatrix<T>) {
      out_.array(value.data(), static_cast<std::size_t>(value.size()));
    } else if constexpr (GrowingList<T>) {
      out_.value(static_cast<std::uint64_t>(value.size()));
      list(value);
    } else {
      eachMember(value, *this);
    }
  }

 private:
  template <class T>
  void list(const T& values) {
    if constexpr (FlatValue<typename T::value_type>)
      out_.array(values.data(), values.size());
    else
      for (const auto& value : values) (*this)(value);
  }

  ByteWriter& out_;
};

// Takes nothing but numbers that a character may have, and no more than there are bytes for.
class StateReader {
 public:
  explicit StateReader(ByteReader& in) : in_(in) {}

  template <class T>
  void operator()(T& value) {
    if constexpr (std::same_as<T, bool>) {
      const auto byte = in_.value<std::uint8_t>();
      if (byte > 1) in_.fail("holds something that is neither yes nor no");
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = in_.value<T>();
      requireReal(value);
    } else if constexpr (FixedMatrix<T>) {
      for (Eigen::Index i = 0; i < value.size(); ++i) (*this)(value.data()[i]);
    } else if constexpr (GrowingList<T>) {
      list(value, in_.value<std::uint64_t>());
    } else {
      eachMember(value, *this);
    }
  }

 private:
  // In SI units. Squares of it and their products are floats still, so that what goes on from any
  // of them stays finite or is repaired.
  static constexpr float kLargest = 1e9f;
  static constexpr int kDeepest = 4;  // coarse skins of coarse skins; more than there are

  template <class T>
  void list(T& values, std::uint64_t count) {
    using Value = typename T::value_type;
    if constexpr (FlatValue<Value>) {
      in_.array(values, count);
      for (const Value& value : values) requireReal(value);
    } else {
      if (std::same_as<Value, SkinState> && ++depth_ > kDeepest) in_.fail("has too many skins");
      for (std::uint64_t i = 0; i < count; ++i) (*this)(values.emplace_back());
    }
  }

  template <class T>
  void requireReal(const T& value) const {
    bool real = true;
    if constexpr (FixedMatrix<T>)
      real = value.allFinite() && value.cwiseAbs().maxCoeff() <= kLargest;
    else if constexpr (std::is_floating_point_v<T>)
      real = std::abs(value) <= kLargest;  // false for NaN
    if (!real)
      in_.fail("holds a value that is no number or larger than any of a running character");
  }

  ByteReader& in_;
  int depth_ = 0;  // lists of skins that were begun
};

}  // namespace fascia
