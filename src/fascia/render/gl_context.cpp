#include <fascia/render/gl_context.h>

#include <array>
#include <vector>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <fascia/base/error.h>

namespace fascia {
namespace {

[[noreturn]] void noGl(const std::string& reason) {
  Issue issue;
  issue.message = "no OpenGL 3.3 without a display: " + reason;
  issue.hint = "install EGL and a driver; on Debian: apt-get install libegl1 libgl1-mesa-dri";
  throw Error(issue);
}

bool clientHas(const char* extension) {
  return epoxy_has_egl_extension(EGL_NO_DISPLAY, extension);
}

std::vector<EGLDisplay> displays() {
  std::vector<EGLDisplay> result;
  if (!clientHas("EGL_EXT_platform_base")) return result;
  if (clientHas("EGL_MESA_platform_surfaceless"))
    result.push_back(
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  if (clientHas("EGL_EXT_platform_device") && clientHas("EGL_EXT_device_enumeration")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i)
      result.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT,
                                                devices[static_cast<std::size_t>(i)], nullptr));
  }
  return result;
}

EGLContext createContext(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               3,
                               EGL_CONTEXT_MINOR_VERSION,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
}

}  // namespace

struct GlContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

GlContext::GlContext() : impl_(std::make_unique<Impl>()) {
  std::string reason = "EGL offers no display-less platform";
  for (EGLDisplay display : displays()) {
    // Displays are shared by the whole process, so they are never terminated here: another
    // context may still use the same one.
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
      reason = "EGL could not start a driver";
      continue;
    }
    const EGLContext context = createContext(display);
    if (context == EGL_NO_CONTEXT) {
      reason = "the driver has no OpenGL 3.3 core profile";
      continue;
    }
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
      impl_->display = display;
      impl_->context = context;
      return;
    }
    eglDestroyContext(display, context);
    reason = "the driver cannot work without a surface";
  }
  noGl(reason);
}

GlContext::~GlContext() {
  if (eglGetCurrentContext() == impl_->context)
    eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(impl_->display, impl_->context);
}

void GlContext::makeCurrent() const {
  if (!eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context))
    noGl("the context cannot be used on this thread");
}

std::string GlContext::description() const {
  makeCurrent();
  const auto text = [](GLenum what) {
    const GLubyte* s = glGetString(what);
    return std::string(s ? reinterpret_cast<const char*>(s) : "?");
  };
  return text(GL_VERSION) + ", " + text(GL_RENDERER);
}

}  // namespace fascia
