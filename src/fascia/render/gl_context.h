#pragma once

#include <memory>
#include <string>

namespace fascia {

// An OpenGL 3.3 core context without a window: EGL on Mesa's surfaceless platform, else on the
// first EGL device that offers one. Throws Error that says what to install when there is none.
class GlContext {
 public:
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  void makeCurrent() const;         // on the calling thread
  std::string description() const;  // version and renderer, for --version and bug reports

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascia
