#pragma once

#include <string>
#include <unordered_map>
#include <utility>

#include <epoxy/gl.h>

#include <Eigen/Core>

// Owners of OpenGL objects. All need the context that made them to be current.
namespace fascia::gl {

template <class Kind>
class Handle {
 public:
  Handle() : id_(Kind::create()) {}
  ~Handle() { Kind::destroy(id_); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GLuint id() const { return id_; }

 private:
  GLuint id_;
};

struct TextureKind {
  static GLuint create();
  static void destroy(GLuint id);
};
struct BufferKind {
  static GLuint create();
  static void destroy(GLuint id);
};
struct VertexArrayKind {
  static GLuint create();
  static void destroy(GLuint id);
};
struct FramebufferKind {
  static GLuint create();
  static void destroy(GLuint id);
};
struct RenderbufferKind {
  static GLuint create();
  static void destroy(GLuint id);
};
struct SamplerKind {
  static GLuint create();
  static void destroy(GLuint id);
};

using Texture = Handle<TextureKind>;
using Buffer = Handle<BufferKind>;
using VertexArray = Handle<VertexArrayKind>;
using Framebuffer = Handle<FramebufferKind>;
using Renderbuffer = Handle<RenderbufferKind>;
using Sampler = Handle<SamplerKind>;

// A linked vertex and fragment shader. `defines` are "#define …" lines put in front of both.
class Program {
 public:
  Program(const std::string& vertexSource, const std::string& fragmentSource,
          const std::string& defines = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const;
  // Set a uniform of the program in use; names that the compiler dropped are ignored.
  void set(const char* name, int value);
  void set(const char* name, float value);
  void set(const char* name, const Eigen::Vector2f& value);
  void set(const char* name, const Eigen::Vector3f& value);
  void set(const char* name, const Eigen::Matrix4f& value);

 private:
  GLint location(const char* name);

  GLuint id_;
  std::unordered_map<std::string, GLint> locations_;
};

// Binds a texture to a unit, with an optional sampler object (0 = the texture's own settings).
void bindTexture(int unit, GLuint texture, GLuint sampler = 0);

struct TextureFormat {
  GLenum internal, external, type;
};
// Storage without mipmaps, clamped at the edges.
void allocateTexture(const Texture& texture, int width, int height, const TextureFormat& format,
                     GLenum filter, const void* data = nullptr);
// Sets a level of a texture that has its level before; 0 is the picture itself.
void uploadLevel(const Texture& texture, int level, int width, int height,
                 const TextureFormat& format, const void* data);
void attachTexture(const Framebuffer& framebuffer, GLenum attachment, const Texture& texture);
// Throws Error when the driver refuses the bound framebuffer.
void requireComplete(const char* what);

}  // namespace fascia::gl
