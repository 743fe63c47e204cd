#pragma once

#include <algorithm>
#include <initializer_list>

#include <fascia/io/documents/plain_codecs.h>

namespace fascia {

// How a row of a table of tunables is read, written and published.
template <class T, class M>
CodecPtr<M> codecOf(const Tunable<T, M>& row) {
  if constexpr (std::is_same_v<M, bool>) {
    return booleans();
  } else if constexpr (std::is_same_v<M, int>) {
    return integers(row.range);
  } else if constexpr (std::is_same_v<M, double>) {
    return row.isAngle() ? angles(row.range) : numbers(row.range);
  } else if constexpr (requires(M m) { m.has_value(); }) {
    using Inner = typename M::value_type;
    return optionally<Inner>(codecOf(Tunable<T, Inner>{{row}, nullptr}));
  } else {
    return row.isAngle() ? angleVectors(row.range) : vectors(row.range);
  }
}
template <class T>
CodecPtr<std::string> codecOf(const WordTunable<T>& row) {
  return wordsOf(row.words());
}

// Adds a field for each row of Def's table. `leaveOut`: keys of rows that mean nothing here.
// `makeCodec(row)`, if given, makes the codecs.
template <class Def, class T, class MakeCodec>
void addTunables(ObjectCodec<T>& codec, std::initializer_list<std::string_view> leaveOut,
                 const MakeCodec& makeCodec) {
  forEachTunable<Def>([&](const auto& row) {
    if (std::ranges::find(leaveOut, row.key) != leaveOut.end()) return;
    using M = std::remove_cvref_t<decltype(std::declval<Def>().*row.member)>;
    using Need = typename ObjectCodec<T>::Need;
    codec.template field<M>(std::string(row.key), static_cast<M T::*>(row.member), makeCodec(row),
                            std::string(row.help),
                            row.isRequired ? Need::required : Need::optional);
  });
}
template <class Def, class T>
void addTunables(ObjectCodec<T>& codec, std::initializer_list<std::string_view> leaveOut = {}) {
  addTunables<Def>(codec, leaveOut, [](const auto& row) { return codecOf(row); });
}
// Of a part that files do not nest.
template <class T, class Part>
void addTunables(ObjectCodec<T>& codec, Part T::*part) {
  using Need = typename ObjectCodec<T>::Need;
  forEachTunable<Part>([&](const auto& row) {
    codec.field(std::string(row.key), part, row.member, codecOf(row), std::string(row.help),
                row.isRequired ? Need::required : Need::optional);
  });
}

}  // namespace fascia
