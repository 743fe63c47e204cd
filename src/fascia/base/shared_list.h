#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace fascia {

// A long list that copies share: copying costs a pointer. Reads like a constant vector; edit()
// gives a list of one's own to change.
template <class T>
class SharedList {
 public:
  SharedList() = default;
  SharedList(std::vector<T> values)
      : values_(std::make_shared<std::vector<T>>(std::move(values))) {}

  const std::vector<T>& values() const {
    static const std::vector<T> kNone;
    return values_ ? *values_ : kNone;
  }
  operator const std::vector<T>&() const { return values(); }
  std::size_t size() const { return values().size(); }
  bool empty() const { return values().empty(); }
  auto begin() const { return values().begin(); }
  auto end() const { return values().end(); }
  const T& operator[](std::size_t i) const { return values()[i]; }

  // Copies the list first if somebody shares it. The reference is for changes made at once: a copy
  // of this list that is made later sees what is written through it afterwards.
  std::vector<T>& edit() {
    if (!values_ || values_.use_count() > 1) values_ = std::make_shared<std::vector<T>>(values());
    return *values_;
  }

  friend bool operator==(const SharedList& a, const SharedList& b) {
    return a.values_ == b.values_ || a.values() == b.values();
  }

 private:
  std::shared_ptr<std::vector<T>> values_;
};

}  // namespace fascia
